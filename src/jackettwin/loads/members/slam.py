r"""Impact loads of water: slamming on horizontal members, breaking waves on vertical ones.

Both last for hundredths of a second; the peak force must not be used as a static load.
"""

from __future__ import annotations

from math import pi

from jackettwin.errors import require_between

CURLING = 0.46
"""Curling factor λ: share of a plunging crest that hits a vertical cylinder at once (Wienke & Oumeraci
2005)."""


def slam_coefficient(submergence_m: float, diameter_m: float) -> float:
    r"""Return the slamming coefficient C_s of a horizontal cylinder, with f = ½ ρ C_s D w².

    .. math:: C_s = 5.15 \left(\frac{D}{D + 19 s} + 0.107 \frac{s}{D}\right)

    Campbell & Weynberg (1980), as in DNV-RP-C205 (2010), section 8; s from 0, at first contact, to D.

    Raises
    ------
    InputError
        If the submergence is not between zero and the diameter.

    >>> slam_coefficient(0.0, 1.2)
    5.15
    """
    require_between("diameter_m", diameter_m, 1e-3, 1e3)
    require_between("submergence_m", submergence_m, 0.0, diameter_m)
    D, s = diameter_m, submergence_m
    return 5.15 * (D / (D + 19.0 * s) + 0.107 * s / D)


def slam_per_length(speed_m_s: float, diameter_m: float, *, density_kg_m3: float) -> float:
    """Return the largest force per length [N/m] on a horizontal cylinder hit by water at a given speed."""
    return 0.5 * density_kg_m3 * slam_coefficient(0.0, diameter_m) * diameter_m * speed_m_s**2


def breaking_impact(crest_m: float, celerity_m_s: float, diameter_m: float, *, density_kg_m3: float) -> float:
    r"""Return the largest force [N] of a wave breaking at a vertical cylinder, :math:`2π λ η_b ρ R C^2`.

    Wienke & Oumeraci (2005, Coastal Eng. 52:435–462), adopted by IEC 61400-3-1, at the first instant.
    Morison's forces must be added.

    Parameters
    ----------
    crest_m : crest height η_b over still water
    celerity_m_s : celerity C
    """
    return 2.0 * pi * CURLING * crest_m * density_kg_m3 * 0.5 * diameter_m * celerity_m_s**2
