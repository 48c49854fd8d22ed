r"""Morison's equation on every member: thesis (5.1), with relative velocity (2.2).

Per unit length, everything normal to the member (subscript n):

.. math:: f = ½ρ C_D D |v_n| v_n + ρ C_M \tfrac{π}{4}D^2 \dot u_n − ρ (C_M − 1) \tfrac{π}{4}D^2 \ddot x_n,
          \qquad v = u − \dot x

Loads are integrated at Gauss points by the elements' own shape functions, so that forces, motions of the
members, added mass and linear drag damping all go through one sparse matrix N.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from jackettwin.errors import InputError
from jackettwin.loads.current import Current
from jackettwin.loads.kernels import morison
from jackettwin.loads.waves import Waves
from jackettwin.structure import Assembly, beam

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]

SEA_WATER_KG_M3 = 1025.0


@dataclass(frozen=True)
class Coefficients:
    """Drag and inertia coefficients, marine growth and water density.

    ``growth`` holds (top z, bottom z, thickness) [m] bands, z up from still water; growth adds to the
    hydrodynamic diameter.
    """

    drag: float = 1.0
    inertia: float = 2.0
    growth: tuple[tuple[float, float, float], ...] = ()
    density_kg_m3: float = SEA_WATER_KG_M3

    def __post_init__(self) -> None:
        for field in ("drag", "inertia", "density_kg_m3"):
            value = getattr(self, field)
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError("out of range", field=field, value=value, allowed="≥ 0")

    def thickness(self, z: FloatArray) -> FloatArray:
        """Return the growth's thickness [m] at ``z``."""
        t = np.zeros_like(z)
        for top, bottom, thick in self.growth:
            t = np.where((z <= top) & (z >= bottom), thick, t)
        return t


@dataclass(frozen=True)
class MorisonPoints:
    """Gauss points along the members that can be wet.

    Attributes
    ----------
    points : (n, 3) z up from still water [m]
    weight : (n,) member length each stands for [m]
    half_height : (n,) half the vertical extent of that length [m]: how sharply it gets wet
    diameter : (n,) hydrodynamic, growth included [m]
    tube_diameter, bore : (n,) outer and inner diameter of the steel [m]
    member : (n,) index into the structure's members
    normal : (n, 3, 3) projector onto the plane normal to the member
    N : (assembly.n_dof, 3n) sparse; nodal loads from point forces, and its transpose point motion from DOFs
    """

    points: FloatArray
    weight: FloatArray
    half_height: FloatArray
    diameter: FloatArray
    tube_diameter: FloatArray
    bore: FloatArray
    member: IntArray
    normal: FloatArray
    N: sp.csr_array
    coefficients: Coefficients

    def motion(self, x: FloatArray) -> FloatArray:
        """Return the motion of the points (..., n, 3) from that of the DOFs (..., n_dof)."""
        moved = (self.N.T @ np.atleast_2d(x).T).T
        return np.asarray(moved).reshape(*x.shape[:-1], -1, 3)


def morison_points(
    assembly: Assembly,
    *,
    highest_z: float = np.inf,
    lowest_z: float = -np.inf,
    coefficients: Coefficients | None = None,
    spacing: float = 1.0,
    exclude_parts: tuple[str, ...] = ("piles",),
) -> MorisonPoints:
    """Return the Gauss points of the members that reach below ``highest_z`` and above ``lowest_z``.

    Heights [m] from still water.

    Each element is cut into pieces no longer than ``spacing`` [m], each with two Gauss points.
    """
    coefficients = Coefficients() if coefficients is None else coefficients
    mesh, structure = assembly.mesh, assembly.structure
    ends = mesh.coordinates - [0.0, 0.0, structure.sea_level_z_m]
    z0, z1 = ends[mesh.start, 2], ends[mesh.end, 2]
    reaches = (np.minimum(z0, z1) <= highest_z) & (np.maximum(z0, z1) >= lowest_z)
    wanted = [
        e for e in np.flatnonzero(reaches) if structure.members[mesh.member[e]].part not in exclude_parts
    ]
    if not wanted:
        raise InputError(
            "no member reaches into the water or the heights asked for",
            field="sea_level_z_m",
            value=structure.sea_level_z_m,
        )
    xi, weight = zip(*(_gauss(float(mesh.properties.L[e]), spacing) for e in wanted), strict=True)
    element = np.repeat(wanted, [x.size for x in xi])
    at, length = np.concatenate(xi), np.concatenate(weight)
    start, end = ends[mesh.start[element]], ends[mesh.end[element]]
    points = start + at[:, None] * (end - start)
    outer, bore = _diameters(mesh.properties)
    axis = mesh.axes[element, 0]
    return MorisonPoints(
        points=points,
        weight=length,
        half_height=0.5 * length * np.abs(axis[:, 2]),
        diameter=outer[element] + 2.0 * coefficients.thickness(points[:, 2]),
        tube_diameter=outer[element],
        bore=bore[element],
        member=mesh.member[element],
        normal=np.eye(3) - axis[:, :, None] * axis[:, None, :],
        N=_distribution(assembly, element, at),
        coefficients=coefficients,
    )


def _diameters(p: beam.BeamProperties) -> tuple[FloatArray, FloatArray]:
    """Return outer and inner diameter from A = π(R² − r²) and 4I/A = R² + r²."""
    difference, total = p.A / np.pi, 4.0 * p.I / p.A
    return np.sqrt(2.0 * (total + difference)), np.sqrt(2.0 * np.maximum(total - difference, 0.0))


def _distribution(assembly: Assembly, element: IntArray, xi: FloatArray) -> sp.csr_array:
    """Return N: forces at ``xi`` along elements to loads on the assembly's DOFs."""
    mesh = assembly.mesh
    dofs = mesh.element_dofs()[element]
    L, R = mesh.properties.L[element], mesh.axes[element]
    local = np.array(
        [beam.translation_shape(float(x), float(length)) for x, length in zip(xi, L, strict=True)]
    )
    ends = np.stack([local[:, :, 3 * k : 3 * k + 3] @ R for k in range(4)], axis=2)
    shapes = np.einsum("nji,njkl->nikl", R, ends).reshape(-1, 12)
    rows, columns = np.repeat(dofs, 3, axis=0), np.broadcast_to(np.arange(3 * xi.size)[:, None], shapes.shape)
    full = sp.coo_array((shapes.ravel(), (rows.ravel(), columns.ravel())), shape=(mesh.n_dof, 3 * xi.size))
    return sp.csr_array(assembly.expand.T @ full.tocsr())


def _gauss(L: float, spacing: float) -> tuple[FloatArray, FloatArray]:
    """Return places x/L and lengths [m] of two Gauss points a piece."""
    n = int(np.ceil(L / spacing))
    x, _ = np.polynomial.legendre.leggauss(2)
    xi = ((np.arange(n)[:, None] + 0.5 + 0.5 * x) / n).ravel()
    return xi, np.full(xi.size, 0.5 * L / n)


def wetness(grid: MorisonPoints, eta: FloatArray) -> FloatArray:
    """Return the wet share (0 to 1) of each point's length under surface ``eta`` (..., n) [m]."""
    depth = eta - grid.points[:, 2]
    half = np.maximum(grid.half_height, 1e-9)
    return np.asarray(np.clip(0.5 + 0.5 * depth / half, 0.0, 1.0))


def point_forces(
    grid: MorisonPoints,
    u: FloatArray,
    du: FloatArray,
    *,
    velocity: FloatArray | None = None,
    wet: FloatArray | float = 1.0,
) -> FloatArray:
    """Return Morison forces at the points (..., n, 3) [N].

    Parameters
    ----------
    u, du : (..., n, 3) water velocity [m/s] and acceleration [m/s²]
    velocity : (..., n, 3), optional
        Velocity of the member itself: relative drag, thesis (2.2). The force on its acceleration is the
        added mass, which belongs to the mass matrix (``added_mass``).
    wet : (..., n)
        Wet share of each point.
    """
    c, D = grid.coefficients, grid.diameter
    v = u if velocity is None else u - velocity
    shape = np.broadcast_shapes(v.shape, du.shape)
    flat = (-1, *shape[-2:])
    length = np.broadcast_to(grid.weight * wet, shape[:-1])
    forces = np.empty((int(np.prod(shape[:-2])), *shape[-2:]))
    morison(
        0.5 * c.density_kg_m3 * c.drag * D,
        0.25 * np.pi * c.density_kg_m3 * c.inertia * D**2,
        grid.normal,
        np.broadcast_to(v, shape).reshape(flat),
        np.broadcast_to(du, shape).reshape(flat),
        length.reshape(flat[:-1]),
        forces,
    )
    return forces.reshape(shape)


def nodal_loads(grid: MorisonPoints, forces: FloatArray) -> FloatArray:
    """Return loads on the assembly's DOFs (..., n_dof) from forces at the points (..., n, 3)."""
    flat = forces.reshape(-1, grid.points.size)
    return np.asarray((grid.N @ flat.T).T).reshape(*forces.shape[:-2], -1)


def wave_loads(
    grid: MorisonPoints,
    waves: Waves,
    t: FloatArray,
    *,
    current: Current | None = None,
    velocity: FloatArray | None = None,
) -> FloatArray:
    """Return loads on the assembly's DOFs (n_times, n_dof) [N] of waves and current.

    Linear theory without stretching wets the members up to still water, the other theories up to the
    surface.
    """
    t = np.atleast_1d(np.asarray(t, dtype=np.float64))
    u, du = waves.motion(grid.points, t)
    if current is not None:
        u = u + current.velocity(grid.points[:, 2])
    forces = point_forces(grid, u, du, velocity=velocity, wet=wetness(grid, waves.surface(grid.points, t)))
    return nodal_loads(grid, forces)


def added_mass(grid: MorisonPoints, *, eta: float = 0.0) -> sp.csr_array:
    """Return the hydrodynamic added mass ρ(C_M − 1)πD²/4 of the wet length, (n_dof, n_dof)."""
    c = grid.coefficients
    per_length = c.density_kg_m3 * (c.inertia - 1.0) * 0.25 * np.pi * grid.diameter**2
    wet = per_length * wetness(grid, np.full(grid.weight.size, eta))
    return spread(grid, wet[:, None, None] * grid.normal)


def drag_damping(grid: MorisonPoints, sigma: FloatArray) -> sp.csr_array:
    """Return the linearised relative drag, (n_dof, n_dof): Borgman's (1967) ½ρ C_D D √(8/π) σ per length.

    Parameters
    ----------
    sigma : (n,) standard deviation of the water's normal velocity at the points [m/s]
    """
    c = grid.coefficients
    wet = wetness(grid, np.zeros(grid.weight.size))
    per_length = 0.5 * c.density_kg_m3 * c.drag * grid.diameter * np.sqrt(8.0 / np.pi) * sigma * wet
    return spread(grid, per_length[:, None, None] * grid.normal)


def spread(grid: MorisonPoints, per_length: FloatArray) -> sp.csr_array:
    """Return N P Nᵀ on the DOFs from a 3×3 property per metre at each point, ``per_length`` (n, 3, 3)."""
    n = grid.weight.size
    blocks = per_length * grid.weight[:, None, None]
    P = sp.bsr_array((blocks, np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n))
    return sp.csr_array(grid.N @ P @ grid.N.T)
