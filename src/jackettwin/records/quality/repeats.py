"""Repeated samples: a file that stores each sample several times, or a channel that copies another.

Two loggers of different rates in one table leave blanks, and a record that was brought to another rate by
holding its values has their number in each group differ by one.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy  # scipy.signal is loaded where it is used

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.findings import Finding
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.quality import faults
from jackettwin.records.record import Record


def without_repeats(record: Record) -> tuple[Record, int]:
    """Return a record with each sample once, at the lower rate, and the number of repetitions.

    This requires that all varying vibration channels repeat alike; otherwise the record is unchanged, with 1.

    Examples
    --------
    >>> from jackettwin.records import Channel
    >>> data = np.repeat(np.random.default_rng(1).normal(size=(2, 50)), 3, axis=1)
    >>> once, times = without_repeats(Record(data, 30.0, (Channel("a"), Channel("b"))))
    >>> times, once.sample_rate_hz, once.data.shape
    (3, 10.0, (2, 50))
    """
    rows = [
        i
        for i, channel in enumerate(record.channels)
        if channel.quantity in VIBRATIONS and not faults.is_constant(record.data[i])
    ]
    times = {faults.hold_length(record.data[i]) for i in rows}
    if len(times) != 1 or times == {1}:
        return record, 1
    (each,) = times
    # the first of each group of equal samples, where most channels change
    change = np.nonzero(np.diff(record.data[rows], axis=1))[1] + 1
    first = int(np.bincount(change % each, minlength=each).argmax())
    return replace(
        record, data=record.data[:, first::each], sample_rate_hz=record.sample_rate_hz / each
    ), each


REGULAR, FEWEST_GROUPS = 0.99, 50
"""Least share of the groups of equal samples whose lengths differ by one at most, and least number."""
MOST_BLANK = 50
"""Most samples from one that is there to the next: fewer would not show a tower's modes."""


def each_sample_once(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Keep one of the samples that every channel repeats, and fill the blanks of slower channels.

    Repetitions cause images of the modes.
    """
    once, times = without_repeats(record)
    if times > 1:
        return once, (Finding("samples_repeated", params={"times": times}),)
    once = without_holding(record)
    if once is not record:
        return once, (Finding("resampled_by_holding", params={"rate_hz": once.sample_rate_hz}),)
    return without_blanks(record)


def without_holding(record: Record) -> Record:
    """Return a record at the rate it had before it was brought to a higher one by holding its values.

    All vibration channels change at the same instants, which are m or m + 1 samples apart; the record is
    unchanged otherwise.

    Examples
    --------
    >>> from jackettwin.records import Channel
    >>> slow = np.random.default_rng(1).normal(size=(2, 100))
    >>> held = slow[:, (np.arange(1250) * 4 / 50).astype(int)]
    >>> once = without_holding(Record(held, 50.0, (Channel("a"), Channel("b"))))
    >>> round(once.sample_rate_hz, 2), bool(np.all(once.data == slow[:, 1:-1]))
    (4.0, True)
    """
    changed = np.zeros(max(record.data.shape[1] - 1, 0), dtype=np.bool_)
    for channel, row in zip(record.channels, record.data, strict=True):  # a day's copy takes fifty megabytes
        if channel.quantity in VIBRATIONS:
            changed |= row[1:] != row[:-1]
            if 2 * np.count_nonzero(changed) > changed.size or not np.isfinite(row).all():
                return record
    start = 1 + np.flatnonzero(changed)
    length = np.diff(start)
    if len(length) < FEWEST_GROUPS:
        return record
    least = int(length.mean())
    if least < 2 or np.mean((length == least) | (length == least + 1)) < REGULAR:
        return record
    # a straight line through the instants: each is late by a part of a sample
    rate = record.sample_rate_hz / float(np.polyfit(np.arange(len(start)), start, 1)[0])
    return replace(record, data=record.data[:, start[:-1]], sample_rate_hz=rate)


def without_blanks(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Return a record whose channels of a lower rate, blank between their samples, are interpolated.

    By a low-pass filter; the ends before the first and after the last sample stay missing.
    """
    data, findings = record.data, []
    for i, channel in enumerate(record.channels):
        there = np.isfinite(record.data[i])
        times = _blank_steps(there) if channel.quantity in VIBRATIONS else 1
        if times == 1:
            continue
        data = data.copy() if data is record.data else data
        at = np.flatnonzero(there)
        own = record.data[i, at[0] : at[-1] + 1 : times]
        known = np.isfinite(own)
        middle = float(own[known].mean())
        filled = np.interp(np.arange(len(own)), np.flatnonzero(known), own[known]) - middle
        dense = middle + scipy.signal.resample_poly(filled, times, 1)[: at[-1] + 1 - at[0]]
        dense[_beside_missing(known, times)[: len(dense)]] = np.nan
        data[i] = np.nan
        data[i, at[0] : at[-1] + 1] = dense
        slower = {"times": times, "rate_hz": record.sample_rate_hz / times}
        findings.append(Finding("blanks_filled", channel.name, slower))
    return (replace(record, data=data) if findings else record), tuple(findings)


def _beside_missing(known: BoolArray, times: int) -> BoolArray:
    """Return which interpolated samples lie between a missing one and those next to it, (n · times,)."""
    missing = np.kron(~known, np.arange(times) == 0)
    return np.asarray(np.convolve(missing, np.ones(2 * times - 1), "same") > 0)


def _blank_steps(there: BoolArray) -> int:
    """Return the steps from one sample that is there to the next; 1 if they are not all multiples of it."""
    if 2 * np.count_nonzero(there) > there.size + 1:
        return 1
    steps = np.diff(np.flatnonzero(there))
    if len(steps) < FEWEST_GROUPS:
        return 1
    usual = int(np.median(steps))
    regular = 1 < usual <= MOST_BLANK and not np.any(steps % usual)
    return usual if regular and np.mean(steps == usual) >= REGULAR else 1


ROUNDING = 1e-6
"""Largest difference of two copies, as a share of their rms: that of a file with seven digits.
Two sensors differ by their noise, at least a hundred times that."""


def duplicate_channels(y: FloatArray) -> dict[int, int]:
    """Return the rows that copy an earlier one, with that row.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample; offsets do not matter.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> a, b = rng.standard_normal((2, 1000))
    >>> duplicate_channels(np.array([a, b, a + 3.0, -b]))
    {2: 0}
    """
    size = np.nanstd(y, axis=1)
    out: dict[int, int] = {}
    for i in range(1, len(y)):
        for j in range(i):
            # comparing sizes first avoids most of the work
            if j in out or abs(size[i] - size[j]) > ROUNDING * size[j]:
                continue
            both = np.isfinite(y[i]) & np.isfinite(y[j])
            if both.any() and float(np.std(y[i, both] - y[j, both])) <= ROUNDING * size[j]:
                out[i] = j
                break
    return out
