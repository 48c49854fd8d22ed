"""Effects of still water: marine growth, water inside and around members, buoyancy.

They are distributed along the members with the shape functions of ``morison_points``; the results are added
to an assembly's mass matrix and static load.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.loads.members.coefficients import Coefficients, require_members
from jackettwin.loads.members.morison import (
    MorisonPoints,
    added_mass,
    loads_along,
    morison_points,
    nodal_loads,
    spread,
    wetness,
)
from jackettwin.structure import Assembly

_AT_THE_BED_M = 0.05
"""A foot at most this far below the bed counts as in the water, as depths are given to the decimetre."""


@dataclass(frozen=True)
class Water:
    """Names of flooded members, or of parts whose members are flooded, filled up to still water."""

    flooded: tuple[str, ...] = ()


def water_mass(
    assembly: Assembly, grid: MorisonPoints, water: Water, *, level_m: float = 0.0
) -> sp.csr_array:
    """Return the mass of growth, of water inside and added mass, (n_dof, n_dof) [kg, kg·m, kg·m²].

    Growth and the water inside move with the member in all directions, added mass acts only normal to it. The
    sea surface is ``level_m`` above still water; ``grid`` must extend to it.

    Raises
    ------
    InputError
        If a flooded member or part does not exist.
    """
    wet = wetness(grid, np.full(grid.weight.size, level_m))
    carried = _growth_area(grid) * grid.growth_density
    carried = carried + _bore_area(grid) * grid.density_kg_m3 * wet * _flooded(assembly, grid, water)
    return sp.csr_array(spread(grid, carried[:, None, None] * np.eye(3)) + added_mass(grid, eta=level_m))


def mass_per_level(
    assembly: Assembly, coefficients: Coefficients, water: Water, *, step_m: float = 0.5
) -> sp.csr_array:
    """Return ∂M/∂level at still water, (n_dof, n_dof) [kg/m, …]: the effect of the tide on the mass of water.

    It is computed by central differences over ± ``step_m``, the range of a tide, so that braces just below or
    above the surface are included in part.
    """
    grid = morison_points(assembly, highest_z=step_m, lowest_z=-step_m, coefficients=coefficients)
    high, low = (water_mass(assembly, grid, water, level_m=sign * step_m) for sign in (1.0, -1.0))
    return sp.csr_array((high - low) / (2.0 * step_m))


class StillWater(NamedTuple):
    """Weight of growth and water inside minus buoyancy: on the DOFs (n_dof,) and on the elements (n, 12)."""

    load: FloatArray
    along: FloatArray


def still_water(assembly: Assembly, grid: MorisonPoints, water: Water) -> StillWater:
    """Return the loads of still water on an asset's weight."""
    forces = weight_forces(assembly, grid, water)
    along = (loads_along(assembly, grid) @ forces.ravel()).reshape(-1, 12)
    return StillWater(nodal_loads(grid, forces), np.asarray(along))


class WaterWeights(NamedTuple):
    """Weights at the points of a grid, (n,) each [N]: water displaced, water inside, growth in air."""

    displaced: FloatArray
    inside: FloatArray
    growth: FloatArray


def water_weights(assembly: Assembly, grid: MorisonPoints, water: Water) -> WaterWeights:
    """Return the weights of still water; members with growth displace water as if their ends were closed."""
    wet = wetness(grid, np.zeros(grid.weight.size))
    rho = grid.density_kg_m3
    areas = (
        0.25 * np.pi * grid.diameter**2 * rho * wet,
        _bore_area(grid) * rho * wet * _flooded(assembly, grid, water),
        _growth_area(grid) * grid.growth_density,
    )
    return WaterWeights(*(GRAVITY_M_S2 * area * grid.weight for area in areas))


def weight_forces(assembly: Assembly, grid: MorisonPoints, water: Water) -> FloatArray:
    """Return the weight of growth and water inside minus buoyancy at the points, (n, 3) [N]."""
    weights = water_weights(assembly, grid, water)
    forces = np.zeros_like(grid.points)
    forces[:, 2] = weights.displaced - weights.inside - weights.growth
    return forces


def outside_pressure(
    assembly: Assembly,
    water: Water,
    *,
    density_kg_m3: float,
    depth_m: float,
    wave_height_m: float = 0.0,
    wavenumber: float = 0.0,
) -> FloatArray:
    r"""Return the hydrostatic overpressure outside at the ends of elements, (n_elements, 2) [Pa].

    .. math:: p = ρ g H_z, \qquad H_z = -z + \frac{H_w}{2} \frac{\cosh k(d + z)}{\cosh kd}

    ISO 19902 (13.2-20, 13.2-21). It is zero for flooded members and in the ground.
    """
    mesh = assembly.mesh
    z = mesh.coordinates[np.stack([mesh.start, mesh.end], axis=1), 2] - assembly.structure.sea_level_z_m
    wet = np.clip(depth_m + z, 0.0, depth_m)
    # cosh k(d + z)/cosh kd without overflow
    decay = np.exp(wavenumber * (wet - depth_m))
    ratio = decay * (1.0 + np.exp(-2.0 * wavenumber * wet)) / (1.0 + np.exp(-2.0 * wavenumber * depth_m))
    head = np.maximum(0.5 * wave_height_m * ratio - z, 0.0)
    head[z < -depth_m - _AT_THE_BED_M] = 0.0
    dry = 1.0 - _is_flooded(assembly, water)[mesh.member]
    return np.asarray(density_kg_m3 * GRAVITY_M_S2 * head * dry[:, None])


def _growth_area(grid: MorisonPoints) -> FloatArray:
    return np.asarray(0.25 * np.pi * (grid.diameter**2 - grid.tube_diameter**2))


def _bore_area(grid: MorisonPoints) -> FloatArray:
    return np.asarray(0.25 * np.pi * grid.bore**2)


def _flooded(assembly: Assembly, grid: MorisonPoints, water: Water) -> FloatArray:
    return _is_flooded(assembly, water)[grid.member]


def _is_flooded(assembly: Assembly, water: Water) -> FloatArray:
    """Return 1 for flooded members and 0 for others, (n_members,)."""
    members = assembly.structure.members
    require_members(water.flooded, [(m.name, m.part) for m in members], "flooded")
    named = np.array([member.name in water.flooded or member.part in water.flooded for member in members])
    return named.astype(np.float64)
