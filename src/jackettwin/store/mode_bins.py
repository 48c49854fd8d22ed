"""Modes through time in bins: extremes and medians, read in one pass without holding the rows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import datetime
from itertools import groupby
from statistics import median
from typing import TYPE_CHECKING, Any

from sqlalchemy import Float, Select, cast, extract, func, select

from jackettwin.store.records import between, of_state
from jackettwin.store.tables import modes

if TYPE_CHECKING:
    from sqlalchemy import Connection

_BATCH = 5_000
"""Rows that are taken from the database at once."""


@dataclass
class Extremes:
    """Least value, median and greatest value of each bin; None where no row has one."""

    min: list[float | None] = field(default_factory=list)
    median: list[float | None] = field(default_factory=list)
    max: list[float | None] = field(default_factory=list)

    def add(self, values: list[float]) -> None:
        """Append the values of the next bin."""
        self.min.append(min(values, default=None))
        self.median.append(median(values) if values else None)
        self.max.append(max(values, default=None))


@dataclass
class ModeBins:
    """One mode in bins of equal length of time; bins without a row are left out.

    ``time_s`` is the start of each bin in seconds after ``start_utc``, ``count`` the number of its rows,
    and ``simulated`` the number of rows of all bins that nobody measured.
    """

    label: str
    start_utc: datetime
    bin_s: float
    time_s: list[float] = field(default_factory=list)
    count: list[int] = field(default_factory=list)
    frequency_hz: Extremes = field(default_factory=Extremes)
    damping_ratio: Extremes = field(default_factory=Extremes)
    simulated: int = 0


def modes_in_bins(
    connection: Connection,
    asset: str,
    model_hash: str,
    points: int,
    *,
    label: str | None = None,
    since: datetime | None = None,
    until: datetime | None = None,
    state: str | None = None,
) -> Iterator[ModeBins]:
    """Yield each mode, or one, in at most ``points`` bins from one time until before another.

    Without these times the bins extend over all rows. All modes have the same bins. At most two
    statements are executed, and no more rows than those of a bin and of a batch are held.
    """
    rows = select(modes).filter_by(asset=asset, model_hash=model_hash)
    if label is not None:
        rows = rows.where(modes.c.label == label)
    rows = of_state(between(rows, modes.c.time_utc, since, until), modes.c.record_id, asset, state)
    span = rows.with_only_columns(func.min(modes.c.time_utc), func.max(modes.c.time_utc))
    first, last = (since, until) if since and until else connection.execute(span).one()
    if first is None:
        return
    start = (since or first).replace(microsecond=0)
    bin_s = ((until or last) - start).total_seconds() / points or 1.0
    begin = start.timestamp()
    for name, own in groupby(_rows(connection, rows), lambda row: row[0]):
        bins = ModeBins(name, start, bin_s)
        for number, inside in groupby(own, lambda row: min((row[1] - begin) // bin_s, points - 1)):
            _, _, frequency, damping, status = zip(*inside, strict=True)
            bins.time_s.append(number * bin_s)
            bins.count.append(len(frequency))
            bins.frequency_hz.add(list(frequency))
            bins.damping_ratio.add([value for value in damping if value is not None])
            bins.simulated += status.count("simulated")
        yield bins


def _rows(connection: Connection, chosen: Select[Any]) -> Iterator[tuple[Any, ...]]:
    """Yield label, seconds since 1970, frequency [Hz], damping ratio and status, by label and time.

    The database counts the seconds: to make a time of each row takes longer than all else.
    """
    at_s = cast(extract("epoch", modes.c.time_utc), Float)
    columns = (modes.c.label, at_s, modes.c.frequency_hz, modes.c.damping_ratio, modes.c.status)
    query = chosen.with_only_columns(*columns).order_by(modes.c.label, modes.c.time_utc)
    found = connection.execute(query, execution_options={"yield_per": _BATCH})
    for batch in found.partitions():
        yield from map(tuple, batch)
