"""Breaking of a scenario's waves, and slamming loads, which Morison's loads do not include."""

from __future__ import annotations

from math import pi, radians, sin, sqrt
from typing import Any

import numpy as np

from jackettwin.loads import breaking_impact, highest_wave, slam_per_length, wave_number
from jackettwin.simulate.scenario.sea import Sea
from jackettwin.structure import PILES, Member, Structure

_LEVEL = sin(radians(20.0))
_UPRIGHT = sin(radians(70.0))
"""Rise over length up to which a member counts as horizontal, and from which on as upright."""
_LONG_CREST = 0.5
"""Of a breaking wave's height, at least, stands above still water: the crest of a linear wave."""


def breaking_document(sea: Sea, structure: Structure) -> dict[str, Any] | None:
    """Return the height at which waves break, whether these do, and what they slam; None without waves.

    Random waves are judged by their most probable highest of a thousand, with the peak period. Linear waves
    of height H rise past a level z at ω√(H²/4 − z²), given ones at their own speed.
    """
    if sea.waves is None:
        return None
    omega = 2.0 * pi / sea.period_s
    k = float(wave_number(omega, sea.depth_m))
    limit, height = highest_wave(2.0 * pi / k, sea.depth_m), sea.highest_wave_m
    breaks = height > limit
    return {
        "highest_wave_m": height,
        "limit_m": limit,
        "breaks": breaks,
        "slammed": _slammed(sea, structure, omega, min(height, limit)),
        "impact": _impact(sea, structure, omega / k, limit) if breaks else None,
        "source": "Fenton (1990) eq. (32); DNV-RP-C205 section 8; IEC 61400-3-1, Wienke & Oumeraci (2005)",
    }


def _slammed(sea: Sea, structure: Structure, omega: float, height: float) -> list[dict[str, Any]]:
    """Return the horizontal members that the surface passes, the hardest hit first."""
    rows = []
    for member in structure.members:
        rise, levels = _posture(structure, member)
        z = float(np.mean(levels))
        if member.part == PILES or rise > _LEVEL:
            continue
        speed = omega * sqrt(max(0.25 * height**2 - z**2, 0.0)) if sea.elevation is None else _given(sea, z)
        if speed <= 0.0:
            continue
        D = max(member.section_start.outer_diameter_m, member.section_end.outer_diameter_m)
        force = slam_per_length(speed, D, density_kg_m3=sea.coefficients.density_kg_m3)
        rows.append({"member": member.name, "z_msl_m": z, "speed_m_s": speed, "force_n_m": force})
    return sorted(rows, key=lambda row: -float(row["force_n_m"]))


def _given(sea: Sea, z: float) -> float:
    """Return the largest speed of given water that rises past a level, zero if none does [m/s].

    Of given kinematics it is the vertical velocity there as the surface passes, of a given elevation dη/dt.
    """
    assert sea.elevation is not None
    t, eta = sea.elevation.time_s, sea.elevation.eta_m
    before = np.flatnonzero((eta[:-1] < z) & (eta[1:] >= z))
    if not before.size:
        return 0.0
    steps, risen = t[before + 1] - t[before], eta[before + 1] - eta[before]
    if sea.kinematics is None:
        return float((risen / steps).max())
    at = (z - eta[before]) / risen
    up = np.array([np.interp(z, sea.kinematics.z_m, row) for row in sea.kinematics.velocity[..., 1]])
    return max(float((up[before] + at * (up[before + 1] - up[before])).max()), 0.0)


def _impact(sea: Sea, structure: Structure, celerity: float, limit: float) -> dict[str, Any] | None:
    """Return what a wave that just breaks does to the widest upright member at the surface."""
    upright = [
        (max(m.section_start.outer_diameter_m, m.section_end.outer_diameter_m), m.name)
        for m in structure.members
        for rise, levels in (_posture(structure, m),)
        if m.part != PILES and rise >= _UPRIGHT and min(levels) < 0.5 * limit and max(levels) > 0.0
    ]
    if not upright:
        return None
    D, name = max(upright)
    crest = _LONG_CREST * limit
    force = breaking_impact(crest, celerity, D, density_kg_m3=sea.coefficients.density_kg_m3)
    return {"member": name, "crest_m": crest, "celerity_m_s": celerity, "force_n": force}


def _posture(structure: Structure, member: Member) -> tuple[float, tuple[float, float]]:
    """Return rise over length of a member, and the levels of its ends over still water [m]."""
    a, b = (np.array(structure.nodes[name]) for name in (member.start, member.end))
    levels = (float(a[2]) - structure.sea_level_z_m, float(b[2]) - structure.sea_level_z_m)
    return abs(float(b[2] - a[2])) / float(np.linalg.norm(b - a)), levels
