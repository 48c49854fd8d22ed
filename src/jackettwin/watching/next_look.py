"""Which further measurement would tell the causes of a change apart."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray

_POINTS = 401
"""Of the grid that a predicted value is integrated on."""
_REACH = 6.0
"""Standard deviations beyond the outermost prediction that the grid goes to."""


def expected_information(probability: FloatArray, mean: FloatArray, std: FloatArray) -> float:
    r"""Return what one value is expected to tell of which cause it was [nats].

    .. math:: I = Σ_c p_c \int p(y|c) \ln \frac{p(y|c)}{p(y)} dy

    Parameters
    ----------
    probability : (n_causes,) adding up to one
    mean, std : (n_causes,) what each cause predicts, with the scatter of the measurement

    Examples
    --------
    >>> two = np.array([0.5, 0.5])
    >>> round(expected_information(two, np.array([0.0, 100.0]), np.ones(2)), 3)  # ln 2: it settles the matter
    0.693
    >>> round(expected_information(two, np.zeros(2), np.ones(2)), 3)
    0.0
    """
    low, high = np.min(mean - _REACH * std), np.max(mean + _REACH * std)
    # a grid that is fine where predictions are sharp: the quantiles of the mixture's parts, put together
    z = np.linspace(-_REACH, _REACH, _POINTS)
    y = np.unique(np.concatenate([(mean[:, None] + std[:, None] * z).ravel(), [low, high]]))
    log_each = -0.5 * ((y - mean[:, None]) / std[:, None]) ** 2 - np.log(np.sqrt(2.0 * np.pi) * std[:, None])
    log_all = np.logaddexp.reduce(log_each + np.log(probability)[:, None], axis=0)
    integrand = probability[:, None] * np.exp(log_each) * (log_each - log_all)
    return max(0.0, float(np.trapezoid(integrand.sum(axis=0), y)))
