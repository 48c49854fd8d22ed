"""Repair of a record: certain faults are removed and reported; no samples are invented.

Wrong samples become missing, empty channels are dropped, drift is removed, clocks are corrected, and a sign
is reversed only if the other channels leave no doubt. All changes are listed in ``metadata["repair"]``.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.errors import InputError
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.clocks import in_step, stretch
from jackettwin.records.processing import filters
from jackettwin.records.quality import faults
from jackettwin.records.quality.record_quality import DRIFT_CYCLES, shortest_stuck

if TYPE_CHECKING:
    from jackettwin.records.quality.record_quality import Quality
    from jackettwin.records.record import Record


def repair(record: Record, quality: Quality) -> Record:
    """Return the record without the faults that ``assess`` found with certainty.

    Raises
    ------
    InputError
        If the quality is of another record, or no live channel is left.
    """
    if quality.suspect.shape != record.data.shape or [q.name for q in quality.channels] != list(
        record.channel_names
    ):
        raise InputError("quality is of another record", file=record.name, remedy="assess this record first")
    fixed = {(f.subject, f.code) for f in quality.findings if f.repaired}
    data = record.data
    if fixed or quality.suspect.any():
        data = np.where(quality.suspect, np.nan, record.data)
    for i, name in enumerate(record.channel_names):
        if (name, "drift") in fixed:
            data[i : i + 1] = filters.remove_slow(data[i : i + 1], DRIFT_CYCLES / data.shape[1])
        if (name, "sign_turned") in fixed:
            data[i] = -data[i]
    data = in_step(data, quality.clocks, record.sample_rate_hz)
    strangers = (one for one in quality.clocks.strangers if not one.perhaps_across)
    apart = {i for one in strangers if one.fewer and not one.backwards for i in one.rows}
    alive = [i for i, channel in enumerate(quality.channels) if not channel.dead and i not in apart]
    if not alive:
        raise InputError(
            "no channel carries a signal",
            field="channels",
            value=", ".join(record.channel_names),
            allowed="at least one channel that varies",
            remedy="check sensors and logger",
        )
    done = [str(f) for f in quality.findings if f.repaired]
    return replace(
        record,
        data=data if len(alive) == len(data) else data[alive],
        channels=tuple(record.channels[i] for i in alive),
        metadata={**record.metadata, "repair": done} if done else record.metadata,
    )


def common_time(record: Record, quality: Quality) -> Record:
    """Return the record cut to the samples that all channels share after correction of their clocks."""
    n, rate = record.data.shape[1], record.sample_rate_hz
    first, last = stretch(quality.clocks, n, rate)
    if (first, last) == (0, n):
        return record
    start = record.start_utc
    if start is not None:
        start += timedelta(seconds=first / rate)
    return replace(record, data=record.data[:, first:last], start_utc=start)


def without_stuck(record: Record) -> tuple[Record, dict[str, float]]:
    """Return the record with frozen readings of its vibrations missing, and their shares by channel."""
    shortest = shortest_stuck(record.sample_rate_hz)
    masks = {
        i: mask
        for i, channel in enumerate(record.channels)
        if channel.quantity in VIBRATIONS and (mask := faults.stuck(record.data[i], shortest)).any()
    }
    if not masks:
        return record, {}
    data = record.data.copy()
    for i, mask in masks.items():
        data[i, mask] = np.nan
    shares = {record.channels[i].name: float(mask.mean()) for i, mask in masks.items()}
    return replace(record, data=data), shares
