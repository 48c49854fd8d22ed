"""Repeated samples: a file that stores each sample several times, or a channel that copies another."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from jackettwin.arrays import FloatArray
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


def each_sample_once(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Keep one of the samples that every channel repeats; repetitions cause aliases of the modes."""
    once, times = without_repeats(record)
    return once, (Finding("samples_repeated", params={"times": times}),) if times > 1 else ()


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
