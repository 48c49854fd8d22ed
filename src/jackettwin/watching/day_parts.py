r"""A day within which a structure changed, in two parts.

A step in the middle of a day is scatter to whoever takes the day as a whole, and half as large. The day is
divided at the record where the two sides lie furthest apart,

.. math:: d^2(k) = \sum_q \frac{(\bar y_{q,>k} - \bar y_{q,\le k})^2}{v_q (1/n_{\le k} + 1/n_{>k})}

if their medians say so as well, which single outliers do not move.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.watching.hours import ENOUGH

APART = 30.0
"""Squared distance of two sides, in variances and beyond one for each quantity, from which a day is divided:
where nothing changes, of one day in some thousands."""
_CLIPPED = 8.0
"""Distance from the day's median, in standard deviations, beyond which a value counts as no farther off."""
_MEDIAN_VARIANCE = 0.5 * np.pi
"""Variance of a median over that of the mean of as many normal values."""
INSIDE = 0.1
"""Share of a day's stake on a change within it."""


def divided(rest: FloatArray, variance: FloatArray) -> tuple[int, int] | None:
    """Return before which record of a day it is divided, and between how many places was chosen; or None.

    Parameters
    ----------
    rest : (n, m) values less what conditions explain, NaN where missing
    variance : (n, m) of their noise and of what moves within a day
    """
    seen = np.isfinite(rest)
    n = len(rest)
    if n < 2 * ENOUGH or not seen.any():
        return None
    middle, typical = _medians(rest, seen), _medians(variance, seen)
    std = np.sqrt(np.where(typical > 0.0, typical, 1.0))
    z = np.where(seen, np.clip((rest - middle) / std, -_CLIPPED, _CLIPPED), 0.0)
    before = np.cumsum(seen, axis=0)[ENOUGH - 1 : n - ENOUGH]
    sum_before = np.cumsum(z, axis=0)[ENOUGH - 1 : n - ENOUGH]
    after, sum_after = seen.sum(axis=0) - before, z.sum(axis=0) - sum_before
    both = (before >= ENOUGH) & (after >= ENOUGH)
    with np.errstate(invalid="ignore", divide="ignore"):
        gap = sum_after / after - sum_before / before
        square = np.where(both, gap**2 / (1.0 / before + 1.0 / after), 0.0)
    place = int(np.argmax(square.sum(axis=1)))
    chosen = np.flatnonzero(both[place])
    cut = place + ENOUGH
    distance = 0.0
    for q in chosen:
        x, good = rest[:, q] * np.sign(gap[place, q]), seen[:, q]
        low, high = np.sort(x[:cut][good[:cut]]), np.sort(x[cut:][good[cut:]])
        # of an even number the middle one that is nearer: not more than half of a side is off by chance
        between = max(high[(high.size - 1) // 2] - low[low.size // 2], 0.0)
        spread = std[q] ** 2 * _MEDIAN_VARIANCE * (1.0 / low.size + 1.0 / high.size)
        distance += float(between**2 / spread)
    return (cut, n - 2 * ENOUGH + 1) if distance > APART + chosen.size else None


def _medians(x: FloatArray, seen: BoolArray) -> FloatArray:
    """Return the median of each column's values that were seen; 0 where none was."""
    return np.array([np.median(a[s]) if s.any() else 0.0 for a, s in zip(x.T, seen.T, strict=True)])
