"""Intervals of positive quantities, symmetric on the logarithm."""

from __future__ import annotations

import math

TWO_SIDED_95 = 1.959964
"""Standard deviations to either side that hold 95 % of a Gaussian."""
MOST = 50.0
"""Logarithm beyond which an interval says nothing, and its ends would overflow."""


def log_interval_95(value: float, log_std: float) -> tuple[float, float]:
    """Return the 95 % interval of a positive value whose logarithm has a standard deviation.

    Examples
    --------
    >>> low, high = log_interval_95(0.02, 0.1)
    >>> round(low, 5), round(high, 5)
    (0.01644, 0.02433)
    """
    factor = math.exp(min(TWO_SIDED_95 * float(log_std), MOST))
    return float(value) / factor, float(value) * factor
