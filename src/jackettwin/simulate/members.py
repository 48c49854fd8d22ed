"""Utilisation of members in a scenario."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.checks import DesignBasis, FrameUse, frame_use
from jackettwin.loads import loads_along, outside_pressure, still_water, wave_number
from jackettwin.response import beyond_basis, build_system, self_weight, static_displacement
from jackettwin.simulate.motion.motion import Motion, simulate_motion
from jackettwin.simulate.motion.water import WaterLoads, water_loads, water_points
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
    What the model's coordinates do not follow of the waves bends members as if it were at rest.
    """
    assembly, basis = motion.model.assembly, motion.model.reduced.basis
    q = motion.states[:, : motion.space.n]
    t = np.arange(len(q), dtype=np.float64) * motion.step_s
    rest = at_rest(scenario, motion)
    waves = waves_along(scenario, assembly)
    if waves is not None:
        beyond = beyond_basis(build_system(assembly, scenario.asset.support), basis, waves.on_dofs)
    for first in range(round(scenario.clock.discard_s / motion.step_s), len(q), _BLOCK):
        here = slice(first, first + _BLOCK)
        u = permanent * rest.displacement + environmental * (q[here] @ basis.T)
        along = permanent * rest.along
        if waves is not None:
            loads = environmental * waves.at(t[here])
            u, along = u + loads @ beyond.T, along + waves.spread(loads)
        yield u, along


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
    assembly = motion.model.assembly
    load, along = weight(scenario, assembly)
    return Rest(static_displacement(build_system(assembly, scenario.asset.support), load), along)


def weight(scenario: Scenario, assembly: Assembly) -> tuple[FloatArray, FloatArray]:
    """Return weight in air, of water and growth less buoyancy: (n_dof,), and along (n_elements, 12)."""
    sea = scenario.sea
    load, along = self_weight(_dry(scenario, assembly)), element_weight(assembly)
    if sea is not None and sea.water is not None:
        grid = water_points(assembly, sea, spacing=_SPACING_M)
        wet = still_water(assembly, grid, sea.water)
        load, along = load + wet.load, along + wet.along
    return load, along


@dataclass(frozen=True)
class WavesAlong:
    """Loads of waves and current along the elements that they reach, twelve of each in local axes.

    Attributes
    ----------
    wet : (n_wet,) numbers of these elements
    on_dofs : (assembly.n_dof, 12 n_wet) their loads on the assembly's DOFs
    """

    loads: WaterLoads
    wet: IntArray
    on_dofs: FloatArray
    n_elements: int

    def at(self, t: FloatArray) -> FloatArray:
        """Return the loads (n_times, 12 n_wet) at times [s]."""
        return self.loads.at(t)

    def spread(self, loads: FloatArray) -> FloatArray:
        """Return loads (n_times, 12 n_wet) as those of all elements, (n_times, n_elements, 12)."""
        found = np.zeros((len(loads), self.n_elements, 12))
        found[:, self.wet] = loads.reshape(len(loads), self.wet.size, 12)
        return found


def waves_along(scenario: Scenario, assembly: Assembly) -> WavesAlong | None:
    """Return the loads of a scenario's waves and current along the elements; None in still water."""
    sea = scenario.sea
    if sea is None or (sea.waves is None and sea.current is None):
        return None
    grid, mesh = water_points(assembly, sea, spacing=_SPACING_M), assembly.mesh
    to_elements = loads_along(assembly, grid)
    wet = np.unique(grid.element)
    rows = (12 * wet[:, None] + np.arange(12)).ravel()
    loads = water_loads(sea, grid, to_elements[rows].toarray().T, duration=scenario.clock.total_s)
    assert loads is not None
    turned = sp.block_diag([mesh.axes[e].T for e in np.repeat(wet, 4)], format="csr")
    ends = mesh.element_dofs()[wet].ravel()
    to_nodes = sp.csr_array(
        (np.ones(ends.size), (ends, np.arange(ends.size))), (assembly.expand.shape[0], ends.size)
    )
    on_dofs = (assembly.expand.T @ to_nodes @ turned).toarray()
    return WavesAlong(loads, wet, on_dofs, mesh.start.size)


def _dry(scenario: Scenario, assembly: Assembly) -> Assembly:
    """Return the assembly without the added mass of water, which has no weight."""
    asset = scenario.asset
    return assemble(
        assembly.structure,
        beam_theory=asset.beam,
        rotary_inertia=asset.rotary_inertia,
        subdivide=asset.subdivide,
    )
