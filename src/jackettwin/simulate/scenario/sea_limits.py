"""What Morison's equation and linear waves do not hold for, said of a scenario's sea."""

from __future__ import annotations

import numpy as np

from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.sea.regular_waves import highest_wave
from jackettwin.loads.sea.waves import wave_number
from jackettwin.simulate.scenario.scenario import Sea
from jackettwin.structure import Structure

WIDEST = 0.2
"""Diameter over wave length up to which a member does not disturb the wave: DNV-RP-C205, ISO 19901-1."""


def sea_warnings(sea: Sea, structure: Structure) -> list[str]:
    """Return warnings; a random sea is judged by the wave of its peak period."""
    if sea.waves is None:
        return []
    length = 2.0 * np.pi / float(wave_number(2.0 * np.pi / sea.period_s, sea.depth_m))
    found = []
    name, diameter = _widest(structure, sea.coefficients, sea.depth_m)
    if diameter > WIDEST * length and not sea.diffraction:
        found.append(
            f"member {name} is {diameter:.1f} m wide, over {WIDEST:g} of the wave length {length:.0f} m: "
            "it scatters waves, and Morison's equation overstates their force (waves.diffraction)"
        )
    highest = highest_wave(length, sea.depth_m)
    if sea.waves == "airy" and sea.height_m > highest:
        found.append(
            f"waves of {sea.period_s:g} s break at {highest:.1f} m in {sea.depth_m:g} m of water; "
            f"linear theory says nothing of {sea.height_m:g} m"
        )
    return found


def _widest(structure: Structure, coefficients: Coefficients, depth_m: float) -> tuple[str, float]:
    """Return name and hydrodynamic diameter [m] of the widest member in the water, at its ends."""
    widest = ("", 0.0)
    for member in structure.members:
        if member.part == "piles":
            continue
        ends = np.array([structure.nodes[node][2] for node in (member.start, member.end)])
        z = ends - structure.sea_level_z_m
        if z.min() >= 0.0 or z.max() <= -depth_m:
            continue
        tube = [s.outer_diameter_m for s in (member.section_start, member.section_end)]
        diameter = float((tube + 2.0 * coefficients.thickness(z)).max())
        widest = max(widest, (member.name, diameter), key=lambda one: one[1])
    return widest
