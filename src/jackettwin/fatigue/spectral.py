r"""Damage of a stationary Gaussian stress by its spectrum, without counting: a check on the counting.

With the moments :math:`λ_k = ∫ f^k S(f)\,df` of a one-sided density, peaks a second
:math:`ν_p = \sqrt{λ_4/λ_2}` and the widths :math:`α_1 = λ_1/\sqrt{λ_0λ_2}`, :math:`α_2 = λ_2/\sqrt{λ_0λ_4}`,
Dirlik (1985) gives a density of ranges that is a sum of an exponential and two Rayleigh densities, and Tovo
and Benasciutti (2005) damage between that of level crossings and that of range counting.
"""

from __future__ import annotations

from math import gamma, sqrt

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require

_ONE_LINE = 1e-9
"""Of α₂ from one, within which there is one frequency: its ranges are Rayleigh's, and the formulas 0/0."""


def dirlik(frequency_hz: FloatArray, density: FloatArray, m: float) -> float:
    r"""Return :math:`\sum Δσ^m` of a second, of stress ranges Δσ in the unit of √(density · Hz).

    .. math:: ν_p (2\sqrt{λ_0})^m \left[D_1 Q^m Γ(1+m) + 2^{m/2} Γ(1+m/2) (D_2 |R|^m + D_3)\right]

    Dirlik, Application of computers in fatigue analysis, Warwick 1985.

    Parameters
    ----------
    frequency_hz : (n,) rising
    density : (n,) one-sided [unit²/Hz]
    m : inverse slope of the S-N curve

    Raises
    ------
    InputError
        If the density is negative or nowhere positive, or frequencies do not rise.

    Examples
    --------
    >>> import numpy as np
    >>> f = np.linspace(0.0, 1.0, 20001)
    >>> narrow = np.where(abs(f - 0.3) < 5e-3, 100.0, 0.0)  # unit variance: 0.3 Hz of Rayleigh ranges
    >>> round(dirlik(f, narrow, 3.0) / (0.3 * 8**1.5 * 1.3293404), 2)
    1.0
    """
    l0, l1, l2, l4 = _moments(frequency_hz, density)
    peaks, gamma_2 = sqrt(l4 / l2), l2 / sqrt(l0 * l4)
    if gamma_2 >= 1.0 - _ONE_LINE:
        return float(peaks * (2.0 * sqrt(2.0 * l0)) ** m * gamma(1.0 + 0.5 * m))
    x = l1 / l0 * sqrt(l2 / l4)
    D1 = 2.0 * (x - gamma_2**2) / (1.0 + gamma_2**2)
    R = (gamma_2 - x - D1**2) / (1.0 - gamma_2 - D1 + D1**2)
    D2 = (1.0 - gamma_2 - D1 + D1**2) / (1.0 - R)
    D3 = 1.0 - D1 - D2
    Q = 1.25 * (gamma_2 - D3 - D2 * R) / D1 if D1 else 0.0
    rayleigh = 2.0 ** (0.5 * m) * gamma(1.0 + 0.5 * m) * (D2 * abs(R) ** m + D3)
    return float(peaks * (2.0 * sqrt(l0)) ** m * (D1 * max(Q, 0.0) ** m * gamma(1.0 + m) + rayleigh))


def tovo_benasciutti(frequency_hz: FloatArray, density: FloatArray, m: float) -> float:
    r"""Return :math:`\sum Δσ^m` of a second, as :func:`dirlik`.

    .. math:: \left[b + (1 - b) α_2^{m-1}\right] α_2 ν_p (2\sqrt{2λ_0})^m Γ(1 + m/2)

    Benasciutti & Tovo, Int. J. Fatigue 27 (2005) 867, eqs. (22)–(24).
    """
    l0, l1, l2, l4 = _moments(frequency_hz, density)
    a1, a2 = l1 / sqrt(l0 * l2), l2 / sqrt(l0 * l4)
    narrow = a2 * sqrt(l4 / l2) * (2.0 * sqrt(2.0 * l0)) ** m * gamma(1.0 + 0.5 * m)
    if a2 >= 1.0 - _ONE_LINE:
        return float(narrow)
    widths = 1.112 * (1.0 + a1 * a2 - (a1 + a2)) * np.exp(2.11 * a2) + (a1 - a2)
    b = (a1 - a2) * widths / (a2 - 1.0) ** 2
    return float((b + (1.0 - b) * a2 ** (m - 1.0)) * narrow)


def _moments(f: FloatArray, S: FloatArray) -> tuple[float, float, float, float]:
    """Return λ₀, λ₁, λ₂ and λ₄."""
    require(bool((np.diff(f) > 0.0).all()), "must rise", field="frequency_hz", allowed="rising, one-sided")
    require(
        bool((S >= 0.0).all()) and float(S.max(initial=0.0)) > 0.0,
        "is no spectral density",
        field="density",
        value=float(S.min(initial=0.0)),
        allowed="≥ 0, somewhere positive",
    )
    l0, l1, l2, l4 = (float(np.trapezoid(f**k * S, f)) for k in (0, 1, 2, 4))
    return l0, l1, l2, l4
