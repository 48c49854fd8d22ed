"""Utilisation of members in a scenario."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.checks import DesignBasis, FrameUse, frame_use
from jackettwin.loads import loads_along, outside_pressure, still_water, wave_number
from jackettwin.response import build_system, self_weight, static_displacement
from jackettwin.simulate.motion.motion import Motion, simulate_motion
from jackettwin.simulate.motion.water import water_loads, water_points
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.structure import Assembly, assemble, element_weight

_BLOCK = 2000
"""Number of instants per block: records are long, and every element has twelve loads."""
_SPACING_M = 2.0
"""Longest piece of a member, as its own loads matter here."""


def scenario_uses(scenario: Scenario, basis: DesignBasis | None = None) -> FrameUse:
    """Return the worst use of every member and joint over a scenario, weight in air and water included.

    Joints move with the modes up to the simulation's band; between them members also bend under their weight
    and the waves along them. The inertia of members between joints is neglected.

    Raises
    ------
    InputError
        If parts of the scenario do not fit each other, it cannot stand, or the motion grows
        without bound.
    """
    motion = simulate_motion(scenario)
    assembly = motion.model.assembly
    pressure = pressure_outside(scenario, assembly)
    worst = FrameUse()
    for u, along in deflections(scenario, motion):
        worst = worst.worse(frame_use(assembly, u, basis, along=along, pressure=pressure))
    return worst


def deflections(
    scenario: Scenario, motion: Motion, *, permanent: float = 1.0, environmental: float = 1.0
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield a scenario in blocks of instants, without what is discarded.

    Each block is displacements (n, n_dof), weight included, and loads along the elements, (n_elements, 12) or
    one for every instant. ``permanent`` multiplies weight and buoyancy, ``environmental`` all that moves.
    """
    assembly, modes = motion.model.assembly, motion.model.reduced.basis.T
    q = motion.states[:, : motion.space.n]
    t = np.arange(len(q), dtype=np.float64) * motion.step_s
    rest = at_rest(scenario, motion)
    waves = _waves_along(scenario, assembly)
    for first in range(round(scenario.clock.discard_s / motion.step_s), len(q), _BLOCK):
        here = slice(first, first + _BLOCK)
        along = permanent * rest.along
        if waves is not None:
            along = along + environmental * waves(t[here])
        yield permanent * rest.displacement + environmental * (q[here] @ modes), along


def pressure_outside(scenario: Scenario, assembly: Assembly) -> FloatArray | None:
    """Return the water pressure on the elements' ends, (n_elements, 2) [Pa]; None if unknown inside."""
    sea = scenario.sea
    if sea is None or sea.water is None:
        return None
    k = float(wave_number(2.0 * pi / sea.period_s, sea.depth_m)) if sea.period_s > 0.0 else 0.0
    return outside_pressure(
        assembly,
        sea.water,
        density_kg_m3=sea.coefficients.density_kg_m3,
        depth_m=sea.depth_m,
        wave_height_m=sea.highest_wave_m,
        wavenumber=k,
    )


def water_notes(scenario: Scenario) -> list[str]:
    """Return notes on effects of still water that a check of the scenario omits."""
    if scenario.sea is None or scenario.sea.water is not None:
        return []
    return [
        "buoyancy and hydrostatic pressure are left out: the structure's density holds its water already; "
        "give water: {adds_mass: true} with the density of bare steel"
    ]


class Rest(NamedTuple):
    """Displacements (n_dof,) at rest, and the loads along the elements (n_elements, 12) that make them."""

    displacement: FloatArray
    along: FloatArray


def at_rest(scenario: Scenario, motion: Motion) -> Rest:
    """Return the asset under the weight in air, and under that of water and growth less buoyancy."""
    asset, sea = scenario.asset, scenario.sea
    assembly = motion.model.assembly
    load, along = self_weight(_dry(scenario, assembly)), element_weight(assembly)
    if sea is not None and sea.water is not None:
        grid = water_points(assembly, sea, spacing=_SPACING_M)
        wet = still_water(assembly, grid, sea.water)
        load, along = load + wet.load, along + wet.along
    return Rest(static_displacement(build_system(assembly, asset.support), load), along)


def _waves_along(scenario: Scenario, assembly: Assembly) -> Callable[[FloatArray], FloatArray] | None:
    """Return what gives the loads of waves and current along the elements, (n_times, n_elements, 12)."""
    sea = scenario.sea
    if sea is None or (sea.waves is None and sea.current is None):
        return None
    grid = water_points(assembly, sea, spacing=_SPACING_M)
    to_elements = loads_along(assembly, grid)
    wet = np.unique(grid.element)
    rows = (12 * wet[:, None] + np.arange(12)).ravel()
    loads = water_loads(sea, grid, to_elements[rows].toarray().T, duration=scenario.clock.total_s)
    assert loads is not None

    def along(t: FloatArray) -> FloatArray:
        spread = np.zeros((t.size, assembly.mesh.start.size, 12))
        spread[:, wet] = loads.at(t).reshape(t.size, wet.size, 12)
        return spread

    return along


def _dry(scenario: Scenario, assembly: Assembly) -> Assembly:
    """Return the assembly without the added mass of water, which has no weight."""
    asset = scenario.asset
    return assemble(
        assembly.structure,
        beam_theory=asset.beam,
        rotary_inertia=asset.rotary_inertia,
        subdivide=asset.subdivide,
    )
