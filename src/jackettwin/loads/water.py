"""Still water about the structure: marine growth, water inside and around members, buoyancy.

Everything is spread along the members by the shape functions of ``morison_points``; the results are added to
an assembly's mass matrix and to its static load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.axes import GRAVITY_M_S2
from jackettwin.loads.coefficients import Coefficients, require_members
from jackettwin.loads.morison import (
    MorisonPoints,
    added_mass,
    morison_points,
    nodal_loads,
    spread,
    wetness,
)
from jackettwin.structure import Assembly


@dataclass(frozen=True)
class Water:
    """Which members are flooded: members or whole parts, filled up to still water."""

    flooded: tuple[str, ...] = ()


def water_mass(
    assembly: Assembly, grid: MorisonPoints, water: Water, *, level_m: float = 0.0
) -> sp.csr_array:
    """Return the mass of growth, of water inside and of added water, (n_dof, n_dof) [kg, kg·m, kg·m²].

    Growth and the water inside move with the member in every direction, added water only across it. With the
    sea ``level_m`` above still water more of the members is wet; ``grid`` must reach there.

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
    assembly: Assembly, coefficients: Coefficients, water: Water, *, step_m: float = 0.5, spacing: float = 1.0
) -> sp.csr_array:
    """Return ∂M/∂level at still water, (n_dof, n_dof) [kg/m, …]: how a tide moves the mass of the water.

    Central differences over ± ``step_m``: a tide's own size, so that braces just under or over the surface
    count in part.
    """
    grid = morison_points(
        assembly, highest_z=step_m, lowest_z=-step_m, coefficients=coefficients, spacing=spacing
    )
    high, low = (water_mass(assembly, grid, water, level_m=sign * step_m) for sign in (1.0, -1.0))
    return sp.csr_array((high - low) / (2.0 * step_m))


def water_weight(assembly: Assembly, grid: MorisonPoints, water: Water) -> FloatArray:
    """Return the static load of weight of growth and water inside, less buoyancy, (n_dof,) [N, N·m]."""
    return nodal_loads(grid, weight_forces(assembly, grid, water))


def weight_forces(assembly: Assembly, grid: MorisonPoints, water: Water) -> FloatArray:
    """Return the weight of growth and water inside less buoyancy at the points, (n, 3) [N].

    Buoyancy is the weight of the water displaced by member and growth, as for closed ends.
    """
    wet = wetness(grid, np.zeros(grid.weight.size))
    rho = grid.density_kg_m3
    inside = _bore_area(grid) * rho * wet * _flooded(assembly, grid, water)
    growth = _growth_area(grid) * grid.growth_density
    displaced = 0.25 * np.pi * grid.diameter**2 * rho * wet
    forces = np.zeros_like(grid.points)
    forces[:, 2] = GRAVITY_M_S2 * (displaced - inside - growth) * grid.weight
    return forces


def _growth_area(grid: MorisonPoints) -> FloatArray:
    return np.asarray(0.25 * np.pi * (grid.diameter**2 - grid.tube_diameter**2))


def _bore_area(grid: MorisonPoints) -> FloatArray:
    return np.asarray(0.25 * np.pi * grid.bore**2)


def _flooded(assembly: Assembly, grid: MorisonPoints, water: Water) -> FloatArray:
    members = assembly.structure.members
    require_members(water.flooded, [(m.name, m.part) for m in members], "flooded")
    named = np.array([member.name in water.flooded or member.part in water.flooded for member in members])
    return named[grid.member].astype(np.float64)
