"""Passage of a regular wave: loads on the members and the quasi-static displacements they cause."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.loads import (
    Coefficients,
    MorisonPoints,
    airy_wave,
    morison_points,
    nodal_loads,
    point_forces,
    wetness,
)
from jackettwin.response.state import factorised
from jackettwin.response.system import System


@dataclass(frozen=True)
class Passage:
    """One period of a wave.

    Attributes
    ----------
    height_m, period_s, length_m, direction_rad : height, period, length and direction of the wave
    displacement : (n_phases, assembly.n_dof) quasi-static displacements [m, rad]
    load_n_m : (n_phases, n_elements) force per length on each element [N/m]
    """

    height_m: float
    period_s: float
    length_m: float
    direction_rad: float
    displacement: FloatArray
    load_n_m: FloatArray


def wave_passage(
    system: System,
    *,
    height_m: float,
    period_s: float,
    direction_rad: float = 0.0,
    coefficients: Coefficients | None = None,
    n_phases: int = 24,
) -> Passage:
    """Return the passage of a linear wave, from one crest at the origin to the next.

    Raises
    ------
    InputError
        If the structure stands on dry ground, or the wave breaks.
    """
    assembly = system.assembly
    sea = assembly.structure.sea_level_z_m
    depth = sea - float(assembly.mesh.coordinates[:, 2].min())
    wave = airy_wave(height=height_m, period=period_s, depth=depth, direction=direction_rad)
    grid = morison_points(assembly, highest_z=height_m, coefficients=coefficients)
    t = np.arange(n_phases) * period_s / n_phases
    u, du = wave.motion(grid.points, t)
    forces = point_forces(grid, u, du, wet=wetness(grid, np.zeros(grid.weight.size)))
    lu = factorised(sp.csc_array(system.pencil.static_stiffness()))
    rest = np.array([system.expand(lu.solve(f[system.free])) for f in nodal_loads(grid, forces)])
    length = 2.0 * np.pi / float(wave.k[0])
    return Passage(
        height_m, period_s, length, direction_rad, rest, _per_length(assembly.mesh.member, grid, forces)
    )


def _per_length(member: IntArray, grid: MorisonPoints, forces: FloatArray) -> FloatArray:
    """Return the mean force per length of each element's member, zero where it is dry."""
    size = int(member.max()) + 1
    length = np.bincount(grid.member, grid.weight, minlength=size)
    total = np.array([np.bincount(grid.member, np.linalg.norm(f, axis=-1), minlength=size) for f in forces])
    return np.asarray((total / np.where(length > 0.0, length, np.inf))[:, member])
