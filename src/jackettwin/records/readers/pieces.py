"""A long file as a sequence of short records: only one piece is in memory at a time.

Pieces end on UTC boundaries (ten minutes: hh:00, hh:10, …) where the start is known, else they are counted
from the first sample. Delimited text, Parquet and HDF5 are read piece by piece; of other formats the samples
are read at once, and only what follows is done piece by piece.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.records.readers.channels import FileDefaults
from jackettwin.records.readers.description import Description
from jackettwin.records.readers.registry import described_by, reading, tables_of
from jackettwin.records.readers.stamps import in_utc, refuse_put_back, unfolded
from jackettwin.records.readers.table import ReadTable, known_rate, stated_rate, to_record, zone_of

if TYPE_CHECKING:
    from pathlib import Path

    from jackettwin.records.record import Record


SHORTEST = 0.5
"""A first or last piece shorter than this share of the others is left out."""
SHORTEST_JOINED_S = 10.0
"""Shortest piece of a record whose pieces are joined again [s]: its stamps must show the sample rate."""


def read_record_pieces(
    path: Path, seconds: float = 600.0, defaults: FileDefaults | None = None
) -> Iterator[Record]:
    """Yield a record's pieces in the order of time, each as ``read_record`` would read it.

    Pieces are called like the file and their start (``A1_20250601T141000``, or ``A1_0001``).

    Parameters
    ----------
    seconds : float
        Length of a piece.
    defaults : FileDefaults, optional
        Rate, unit and zone, for a file that does not say them.

    Raises
    ------
    InputError
        As ``read_record``; some pieces may have been yielded before.
    """
    long = (record for _, record in placed_pieces(path, seconds, defaults, shortest_s=SHORTEST * seconds))
    for number, record in enumerate(long, start=1):
        start = record.start_utc
        stamp = f"{number:04d}" if start is None else f"{_nearest_second(start):%Y%m%dT%H%M%S}"
        yield replace(record, name=f"{path.stem}_{stamp}")


def placed_pieces(
    path: Path, seconds: float, defaults: FileDefaults | None = None, *, shortest_s: float = SHORTEST_JOINED_S
) -> Iterator[tuple[float, Record]]:
    """Yield the pieces of a record with the time of each since the record's first sample [s].

    All have the sample rate of the first, with which later stamps must agree within a thousandth.

    Raises
    ------
    InputError
        As ``read_record``; some pieces may have been yielded before.
    """
    beside, defaults = described_by(path), defaults or FileDefaults()
    with reading(path):
        tables = tables_of(path)
        first = next(tables)
        said = beside or first.description or Description()
        known = replace(said, start_utc=None)
        for begin_s, piece in _split(chain([first], tables), said, defaults, seconds, shortest_s):
            if said.start_utc is not None:
                piece = replace(piece, zone_said=True)
            record = to_record(piece, known, path, defaults)
            known = replace(known, sample_rate_hz=record.sample_rate_hz)
            yield begin_s, record


@dataclass(frozen=True)
class _Timed:
    """Rows of a table with their times since the first sample of the file.

    ``put_back`` tells whether the clock was put back before their end.
    """

    table: ReadTable
    t: FloatArray
    put_back: bool = False

    def rows(self, start: int, stop: int | None = None) -> _Timed:
        part = slice(start, stop)
        times = None if self.table.times_s is None else self.table.times_s[part]
        table = replace(self.table, data=self.table.data[:, part].copy(), times_s=times)
        return _Timed(table, self.t[part], self.put_back)

    def followed_by(self, other: _Timed) -> _Timed:
        data = np.hstack([self.table.data, other.table.data])
        t = np.concatenate([self.t, other.t])
        times = None if self.table.times_s is None else t
        return _Timed(replace(self.table, data=data, times_s=times), t, self.put_back or other.put_back)


def _split(
    tables: Iterable[ReadTable], said: Description, defaults: FileDefaults, seconds: float, shortest_s: float
) -> Iterator[tuple[float, ReadTable]]:
    """Yield tables cut at the boundaries, each with the time [s] and the start of its first row."""
    held: _Timed | None = None
    origin: datetime | None = None
    end = seconds
    for chunk in _timed(tables, said, defaults):
        if held is None:
            origin = said.start_utc or chunk.table.start_utc
            held, end = chunk, _first_boundary(origin, seconds)
        else:
            held = held.followed_by(chunk)
        zone = zone_of(held.table, said, defaults)
        if held.put_back and origin is not None and zone is not None and not held.table.zone_said:
            origin = in_utc(origin, zone)  # from here on the clock shows another time than the first
            held = replace(held, table=replace(held.table, zone_said=True))
        while len(held.t) and held.t[-1] >= end:
            cut = int(np.searchsorted(held.t, end))
            yield from _long_enough(held.rows(0, cut), origin, shortest_s)
            held, end = held.rows(cut), end + seconds
    if held is not None:
        yield from _long_enough(held, origin, shortest_s)


def _timed(tables: Iterable[ReadTable], said: Description, defaults: FileDefaults) -> Iterator[_Timed]:
    """Yield tables with their times since the first sample, all with the columns of the first."""
    first: ReadTable | None = None
    count, latest, zero = 0, 0.0, 0.0
    before, late_s = np.zeros(0), np.zeros(1)
    for table in tables:
        if first is None:
            first = table
            zero = float(table.times_s[0]) if table.times_s is not None and table.start_utc is None else 0.0
        data = _columns_of(first, table)
        n = data.shape[1]
        if first.times_s is None or table.times_s is None:
            rate = stated_rate(first, said) or defaults.sample_rate_hz
            t = (count + np.arange(n)) / known_rate(first, rate, "the JSON")
        else:
            since = 0.0
            if first.start_utc is not None and table.start_utc is not None:
                since = (table.start_utc - first.start_utc).total_seconds()
            shown = np.append(before, table.times_s + since - zero)
            late_s = late_s[-1] + _put_back_s(first, shown, said, defaults)
            # stamps out of order are for the clock to judge: cuts need times that do not fall
            t = np.maximum.accumulate(np.fmax((shown + late_s)[before.size :], latest))
            before = shown[-1:]
        count, latest = count + n, float(t[-1]) if n else latest
        times = None if first.times_s is None else t
        yield _Timed(replace(first, data=data, times_s=times), t, bool(late_s[-1]))


def _put_back_s(
    first: ReadTable, shown_s: FloatArray, said: Description, defaults: FileDefaults
) -> FloatArray:
    """Return by how much the clock is put back until each of the times that it shows, (n_samples,) [s]."""
    if first.start_utc is None or first.zone_said or said.start_utc is not None:
        return np.zeros(shown_s.size)
    zone = zone_of(first, said, defaults)
    if zone is None:
        refuse_put_back(shown_s)
        return np.zeros(shown_s.size)
    real = unfolded(first.start_utc, shown_s, zone)
    return np.zeros(shown_s.size) if real is None else real - shown_s


def _columns_of(first: ReadTable, table: ReadTable) -> FloatArray:
    """Return a table's data in the columns of the first one: a column empty for hours stays a channel."""
    if table.names == first.names:
        return table.data
    rows = dict(zip(table.names, table.data, strict=True))
    missing = np.full(table.data.shape[1], np.nan)
    return np.vstack([rows.get(name, missing) for name in first.names])


def _first_boundary(origin: datetime | None, seconds: float) -> float:
    """Return the time of the first boundary since the first sample [s]."""
    if origin is None:
        return seconds
    midnight = origin.replace(hour=0, minute=0, second=0, microsecond=0)
    return seconds - (origin - midnight).total_seconds() % seconds


def _long_enough(
    piece: _Timed, origin: datetime | None, shortest_s: float
) -> Iterator[tuple[float, ReadTable]]:
    """Yield a piece with the time and the start of its first row, unless it is too short or empty."""
    if len(piece.t) < 2 or piece.t[-1] - piece.t[0] < shortest_s:
        return
    start = None if origin is None else origin + timedelta(seconds=float(piece.t[0]))
    times = None if piece.table.times_s is None else piece.t - piece.t[0]
    yield float(piece.t[0]), replace(piece.table, times_s=times, start_utc=start)


def _nearest_second(time: datetime) -> datetime:
    return (time.astimezone(UTC) + timedelta(microseconds=500_000)).replace(microsecond=0)
