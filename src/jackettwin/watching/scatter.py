r"""Increased scatter: a failing sensor increases the scatter of its modes before it shifts them.

The scatter within hours is χ² times the noise variance, which varies slightly from day to day. If this
variation is a factor distributed as the inverse of χ²_ν/ν, a day's χ²/n over n degrees of freedom has
Fisher's distribution F(n, ν), and a noise standard deviation increased by the factor g has the likelihood
ratio

.. math:: \ln L = -\tfrac{n}{2} \ln g^2 - \tfrac{n + ν}{2} \ln \frac{1 + χ^2/(ν g^2)}{1 + χ^2/ν}

A rejected outlier is none of this noise, of which one value in 150,000 is rejected. Its likelihood ratio is
that of being rejected: 1 + 2Φ(−4.5/g) over the share of the baseline's values that were rejected.
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammaln, ndtr

from jackettwin.arrays import FloatArray
from jackettwin.watching.hours import OUTLIER

STRONGER = (1.6, 2.5, 4.0)
"""Tested factors on the standard deviation of the noise."""
_STEADINESS = np.array([4.0, 6.0, 10.0, 16.0, 30.0, 60.0, 200.0])
"""Degrees of freedom ν that are tried."""
_DOUBT = 1.0
"""Reduction of the baseline's log likelihood that is accepted for a lower ν."""


def steadiness(chi2: FloatArray, freedom: FloatArray) -> float:
    """Return the lowest ν that is compatible with the days of a baseline.

    Parameters
    ----------
    chi2, freedom : (n_days,) scatter of one quantity over the mean noise variance, and its degrees of freedom
    """
    kept = freedom > 0.0
    x, n = chi2[kept], freedom[kept]
    if x.size < 5:
        return float(_STEADINESS[0])
    likelihood = np.array([
        np.sum(gammaln((n + v) / 2) - gammaln(v / 2) - n / 2 * np.log(v) - (n + v) / 2 * np.log1p(x / v))
        for v in _STEADINESS
    ])  # fmt: skip
    return float(_STEADINESS[np.flatnonzero(likelihood >= likelihood.max() - _DOUBT)[0]])


def log_ratios(chi2: FloatArray, freedom: FloatArray, nu: FloatArray) -> FloatArray:
    """Return ln L of one day for each quantity and factor, (m, n_factors); 0 where there is no value.

    Parameters
    ----------
    chi2, freedom, nu : (m,)
    """
    g2 = np.array(STRONGER) ** 2
    x, n, v = chi2[:, None], freedom[:, None], nu[:, None]
    return np.asarray(-0.5 * n * np.log(g2) - 0.5 * (n + v) * (np.log1p(x / (v * g2)) - np.log1p(x / v)))


def log_outlier_ratios(share: FloatArray) -> FloatArray:
    """Return ln L of one rejected value by the share of the baseline's that were rejected, (m, n_factors).

    Examples
    --------
    >>> log_outlier_ratios(np.array([0.004])).round(1)
    array([[0.8, 2.9, 4.2]])
    """
    louder = 2.0 * ndtr(-OUTLIER / np.array(STRONGER))
    return np.asarray(np.log1p(louder / share[:, None]))
