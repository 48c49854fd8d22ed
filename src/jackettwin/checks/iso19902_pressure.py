r"""Strength of tubular members under hydrostatic pressure to ISO 19902, clauses 13.2.6 and 13.4 (2007).

Symbols and equation numbers are the standard's. Axial stresses are those of an analysis without capped-end
actions: buoyancy spread along the members (``loads/members/water.py``) makes an axial force that knows
nothing of the pressure on the ends, so σ_q = ½σ_h is taken off here (13.4-1 to 13.4-4).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.checks.iso19902 import C_X, GAMMA_B, GAMMA_C, GAMMA_T, STEEPEST, Strength, Stress, Tube

GAMMA_H = 1.25
"""Partial resistance factor for hoop buckling, 13.2.6.2."""

PRESSURE_CHECKS = {
    "hoop": "hoop buckling under hydrostatic pressure, ISO 19902 13.2.6",
    "pressure_section": "section under axial force, bending and pressure, ISO 19902 (13.4-12), (13.4-19)",
    "pressure_stability": "column under compression, bending and pressure, ISO 19902 (13.4-20)",
    "pressure_local": "local buckling under compression, bending and pressure, ISO 19902 (13.4-21)",
}


class HoopStrength(NamedTuple):
    """Elastic critical and representative hoop buckling strength [Pa]."""

    f_he: FloatArray
    f_h: FloatArray


class PressureUse(NamedTuple):
    """U_m of each check; at most 1. Names and clauses are in ``PRESSURE_CHECKS``."""

    hoop: FloatArray
    section: FloatArray
    stability: FloatArray
    local: FloatArray


class PressureTerms(NamedTuple):
    """What pressure does to a section: σ_h and σ_q [Pa], B, η, and the factor r on f_y and f_b."""

    hoop_stress: FloatArray
    capped: FloatArray
    B: FloatArray
    eta: FloatArray
    left: FloatArray


def pressure_terms(tube: Tube, h: HoopStrength, pressure: FloatArray) -> PressureTerms:
    """Return the terms of :func:`pressure_use` that depend on the pressure [Pa] alone."""
    hoop_stress = 0.5 * pressure * tube.D / tube.t
    B, eta = np.minimum(GAMMA_H * hoop_stress / h.f_h, 1.0), 5.0 - 4.0 * h.f_h / tube.f_y
    left = np.sqrt(np.maximum(1.0 + 0.09 * B**2 - B ** (2.0 * eta), 0.0)) - 0.3 * B
    # at B = 1 nothing is left, and the hoop check says so already
    return PressureTerms(hoop_stress, 0.5 * hoop_stress, B, eta, np.maximum(left, 1e-3))


def hoop_strength(tube: Tube, ring_spacing: FloatArray) -> HoopStrength:
    r"""Return the hoop buckling strengths of tubes.

    ``ring_spacing`` is L_r [m], without rings the length between joints.

    .. math::

        f_{he} = 2 C_h E t/D \;(13.2\text{-}26), \quad μ = \frac{L_r}{D}\sqrt{2D/t}, \quad C_h =
        0.44\frac{t}{D},\; 0.44\frac{t}{D} + 0.21\frac{(D/t)^3}{μ^4},\; \frac{0.737}{μ - 0.579},\; 0.80
        \text{ down to } μ = 1.6\frac{D}{t},\; 0.825\frac{D}{t},\; 1.5,\; 0 \;(13.2\text{-}27\ldots30)

        f_h = f_y,\; 0.7 f_y (f_{he}/f_y)^{0.4},\; f_{he} \text{ down to } f_{he}/f_y = 2.44,\; 0.55,\; 0
        \;(13.2\text{-}23\ldots25)

    """
    D, t, E, f_y, _ = tube
    slender = D / t
    mu = ring_spacing / D * np.sqrt(2.0 * slender)
    C_h = np.select(
        [mu >= 1.6 * slender, mu >= 0.825 * slender, mu >= 1.5],
        [
            0.44 / slender,
            0.44 / slender + 0.21 * slender**3 / np.maximum(mu, 0.1) ** 4,
            0.737 / (np.maximum(mu, 1.5) - 0.579),
        ],
        0.80,
    )
    f_he = 2.0 * C_h * E / slender
    ratio = f_he / f_y
    f_h = f_y * np.select([ratio > 2.44, ratio > 0.55], [1.0, np.minimum(0.7 * ratio**0.4, 1.0)], ratio)
    return HoopStrength(f_he, f_h)


def pressure_use(
    tube: Tube,
    s: Strength,
    h: HoopStrength,
    stress: Stress,
    pressure: FloatArray,
    *,
    C_m: float = 1.0,
) -> PressureUse:
    r"""Return U_m of every check under ``pressure`` [Pa] from outside; zero where there is none.

    .. math::

        σ_h = \frac{pD}{2t}, \quad B = \min(1, γ_h σ_h/f_h) \;(13.4\text{-}10), \quad η = 5 - 4 f_h/f_y
        \;(13.4\text{-}11), \quad r = \sqrt{1 + 0.09B^2 - B^{2η}} - 0.3B

        f_{t,h} = f_y r \;(13.4\text{-}8), \quad f_{b,h} = f_b r \;(13.4\text{-}9)

        \frac{γ_t σ_{t,c}}{f_{t,h}} + \frac{γ_b σ_b}{f_{b,h}} \;(13.4\text{-}12), \quad
        \frac{γ_c σ_{c,c}}{f_{yc}} + \frac{γ_b σ_b}{f_{b,h}} \;(13.4\text{-}19), \quad
        \frac{γ_c σ_c}{f_{c,h}} + \frac{γ_b}{f_{b,h}} \frac{C_m σ_b}{1 - σ_c/f_e} \;(13.4\text{-}20)

        \frac{σ_x - 0.5 f_{he}/γ_h}{f_{xe}/γ_c - 0.5 f_{he}/γ_h} + \left(\frac{γ_h σ_h}{f_{he}}\right)^2,
        \; σ_x = σ_b + σ_{c,c} \;(13.4\text{-}21)

    with the stresses :math:`σ_{t,c} = σ_t - σ_q` or :math:`σ_{c,c} = σ_c + σ_q`, σ_q = ½σ_h.
    """
    hoop_stress, capped, _, _, left = pressure_terms(tube, h, pressure)
    hoop = GAMMA_H * hoop_stress / h.f_h
    bending = np.hypot(stress.bending_y, stress.bending_z)
    bent = GAMMA_B * bending / (s.f_b * left)
    tension, compression = np.maximum(stress.axial - capped, 0.0), np.maximum(capped - stress.axial, 0.0)
    section = GAMMA_T * tension / (tube.f_y * left) + GAMMA_C * compression / s.f_yc + bent
    outer = np.maximum(-stress.axial, 0.0)
    column = GAMMA_C * outer / column_strength(tube, s, capped)
    column = column + C_m * bent / (1.0 - np.minimum(outer / s.f_e, STEEPEST))
    under = pressure > 0.0
    return PressureUse(
        np.where(under, hoop, 0.0),
        np.where(under, section, 0.0),
        np.where(under & (outer > 0.0), column, 0.0),
        np.where(under, _local(tube, h, bending + compression, hoop_stress), 0.0),
    )


def column_strength(tube: Tube, s: Strength, capped: FloatArray) -> FloatArray:
    r"""Return f_c,h, the column's strength beside a capped-end stress σ_q [Pa].

    .. math::

        \frac{f_{c,h}}{f_{yc}} = \tfrac12\left(a - 2q + \sqrt{a^2 + 1.12 λ^2 q}\right), \quad
        a = 1 - 0.278λ^2, \; q = σ_q/f_{yc} \;(13.4\text{-}15); \qquad
        \frac{0.9}{λ^2} \text{ from } λ = 1.34/\sqrt{1 - 2q} \;(13.4\text{-}16)

    """
    d = tube.D - 2.0 * tube.t
    lam = tube.KL / (np.pi * 0.25 * np.sqrt(tube.D**2 + d**2)) * np.sqrt(s.f_yc / tube.E)
    q = np.minimum(capped / s.f_yc, 0.49)
    a = 1.0 - 0.278 * lam**2
    stocky = 0.5 * (a - 2.0 * q + np.sqrt(a**2 + 1.12 * lam**2 * q))
    slender = 0.9 / np.maximum(lam, 1e-9) ** 2
    return np.asarray(s.f_yc * np.where(lam < 1.34 / np.sqrt(1.0 - 2.0 * q), stocky, slender))


def _local(tube: Tube, h: HoopStrength, along: FloatArray, hoop_stress: FloatArray) -> FloatArray:
    """Return U_m of (13.4-21); zero where the compression is too small for it to matter."""
    f_xe = 2.0 * C_X * tube.E * tube.t / tube.D
    half = 0.5 * h.f_he / GAMMA_H
    room = f_xe / GAMMA_C - half
    used = (along - half) / np.where(room > 0.0, room, 1.0) + (GAMMA_H * hoop_stress / h.f_he) ** 2
    return np.where((along > half) & (room > 0.0), used, 0.0)
