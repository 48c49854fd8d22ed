"""Numbers that loggers write where they have none: −9999, 1e30, the ends of an integer's range."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray

SENTINELS = np.array(
    [
        *(-99.9, -999.0, -999.25, -999.9, -9999.0, -9999.25, -99999.0, -999999.0, 9999.0, 99999.0, 999999.0),
        *(32767.0, -32767.0, -32768.0, 65535.0, 2147483647.0, -2147483648.0),
        *(1e20, 1e30, -1e30, 1e35, 1e37, np.float64(np.float32(9.96921e36)), 1e38),
    ]
)
"""Values that stand for none, in the file's own unit."""
FAR = 2.0
"""A value that stands for none lies farther from all others than this many times their range."""
LEAST = 2
"""How often it must be there."""


def without_sentinels(y: FloatArray) -> tuple[FloatArray, float | None, int]:
    """Return a channel with missing samples where it holds a sentinel, which one, and how many.

    A value counts if it is exactly one of ``SENTINELS``, at least twice, and far from everything else; so a
    power of 9999 kW stays, and so does what is clipped at the end of a range.

    Examples
    --------
    >>> y, value, count = without_sentinels(np.array([0.1, -9999.0, 0.3, -9999.0, 0.2]))
    >>> y.tolist(), value, count
    ([0.1, nan, 0.3, nan, 0.2], -9999.0, 2)
    """
    hits = np.isin(y, SENTINELS)
    if np.count_nonzero(hits) < LEAST:
        return y, None, 0
    values, counts = np.unique(y[hits], return_counts=True)
    value, count = float(values[np.argmax(counts)]), int(counts.max())
    rest = y[np.isfinite(y) & ~np.isin(y, SENTINELS)]
    if count < LEAST or not rest.size:
        return y, None, 0
    low, high = float(rest.min()), float(rest.max())
    if max(low - value, value - high) <= FAR * (high - low):
        return y, None, 0
    return np.where(y == value, np.nan, y), value, count
