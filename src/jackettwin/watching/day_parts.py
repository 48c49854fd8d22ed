r"""Division of a day within which a structure changed.

If a day is evaluated as a whole, a step in its middle appears as scatter and as a step of half its size. The
day is therefore divided at the record where the squared distance between both parts is largest,

.. math:: d^2(k) = \sum_q \frac{(\bar y_{q,>k} - \bar y_{q,\le k})^2}{v_q (1/n_{\le k} + 1/n_{>k})}

provided that their medians, which single outliers do not affect, differ as well. Of a part of a few records
all have to differ: the place is chosen, so that two outliers of a day would otherwise be a part's majority.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.watching.hours import ENOUGH

APART = 30.0
"""Squared distance of both parts, minus the number of quantities, above which a day is divided. Without a
change one day in some thousands exceeds it."""
_CLIPPED = 8.0
"""Distance from the day's median, in standard deviations, to which larger ones are limited."""
_MEDIAN_VARIANCE = 0.5 * np.pi
"""Ratio of the variance of a median to that of the mean of as many normal values."""
_FEW = 5
"""Number of a part's values below which each has to differ: three outliers in a day are rare."""
INSIDE = 0.1
"""Share of a day's prior weight that is assigned to an onset within it."""


def divided(rest: FloatArray, variance: FloatArray) -> tuple[int, int] | None:
    """Return the index of the record before which a day is divided and the number of places tried, or None.

    Parameters
    ----------
    rest : (n, m) residuals after conditions, NaN where missing
    variance : (n, m) variances of their noise and of variation within a day
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
        # the middle value nearer to zero, so that at most half of a part is off by chance
        above = high[0 if high.size < _FEW else (high.size - 1) // 2]
        between = max(above - low[-1 if low.size < _FEW else low.size // 2], 0.0)
        spread = std[q] ** 2 * _MEDIAN_VARIANCE * (1.0 / low.size + 1.0 / high.size)
        distance += float(between**2 / spread)
    return (cut, n - 2 * ENOUGH + 1) if distance > APART + chosen.size else None


def _medians(x: FloatArray, seen: BoolArray) -> FloatArray:
    """Return the median of the available values of each column; 0 where there is none."""
    return np.array([np.median(a[s]) if s.any() else 0.0 for a, s in zip(x.T, seen.T, strict=True)])
