"""Central intervals of 90 %, the one level that is printed: normal ones, of draws, and on the logarithm."""

from __future__ import annotations

import math

import numpy as np

from jackettwin.arrays import FloatArray

QUANTILES = (0.05, 0.5, 0.95)
"""Lower end, median and upper end of every printed interval; names of fields say its level: 90 %."""
NORMAL_90 = 1.6448536269514722
"""Half a central 90 % interval of a normal distribution, in standard deviations."""
NORMAL_95 = 1.959963984540054
"""The same of 95 %: for tests with one false alarm in twenty, and for what others state."""
NORMAL_OF_MAD = 1.4826
"""Standard deviation of a normal distribution over its median absolute deviation, 1/Φ⁻¹(3/4)."""
MOST = 50.0
"""Logarithm beyond which an interval says nothing, and its ends would overflow."""


def log_interval_90(value: float, log_std: float) -> tuple[float, float]:
    """Return the 90 % interval of a positive value whose logarithm has a standard deviation.

    Examples
    --------
    >>> low, high = log_interval_90(0.02, 0.1)
    >>> round(low, 5), round(high, 5)
    (0.01697, 0.02358)
    """
    factor = math.exp(min(NORMAL_90 * float(log_std), MOST))
    return float(value) / factor, float(value) * factor


def interval_90(draws: FloatArray) -> tuple[float, float, float] | None:
    """Return (5 % quantile, median, 95 % quantile) of draws without those that are NaN; None if all are.

    Examples
    --------
    >>> interval_90(np.arange(101.0))
    (5.0, 50.0, 95.0)
    """
    kept = draws[~np.isnan(draws)]
    if kept.size == 0:
        return None
    low, middle, high = map(float, np.quantile(kept, QUANTILES))
    return low, middle, high
