r"""Strength of tubular members to ISO 19902, clause 13, without hydrostatic pressure (iso19902_pressure.py).

Symbols are the standard's; stresses are those of factored actions. Equations are those of the 2007 edition.
The 2020 edition keeps the strengths and puts a cosine into the interaction of axial force and bending of a
cross-section (13.3.2, 13.3.3); ``edition`` chooses.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError

GAMMA_T, GAMMA_C, GAMMA_B, GAMMA_V = 1.05, 1.18, 1.05, 1.05
"""Partial resistance factors of 13.2.2, 13.2.3, 13.2.4 and 13.2.5."""
C_X = 0.3
"""Elastic critical buckling coefficient of 13.2.3.3: half the theoretical one, for imperfections."""
MOST_SLENDER_WALL, THINNEST_WALL_M = 120.0, 0.006
HIGHEST_YIELD_PA, HIGHEST_YIELD_RATIO = 500e6, 0.9
"""Scope of clause 13.1: largest D/t, least wall, largest f_y and f_y/f_u."""
EDITIONS = ("2007", "2020")
STEEPEST = 0.99
"""σ_c/f_e beyond which bending is amplified no further; such a column has failed by 13.2.3 already."""


class Tube(NamedTuple):
    """Outer diameter and wall [m], Young's modulus and yield strength [Pa], effective length K·L [m]."""

    D: FloatArray
    t: FloatArray
    E: FloatArray
    f_y: FloatArray
    KL: FloatArray


class Strength(NamedTuple):
    """Representative strengths [Pa]: axial tension, local buckling, column, Euler, bending, shear."""

    f_t: FloatArray
    f_yc: FloatArray
    f_c: FloatArray
    f_e: FloatArray
    f_b: FloatArray
    f_v: FloatArray


class Stress(NamedTuple):
    """Axial (tension positive), elastic bending about two axes, beam shear, torsional shear [Pa]."""

    axial: FloatArray
    bending_y: FloatArray
    bending_z: FloatArray
    shear: FloatArray
    torsion: FloatArray


class Utilisation(NamedTuple):
    """U_m of each check; at most 1. Names and clauses are in ``CHECKS``."""

    tension: FloatArray
    compression: FloatArray
    bending: FloatArray
    shear: FloatArray
    torsion: FloatArray
    section: FloatArray
    stability: FloatArray


CHECKS = {
    "tension": "axial tension, ISO 19902 13.2.2",
    "compression": "axial compression with column buckling, ISO 19902 13.2.3",
    "bending": "bending, ISO 19902 13.2.4",
    "shear": "beam shear, ISO 19902 13.2.5.1",
    "torsion": "torsional shear, ISO 19902 13.2.5.2",
    "section": "axial force and bending of the section, ISO 19902 13.3.2 and 13.3.3",
    "stability": "axial compression and bending of the column, ISO 19902 13.3.3",
}


def strength(tube: Tube) -> Strength:
    r"""Return the representative strengths of tubes.

    .. math::

        f_{xe} = 2 C_x E t/D, \quad f_{yc}/f_y = 1,\; 1.047 - 0.274 f_y/f_{xe},\; f_{xe}/f_y
        \text{ up to } f_y/f_{xe} = 0.170,\; 1.911,\; ∞

        λ = \frac{KL}{πr}\sqrt{f_{yc}/E}, \quad f_c/f_{yc} = 1 - 0.278λ^2,\; 0.9/λ^2
        \text{ up to } λ = 1.34,\; ∞

        f_b\,Z_e/(f_y Z_p) = 1,\; 1.13 - 2.58 x,\; 0.94 - 0.76 x \text{ up to }
        x = f_y D/(E t) = 0.0517,\; 0.1034,\; 120 f_y/E

    """
    D, t, E, f_y, KL = tube
    d = D - 2.0 * t
    r = 0.25 * np.sqrt(D**2 + d**2)
    slender = f_y / (2.0 * C_X * E * t / D)
    f_yc = f_y * np.select(
        [slender <= 0.170, slender <= 1.911], [1.0, 1.047 - 0.274 * slender], 1.0 / slender
    )
    lam = KL / (np.pi * r) * np.sqrt(f_yc / E)
    f_c = f_yc * np.where(lam <= 1.34, 1.0 - 0.278 * lam**2, 0.9 / np.maximum(lam, 1.34) ** 2)
    x = f_y * D / (E * t)
    Z_e, Z_p = np.pi / 32.0 * (D**4 - d**4) / D, (D**3 - d**3) / 6.0
    f_b = f_y * Z_p / Z_e * np.select([x <= 0.0517, x <= 0.1034], [1.0, 1.13 - 2.58 * x], 0.94 - 0.76 * x)
    f_e = np.pi**2 * E / (np.maximum(KL, 1e-9) / r) ** 2
    return Strength(f_y, f_yc, f_c, f_e, f_b, f_y / np.sqrt(3.0))


def utilisation(s: Strength, stress: Stress, *, C_m: float = 1.0, edition: str = "2007") -> Utilisation:
    r"""Return U_m of every check.

    .. math::

        \text{section: } \frac{γ σ_{t|c}}{f_t | f_{yc}} + \frac{γ_b \sqrt{σ_{by}^2 + σ_{bz}^2}}{f_b}, \qquad
        \text{column: } \frac{γ_c σ_c}{f_c}
        + \frac{γ_b}{f_b} \frac{C_m \sqrt{σ_{by}^2 + σ_{bz}^2}}{1 - σ_c/f_e}

    with 1 − cos(π/2 · γσ/f) for the first term of the section in the 2020 edition.

    Parameters
    ----------
    C_m : float
        Moment reduction factor of table 13.5-1; 1 is on the safe side.

    Raises
    ------
    InputError
        If the edition is unknown.
    """
    if edition not in EDITIONS:
        raise InputError(
            "unknown edition of ISO 19902", field="edition", value=edition, allowed=", ".join(EDITIONS)
        )
    tension, compression = np.maximum(stress.axial, 0.0), np.maximum(-stress.axial, 0.0)
    bending = GAMMA_B * np.hypot(stress.bending_y, stress.bending_z) / s.f_b
    axial = GAMMA_T * tension / s.f_t + GAMMA_C * compression / s.f_yc
    if edition == "2020":
        axial = 1.0 - np.cos(0.5 * np.pi * np.minimum(axial, 1.0)) + np.maximum(axial - 1.0, 0.0)
    column = GAMMA_C * compression / s.f_c
    amplified = C_m * bending / (1.0 - np.minimum(compression / s.f_e, STEEPEST))
    return Utilisation(
        GAMMA_T * tension / s.f_t,
        column,
        bending,
        GAMMA_V * np.abs(stress.shear) / s.f_v,
        GAMMA_V * np.abs(stress.torsion) / s.f_v,
        axial + bending,
        np.where(compression > 0.0, column + amplified, 0.0),
    )
