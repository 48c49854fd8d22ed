"""Test whether a record is long enough for its slowest motion."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.findings import Finding
from jackettwin.records.processing.filters import bridge
from jackettwin.records.record import Record

CYCLES = 30
"""Cycles in the record below which motion is too slow: at 2 % damping its damping is uncertain by a factor of
two."""
DRIFT_CYCLES = 3
"""Cycles in the record below which motion is drift."""
SHARE = 0.05
"""Share of a channel's power in motion that is too slow above which a finding is given. White noise has less,
at rates for which thirty cycles are a small part of the record."""
SHORT_S = 120.0
"""Longer records hold thirty cycles of any structure; slower motion is wind, waves or drift."""


def slow_share(y: FloatArray, duration_s: float) -> float:
    """Return the largest share of a channel's power that is too slow for a short record; 0 for long ones.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample.

    Examples
    --------
    >>> t = np.arange(600) / 20.0
    >>> slow, fast = np.sin(2 * np.pi * 0.2 * t), np.sin(2 * np.pi * 3.0 * t)
    >>> round(slow_share(np.array([slow + fast]), 30.0), 2), slow_share(np.array([fast]), 30.0) < 0.01
    (0.5, True)
    """
    if duration_s > SHORT_S or y.shape[1] < 4 * CYCLES:
        return 0.0
    x = np.array([bridge(row) for row in y])
    t = np.linspace(-1.0, 1.0, x.shape[1])
    x = x - np.array([np.polyval(np.polyfit(t, row, 1), t) for row in x])
    power = np.abs(np.fft.rfft(x * np.hanning(x.shape[1]), axis=1)) ** 2
    total = power[:, DRIFT_CYCLES:].sum(axis=1)
    share = power[:, DRIFT_CYCLES : CYCLES + 1].sum(axis=1) / np.where(total > 0.0, total, 1.0)
    return float(share.max(initial=0.0))


def too_short(record: Record) -> tuple[Finding, ...]:
    """Report that most of the motion in a short record is too slow to be identified."""
    share = slow_share(record.data, record.duration_s)
    if share <= SHARE:
        return ()
    params = {"share": share, "cycles": CYCLES, "duration_s": record.duration_s}
    return (Finding("too_short", params=params),)
