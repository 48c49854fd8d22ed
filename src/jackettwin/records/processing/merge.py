"""Merging of simultaneous records of several loggers to a common rate and time axis.

``merge`` is for loggers that ran at the same time. Successive setups with a few fixed sensors cannot share a
time axis; ``shared_channels`` names the sensors that connect them.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.interpolate is loaded where it is used

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.records.processing.filters import bridge
from jackettwin.records.processing.prepare import decimate

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import datetime

    from jackettwin.records.record import Record


ON_GRID = 1e-6
"""Offset in samples below which no interpolation is needed."""


def shared_channels(records: Sequence[Record]) -> tuple[str, ...]:
    """Return the names of the channels that all records have: the reference sensors of a multi-setup test.

    A channel is shared if name, quantity, place and direction agree.

    Raises
    ------
    InputError
        If a name stands for different sensors, or no channel is shared.
    """
    if not records:
        return ()
    shared = [name for name in records[0].channel_names if all(name in r.channel_names for r in records)]
    for name in shared:
        sensors = [r.channels[r.channel_names.index(name)] for r in records]
        for record, sensor in zip(records, sensors, strict=True):
            if sensor != sensors[0]:
                raise InputError(
                    "one name is used for different sensors",
                    file=record.name,
                    field=f"channels.{name}",
                    value=sensor,
                    allowed=str(sensors[0]),
                    remedy="rename the channel that moved",
                )
    if not shared:
        raise InputError(
            "records share no channel",
            field="channels",
            allowed="at least one sensor that stays in place",
            remedy="merge needs reference sensors",
        )
    return tuple(shared)


def merge(records: Sequence[Record], *, name: str | None = None) -> Record:
    """Return simultaneous records as one, at the lowest rate and over their common time.

    Faster records are decimated. Clocks with an offset are interpolated to one grid by cubic splines;
    gaps remain. Without start times all records are assumed to start together.

    Raises
    ------
    InputError
        If channel names collide, only some records have a start, or they do not overlap.
    """
    if not records:
        raise InputError(
            "there is nothing to merge",
            field="records",
            allowed="at least one record",
            remedy="give the records of all loggers",
        )
    _refuse_collisions(records)
    rate = min(record.sample_rate_hz for record in records)
    offsets = _offsets_s(records)
    begin = max(offsets)
    end = min(o + (r.data.shape[1] - 1) / r.sample_rate_hz for o, r in zip(offsets, records, strict=True))
    # 1e-6 samples of slack: sums of times are rounded
    n = int(np.floor((end - begin) * rate + ON_GRID)) + 1
    if n < 2:
        raise InputError(
            "records do not overlap in time",
            file=records[0].name,
            field="start_utc",
            value=[str(r.start_utc) for r in records],
            allowed="simultaneous records",
            remedy="merge what was measured together",
        )
    rows = [_resampled(r, rate, begin - o, n) for r, o in zip(records, offsets, strict=True)]
    first = records[0]
    start = None if first.start_utc is None else first.start_utc + timedelta(seconds=begin - offsets[0])
    return replace(
        first,
        data=np.vstack(rows),
        sample_rate_hz=rate,
        channels=tuple(channel for r in records for channel in r.channels),
        start_utc=start,
        conditions={key: value for r in reversed(records) for key, value in r.conditions.items()},
        metadata={**first.metadata, "merged": [r.name for r in records]},
        name=name or first.name,
    )


def _refuse_collisions(records: Sequence[Record]) -> None:
    seen: dict[str, str] = {}
    for record in records:
        for name in record.channel_names:
            if name in seen:
                raise InputError(
                    "channel is in two records",
                    file=record.name,
                    field="channels",
                    value=name,
                    allowed="different names",
                    remedy=f"rename it here or in {seen[name]}",
                )
            seen[name] = record.name


def _offsets_s(records: Sequence[Record]) -> list[float]:
    """Return the start of each record after that of the first [s]."""
    starts: list[datetime] = [r.start_utc for r in records if r.start_utc is not None]
    if not starts:
        return [0.0] * len(records)
    if len(starts) < len(records):
        raise InputError(
            "only some records have a start",
            file=next(r.name for r in records if r.start_utc is None),
            field="start_utc",
            allowed="all or none",
            remedy="state the start in UTC",
        )
    return [(start - starts[0]).total_seconds() for start in starts]


def _resampled(record: Record, rate: float, begin_s: float, n: int) -> FloatArray:
    """Return n samples at ``rate`` from ``begin_s`` after the record's start on."""
    ratio = Fraction(rate / record.sample_rate_hz).limit_denominator(1000)
    if 0 < ratio < 1:
        record = decimate(record, sample_rate_hz=record.sample_rate_hz * float(ratio))
    position = (begin_s + np.arange(n) / rate) * record.sample_rate_hz
    nearest = np.clip(np.round(position).astype(np.int64), 0, record.data.shape[1] - 1)
    if np.max(np.abs(position - nearest)) <= ON_GRID:
        return record.data[:, nearest]
    last = record.data.shape[1] - 1
    below = np.clip(np.floor(position).astype(np.int64), 0, last)
    gap = ~np.isfinite(record.data)
    spline = scipy.interpolate.CubicSpline(
        np.arange(last + 1), np.apply_along_axis(bridge, 1, record.data), axis=1
    )
    out: FloatArray = np.where(gap[:, below] | gap[:, np.minimum(below + 1, last)], np.nan, spline(position))
    return out
