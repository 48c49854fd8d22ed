"""Axial soil reaction: t-z curves per metre of pile, the q-z curve of the tip."""

from __future__ import annotations

import numpy as np

from jackettwin.errors import InputError
from jackettwin.soil.ground.curves import TabulatedCurve

TZ_Z = (0.0, 0.0016, 0.0031, 0.0057, 0.0080, 0.0100, 0.0200)
TZ_T = (0.0, 0.30, 0.50, 0.75, 0.90, 1.00)
"""z/D and t/t_max up to the peak; at the last z/D the residual is reached: API RP 2GEO (2011) table 2."""

QZ_Z = (0.0, 0.002, 0.013, 0.042, 0.073, 0.100)
QZ_Q = (0.0, 0.25, 0.50, 0.75, 0.90, 1.00)
"""z/D and Q/Q_p: API RP 2GEO (2011) table 3."""

SAND_PEAK_RP2A_M = 0.00254
"""Displacement at the peak of sand's t-z curve, 0.1 inch: API RP 2A-WSD (2000) section 6.7.2."""


def clay_friction(*, strength_pa: float, stress_pa: float) -> float:
    """Return f = α s_u [Pa], API RP 2GEO (2011) eqs. (8.1-2), (8.1-3).

    ψ = s_u/σ'_v; α = ½ψ^−½ for ψ ≤ 1, ½ψ^−¼ beyond, at most 1.

    >>> round(clay_friction(strength_pa=80e3, stress_pa=100e3), 3)
    44721.36
    """
    if strength_pa == 0.0 or stress_pa == 0.0:
        return 0.0
    psi = strength_pa / stress_pa
    alpha = 0.5 * psi ** (-0.5 if psi <= 1.0 else -0.25)
    return float(min(alpha, 1.0) * strength_pa)


def sand_friction(*, stress_pa: float, beta: float, limit_pa: float) -> float:
    """Return f = β σ'_v up to its limit [Pa], API RP 2GEO (2011) eq. (8.1-4) and table 1."""
    return min(beta * stress_pa, limit_pa)


def clay_tz(*, friction_pa: float, D: float, residual: float = 0.9) -> TabulatedCurve:
    """Return t(z) of clay [N/m]: the peak at 1 % D, then down to ``residual`` (0.7 to 0.9) at 2 % D."""
    t = friction_pa * np.pi * D
    return TabulatedCurve(tuple(D * z for z in TZ_Z), tuple(t * share for share in (*TZ_T, residual)))


def sand_tz(*, friction_pa: float, D: float, form: str = "rp2geo") -> TabulatedCurve:
    """Return t(z) of sand [N/m].

    Parameters
    ----------
    form : {"rp2geo", "rp2a"}
        ``rp2geo``: the normalised curve with its peak at 1 % D (API RP 2GEO, ISO 19901-4). ``rp2a``: a
        straight line to the peak at 2.54 mm (API RP 2A-WSD), four times as stiff or more for large piles.

    Raises
    ------
    InputError
        If the form is unknown.
    """
    t = friction_pa * np.pi * D
    if form == "rp2geo":
        return TabulatedCurve(tuple(D * z for z in TZ_Z[:-1]), tuple(t * share for share in TZ_T))
    if form == "rp2a":
        return TabulatedCurve((0.0, SAND_PEAK_RP2A_M), (0.0, t))
    raise InputError(
        "unknown form of the sand t-z curve", field="sand_tz", value=form, allowed="rp2geo, rp2a"
    )


def clay_bearing(strength_pa: float) -> float:
    """Return q = 9 s_u [Pa], API RP 2GEO (2011) eq. (8.1-5)."""
    return 9.0 * strength_pa


def sand_bearing(*, stress_pa: float, bearing_factor: float, limit_pa: float) -> float:
    """Return q = N_q σ'_v up to its limit [Pa], API RP 2GEO (2011) eq. (8.1-6) and table 1."""
    return min(bearing_factor * stress_pa, limit_pa)


def tip_qz(*, bearing_pa: float, D: float, area_m2: float) -> TabulatedCurve:
    """Return Q(z) of the pile tip [N] on ``area_m2``: the full base if plugged, else the steel annulus."""
    return TabulatedCurve(tuple(D * z for z in QZ_Z), tuple(bearing_pa * area_m2 * share for share in QZ_Q))
