"""Lateral soil reaction: p-y curves per metre of pile.

Depth z counts from the bottom of any scour; γ'z is replaced by the effective stress σ'_v, so that layers and
scour act through it.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.ground.curves import CubeRoot, Curve, TabulatedCurve, Tanh

SUBGRADE_ANGLE_DEG = (25.0, 30.0, 35.0, 40.0)
SUBGRADE_MODULUS_N_M3 = (5.4e6, 11e6, 22e6, 45e6)
"""Sand below the water table: values read from API RP 2GEO (2011) figure 8.6-2 (RP 2A figure 6.8.7-1)."""

MATLOCK_Y = (0.0, 0.1, 0.3, 1.0, 3.0, 8.0)
MATLOCK_P = (0.0, 0.23, 0.33, 0.50, 0.72, 1.0)
"""y/y50 and p/pu, static: API RP 2GEO (2011) table 2 after Matlock (1970)."""

SHALLOWEST_REDUCED_ZONE = 2.5
"""Least z_R in pile diameters: API RP 2GEO (2011) section 8.5, RP 2A section 6.8.2."""


def subgrade_modulus(friction_angle_deg: float) -> float:
    """Return the initial modulus of subgrade reaction k of submerged sand [N/m³].

    >>> subgrade_modulus(35.0)
    22000000.0
    """
    return float(np.interp(friction_angle_deg, SUBGRADE_ANGLE_DEG, SUBGRADE_MODULUS_N_M3))


def sand_coefficients(friction_angle_deg: float) -> tuple[float, float, float]:
    """Return C1, C2, C3 of API RP 2GEO (2011) eqs. (8.6-5), (8.6-6).

    The wedge and flow-around resistances of Reese, Cox & Koop (1974, OTC 2080) with K0 = 0.4, which the
    code's figure 8.6-1 plots.
    """
    phi = np.radians(friction_angle_deg)
    alpha, beta = 0.5 * phi, 0.25 * np.pi + 0.5 * phi
    K0, Ka = 0.4, np.tan(0.25 * np.pi - 0.5 * phi) ** 2
    tan_phi, tan_alpha, tan_beta = np.tan(phi), np.tan(alpha), np.tan(beta)
    wedge = tan_beta / np.tan(beta - phi)
    C1 = wedge * tan_beta * tan_alpha + K0 * (
        tan_phi * np.sin(beta) / (np.cos(alpha) * np.tan(beta - phi))
        + tan_beta * (tan_phi * np.sin(beta) - tan_alpha)
    )
    return float(C1), float(wedge - Ka), float(Ka * (tan_beta**8 - 1.0) + K0 * tan_phi * tan_beta**4)


def sand_py(
    *,
    friction_angle_deg: float,
    stress_pa: float,
    z: float,
    D: float,
    cyclic: bool = False,
    modulus_n_m3: float | None = None,
) -> Tanh:
    """Return p = A pu tanh(k z y / (A pu)), API RP 2GEO (2011) eq. (8.6-7) after O'Neill & Murchison (1983).

    Parameters
    ----------
    friction_angle_deg : float
    stress_pa : float
        Vertical effective stress σ'_v.
    z, D : float
        Depth and pile diameter [m].
    cyclic : bool
        A = 0.9 instead of max(3 − 0.8 z/D, 0.9).
    modulus_n_m3 : float, optional
        k; default ``subgrade_modulus``.
    """
    C1, C2, C3 = sand_coefficients(friction_angle_deg)
    pu = min(C1 * z + C2 * D, C3 * D) * stress_pa
    A = 0.9 if cyclic else max(3.0 - 0.8 * z / D, 0.9)
    k = subgrade_modulus(friction_angle_deg) if modulus_n_m3 is None else modulus_n_m3
    return Tanh(capacity=A * pu, initial_stiffness=k * z)


def soft_clay_capacity(*, strength_pa: float, stress_pa: float, z: float, D: float, J: float) -> float:
    """Return pu = min((3 s_u + σ'_v) D + J s_u z, 9 s_u D) [N/m], API RP 2GEO (2011) eqs. (8.5-1), -2."""
    return min((3.0 * strength_pa + stress_pa) * D + J * strength_pa * z, 9.0 * strength_pa * D)


def soft_clay_py(
    *,
    strength_pa: float,
    stress_pa: float,
    z: float,
    D: float,
    strain_50: float,
    J: float = 0.5,
    cyclic: bool = False,
    form: str = "table",
) -> Curve:
    """Return Matlock's (1970, OTC 1204) curve with y50 = 2.5 ε50 D.

    Cyclic: p stops growing at 0.72 pu (y = 3 y50); above the depth z_R it then falls to 0.72 pu z/z_R at
    15 y50, where z/z_R = (σ'_v D + J s_u z)/(6 s_u D) and z_R is at least 2.5 D (section 8.5: "minimum values
    of X_R should be about 2.5 pile diameters").

    Parameters
    ----------
    form : {"table", "cube-root"}
        The code's points joined by lines, or Matlock's parabola p = ½ pu (y/y50)^⅓ (static only). Both start
        with 0.23 pu/(0.1 y50) for linear analyses.

    Raises
    ------
    InputError
        If the form is unknown.
    """
    pu = soft_clay_capacity(strength_pa=strength_pa, stress_pa=stress_pa, z=z, D=D, J=J)
    y50 = 2.5 * strain_50 * D
    if form not in ("table", "cube-root") or (cyclic and form != "table"):
        raise InputError(
            "unknown form of the clay curve", field="form", value=form, allowed="table, cube-root (static)"
        )
    if form == "cube-root":
        return CubeRoot(capacity=pu, y50=y50, initial_stiffness=0.23 * pu / (0.1 * y50))
    y, p = np.array(MATLOCK_Y), np.array(MATLOCK_P)
    if cyclic:
        reached = (stress_pa * D + J * strength_pa * z) / (6.0 * strength_pa * D) if strength_pa else 1.0
        depth_share = min(reached, z / (SHALLOWEST_REDUCED_ZONE * D))
        y = np.array([*MATLOCK_Y[:5], 15.0])
        p = np.array([*MATLOCK_P[:5], 0.72 * min(depth_share, 1.0)])
    return _table(y * y50, p * pu)


def stiff_clay_py(
    *,
    strength_pa: float,
    stress_pa: float,
    z: float,
    D: float,
    strain_50: float,
    cyclic: bool = False,
    mean_strength_pa: float | None = None,
) -> TabulatedCurve:
    """Return the curve of stiff clay below water, Reese, Cox & Koop (1975, OTC 2312), as a fine table.

    pc = min((2 s_a + σ'_v) D + 2.83 s_a z, 11 s_u D) with the mean strength s_a down to z (s_u by default);
    y50 = ε50 D; the curve starts along k_s z y, with k_s 135, 270, 540 MN/m³ (cyclic 55, 110, 217) at s_a 75,
    150, 300 kPa. A_s and A_c of the paper's figure are taken as 0.2 + 0.4 tanh(0.62 z/D) and
    0.2 + 0.1 tanh(1.5 z/D).
    """
    mean = strength_pa if mean_strength_pa is None else mean_strength_pa
    pc = min((2.0 * mean + stress_pa) * D + 2.83 * mean * z, 11.0 * strength_pa * D)
    modulus = (55e6, 110e6, 217e6) if cyclic else (135e6, 270e6, 540e6)
    k = float(np.interp(mean, (75e3, 150e3, 300e3), modulus))
    A = 0.2 + (0.1 * np.tanh(1.5 * z / D) if cyclic else 0.4 * np.tanh(0.62 * z / D))
    end = (1.8 * 4.1 if cyclic else 18.0) * A
    r = end * np.linspace(0.0, 1.0, 401) ** 2
    p = pc * (_reese_cyclic(r, A) if cyclic else _reese_static(r, A))
    y = r * strain_50 * D
    return _table(y, np.minimum(k * max(z, 1e-3) * y, p))


def dry_stiff_clay_py(
    *,
    strength_pa: float,
    stress_pa: float,
    z: float,
    D: float,
    strain_50: float,
    J: float = 0.5,
    cycles: float = 0.0,
    mean_strength_pa: float | None = None,
) -> TabulatedCurve:
    """Return the curve of stiff clay without free water, Welch & Reese (1972), as a fine table.

    p = ½ pu (y/y50)^¼ up to pu at 16 y50 with y50 = 2.5 ε50 D and
    pu = min((3 s_a + σ'_v) D + J s_a z, 9 s_u D); ``cycles`` N of one size widen it to
    y + 9.6 (p/pu)⁴ y50 log N. It starts along its chord to 0.1 y50.
    """
    mean = strength_pa if mean_strength_pa is None else mean_strength_pa
    pu = min((3.0 * mean + stress_pa) * D + J * mean * z, 9.0 * strength_pa * D)
    r = np.concatenate([[0.0], 0.1 * 160.0 ** np.linspace(0.0, 1.0, 120)])
    p = 0.5 * r**0.25
    widened = r + 9.6 * p**4 * np.log10(max(cycles, 1.0))
    return _table(widened * 2.5 * strain_50 * D, p * pu)


def _reese_static(r: FloatArray, A: float) -> FloatArray:
    """Return p/pc at r = y/y50: a parabola, a fall, a straight line from 6A to 18A."""
    fall = 0.055 * (np.maximum(r - A, 0.0) / A) ** 1.25
    line = 0.5 * np.sqrt(6.0 * A) - 0.411 - 0.0625 * (r - 6.0 * A)
    return np.maximum(np.where(r <= 6.0 * A, 0.5 * np.sqrt(r) - fall, line), 0.0)


def _reese_cyclic(r: FloatArray, A: float) -> FloatArray:
    """Return p/pc at r = y/y50: an arch about 0.45 r_p, a line from 0.6 r_p to 1.8 r_p; r_p = 4.1 A."""
    rp = 4.1 * A
    arch = A * (1.0 - np.abs(r / (0.45 * rp) - 1.0) ** 2.5)
    return np.maximum(np.where(r <= 0.6 * rp, arch, 0.936 * A - 0.085 * (r - 0.6 * rp)), 0.0)


def _table(y: FloatArray, p: FloatArray) -> TabulatedCurve:
    return TabulatedCurve(tuple(map(float, y)), tuple(map(float, p)))
