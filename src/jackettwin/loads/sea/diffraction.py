"""Diffraction of waves by a wide vertical cylinder: MacCamy & Fuchs (1954, Beach Erosion Board TM 69)."""

from __future__ import annotations

import numpy as np
from scipy.special import h2vp

from jackettwin.arrays import ComplexArray, FloatArray

_SLENDER = 1e-3
"""ka below which the factor is set to 1: the error is 1e-6, and the formula would be a ratio of large
numbers."""


def scattered(k: FloatArray, diameter: FloatArray) -> ComplexArray:
    r"""Return the complex factor on the inertia force of each wave on each cylinder, (n, n_waves).

    .. math:: m = \frac{-2i}{π (ka)^2 H_1^{(2)\prime}(ka)}, \qquad C_M = 2|m|

    with a the radius and time e^{+iωt}; m is 1 for a slender cylinder.

    Parameters
    ----------
    k : (n_waves,) wave numbers [rad/m]
    diameter : (n,) [m]

    Examples
    --------
    >>> m = scattered(np.array([1.0]), np.array([1e-6, 2.0]))[:, 0]
    >>> [round(float(2.0 * abs(one)), 4) for one in m]
    [2.0, 1.3716]
    """
    ka = np.maximum(0.5 * np.outer(diameter, k), _SLENDER)
    return np.asarray(-2j / (np.pi * ka**2 * h2vp(1, ka)))
