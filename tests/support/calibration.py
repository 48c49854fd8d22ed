"""Whether intervals hold as often as they say, and deviations are as large: from both sides."""

from __future__ import annotations

import numpy as np
from scipy.stats import binom, chi2

from jackettwin.arrays import FloatArray


def is_calibrated(inside: int, trials: int, share: float = 0.95, *, risk: float = 1e-3) -> bool:
    """Tell whether so many intervals out of so many hold the truth as a share of them should.

    Both tails of the binomial count: intervals that are too wide fail as those that are too narrow do, each
    with a probability of at most ``risk`` where the share is right.
    """
    return bool(binom.cdf(inside, trials, share) >= risk and binom.sf(inside - 1, trials, share) >= risk)


def are_standard(scores: FloatArray, *, risk: float = 1e-3) -> bool:
    """Tell whether errors in units of their stated deviations have a mean square of one, from both sides."""
    z = np.ravel(scores)
    low, high = chi2.ppf([risk, 1.0 - risk], z.size) / z.size
    return bool(low <= np.mean(z**2) <= high)
