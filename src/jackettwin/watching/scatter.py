r"""Increased scatter: a failing sensor scatters its modes before it shifts them.

The scatter within hours is χ² times the noise variance, which varies a little from day to day,
as the baseline shows. With a factor distributed as the inverse of χ²_ν/ν, a day's χ²/n over n degrees of
freedom has Fisher's distribution F(n, ν), and noise increased by g has the likelihood ratio

.. math:: \ln L = -\tfrac{n}{2} \ln g^2 - \tfrac{n + ν}{2} \ln \frac{1 + χ^2/(ν g^2)}{1 + χ^2/ν}
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammaln

from jackettwin.arrays import FloatArray

STRONGER = (1.6, 2.5, 4.0)
"""Factors on the noise's standard deviation that are bet on."""
_STEADINESS = np.array([4.0, 6.0, 10.0, 16.0, 30.0, 60.0, 200.0])
"""Degrees of freedom ν that are tried."""
_DOUBT = 1.0
"""Log likelihood over the baseline that may be lost for a lower ν."""


def steadiness(chi2: FloatArray, freedom: FloatArray) -> float:
    """Return ν from the days of a baseline, the lowest one they allow.

    Parameters
    ----------
    chi2, freedom : (n_days,) of one quantity, in units of the noise's mean variance
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
    """Return ln L of one day for each quantity and factor, (m, n_factors); 0 where nothing was seen.

    Parameters
    ----------
    chi2, freedom, nu : (m,)
    """
    g2 = np.array(STRONGER) ** 2
    x, n, v = chi2[:, None], freedom[:, None], nu[:, None]
    return np.asarray(-0.5 * n * np.log(g2) - 0.5 * (n + v) * (np.log1p(x / (v * g2)) - np.log1p(x / v)))
