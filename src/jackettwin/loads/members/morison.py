r"""Morison's equation on every member: thesis (5.1), with relative velocity (2.2).

Per unit length, with all vectors normal to the member (subscript n):

.. math:: f = ½ρ C_D D |v_n| v_n + ρ C_M \tfrac{π}{4}D^2 \dot u_n − ρ C_a \tfrac{π}{4}D^2 \ddot x_n,
          \qquad v = u − \dot x,\quad C_M = C_p + C_a

Loads are integrated at Gauss points with the elements' shape functions, so that forces, motions of the
members, added mass and linear drag damping all use one sparse matrix N.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.structure import PILES, Assembly, Structure, beam
from jackettwin.structure.mesh import Mesh


@dataclass(frozen=True)
class MorisonPoints:
    """Gauss points along the members that may be wet.

    Attributes
    ----------
    points : (n, 3) z up from still water [m]
    weight : (n,) integration length of each point [m]
    middle_z, half_height : (n,) middle and half the height of that length [m], for its wet share
    diameter : (n,) hydrodynamic diameter including growth [m]
    tube_diameter, bore : (n,) outer and inner diameter of the steel [m]
    growth_density : (n,) density of the growth [kg/m³]
    drag, added_mass, pressure : (n,) C_D, C_a and C_p
    element, xi : (n,) index into the mesh's elements, and place x/L along them
    member : (n,) index into the structure's members
    normal : (n, 3, 3) projector onto the plane normal to the member
    N : (assembly.n_dof, 3n) sparse matrix from point forces to nodal loads; its transpose gives point motions
    """

    points: FloatArray
    weight: FloatArray
    middle_z: FloatArray
    half_height: FloatArray
    diameter: FloatArray
    tube_diameter: FloatArray
    bore: FloatArray
    growth_density: FloatArray
    drag: FloatArray
    added_mass: FloatArray
    pressure: FloatArray
    element: IntArray
    xi: FloatArray
    member: IntArray
    normal: FloatArray
    N: sp.csr_array
    density_kg_m3: float

    @property
    def drag_per_length(self) -> FloatArray:
        """½ρ C_D D, (n,) [kg/m²]."""
        return 0.5 * self.density_kg_m3 * self.drag * self.diameter

    @property
    def inertia_per_length(self) -> FloatArray:
        """ρ (C_p + C_a) πD²/4, (n,) [kg/m]."""
        return 0.25 * np.pi * self.density_kg_m3 * (self.pressure + self.added_mass) * self.diameter**2

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
    exclude_parts: tuple[str, ...] = (PILES,),
) -> MorisonPoints:
    """Return the Gauss points of members between ``lowest_z`` and ``highest_z`` [m] from still water.

    Each element is divided into segments no longer than ``spacing`` [m], with two Gauss points each.
    """
    coefficients = Coefficients() if coefficients is None else coefficients
    mesh, structure = assembly.mesh, assembly.structure
    ends = mesh.coordinates - [0.0, 0.0, structure.sea_level_z_m]
    z0, z1 = ends[mesh.start, 2], ends[mesh.end, 2]
    reaches = (np.minimum(z0, z1) <= highest_z) & (np.maximum(z0, z1) >= lowest_z)
    wanted = _of_parts(structure, mesh, reaches, exclude_parts)
    pieces = [_gauss(float(mesh.properties.L[e]), spacing) for e in wanted]
    element = np.repeat(wanted, [weight.size for _, _, weight in pieces])
    at, middle, length = (np.concatenate(part) for part in zip(*pieces, strict=True))
    start, end = ends[mesh.start[element]], ends[mesh.end[element]]
    points = start + at[:, None] * (end - start)
    member, z = mesh.member[element], points[:, 2]
    outer, bore = _diameters(assembly, member, points)
    drag, added, pressure = coefficients.at(z, member, [(m.name, m.part) for m in structure.members])
    axis = mesh.axes[element, 0]
    return MorisonPoints(
        points=points,
        weight=length,
        middle_z=start[:, 2] + middle * (end - start)[:, 2],
        half_height=0.5 * length * np.abs(axis[:, 2]),
        diameter=outer + 2.0 * coefficients.thickness(z),
        tube_diameter=outer,
        bore=bore,
        growth_density=coefficients.growth_density(z),
        drag=drag,
        added_mass=added,
        pressure=pressure,
        element=element.astype(np.intp),
        xi=at,
        member=member,
        normal=np.eye(3) - axis[:, :, None] * axis[:, None, :],
        N=distribution(assembly, element, at),
        density_kg_m3=coefficients.density_kg_m3,
    )


def _of_parts(
    structure: Structure, mesh: Mesh, reaches: BoolArray, exclude: tuple[str, ...]
) -> list[np.intp]:
    """Return the elements within the heights that belong to no excluded part."""
    wanted = [e for e in np.flatnonzero(reaches) if structure.members[mesh.member[e]].part not in exclude]
    if not wanted:
        raise InputError(
            "no member is within the water or the requested heights",
            field="sea_level_z_m",
            value=structure.sea_level_z_m,
            allowed="a level above the lowest tube",
            remedy="state sea_level_z_m in the structure's file; beams that are not tubes have no wave loads",
        )
    return wanted


def _diameters(assembly: Assembly, member: IntArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return outer and inner diameter at points on members, interpolated linearly between the ends."""
    structure = assembly.structure
    sea = np.array([0.0, 0.0, structure.sea_level_z_m])
    ends = np.array([[structure.nodes[m.start], structure.nodes[m.end]] for m in structure.members]) - sea
    size = np.array(
        [
            [(s.outer_diameter_m, s.outer_diameter_m - 2.0 * s.thickness_m) for s in sections]
            for sections in ((m.section_start, m.section_end) for m in structure.members)
        ]
    )
    first, last = np.moveaxis(ends, 1, 0)
    along = np.linalg.norm(points - first[member], axis=1) / np.linalg.norm(last - first, axis=1)[member]
    start, end = np.moveaxis(size[member], 1, 0)
    outer, bore = (start + along[:, None] * (end - start)).T
    return outer, bore


def distribution(assembly: Assembly, element: IntArray, xi: FloatArray) -> sp.csr_array:
    """Return N, from forces at ``xi`` along elements to loads on the assembly's DOFs."""
    mesh = assembly.mesh
    dofs = mesh.element_dofs()[element]
    R, local = mesh.axes[element], _shapes(mesh, element, xi)
    ends = np.stack([local[:, :, 3 * k : 3 * k + 3] @ R for k in range(4)], axis=2)
    shapes = np.einsum("nji,njkl->nikl", R, ends).reshape(-1, 12)
    rows, columns = np.repeat(dofs, 3, axis=0), np.broadcast_to(np.arange(3 * xi.size)[:, None], shapes.shape)
    full = sp.coo_array((shapes.ravel(), (rows.ravel(), columns.ravel())), shape=(mesh.n_dof, 3 * xi.size))
    return sp.csr_array(assembly.expand.T @ full.tocsr())


def _shapes(mesh: Mesh, element: IntArray, xi: FloatArray) -> FloatArray:
    """Return the local translation at points on elements from their end displacements, (n, 3, 12)."""
    L = mesh.properties.L[element]
    return beam.translation_shape(xi, L)


def loads_along(assembly: Assembly, grid: MorisonPoints) -> sp.csr_array:
    """Return the matrix (12 n_elements, 3n) from point forces to loads on elements' ends in local axes."""
    mesh, n = assembly.mesh, grid.weight.size
    blocks = np.einsum("nji,njk->nik", _shapes(mesh, grid.element, grid.xi), mesh.axes[grid.element])
    rows = 12 * grid.element[:, None] + np.arange(12)
    columns = 3 * np.arange(n)[:, None] + np.arange(3)
    at = np.broadcast_arrays(rows[:, :, None], columns[:, None, :])
    shape = (12 * mesh.start.size, 3 * n)
    return sp.coo_array((blocks.ravel(), (at[0].ravel(), at[1].ravel())), shape=shape).tocsr()


def _gauss(L: float, spacing: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x/L of two Gauss points per segment, x/L of the middle of each half segment, and lengths [m]."""
    n = int(np.ceil(L / spacing))
    x = np.array([-1.0, 1.0]) / np.sqrt(3.0)
    xi, middle = (((np.arange(n)[:, None] + 0.5 + 0.5 * at) / n).ravel() for at in (x, 0.5 * np.sign(x)))
    return xi, middle, np.full(xi.size, 0.5 * L / n)


def wetness(grid: MorisonPoints, eta: FloatArray) -> FloatArray:
    """Return the wet share (0 to 1) of each point's length under surface ``eta`` (..., n) [m]."""
    half = np.maximum(grid.half_height, 1e-9)
    return np.asarray(np.clip(0.5 + 0.5 * (eta - grid.middle_z) / half, 0.0, 1.0))


def above_bed(grid: MorisonPoints, depth: float) -> FloatArray:
    """Return the share (0 to 1) of each point's length above the bed at ``depth`` [m], (n,)."""
    height, half = grid.middle_z + depth, grid.half_height
    share = np.clip(0.5 + 0.5 * height / np.maximum(half, 1e-9), 0.0, 1.0)
    # 1 mm: a horizontal brace on the bed counts as above it regardless of rounding
    return np.asarray(np.where(half < 1e-6, height > -1e-3, share))


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
        Velocity of the member, for relative drag, thesis (2.2). The force due to its acceleration is part of
        the mass matrix (``added_mass``).
    wet : (..., n)
        Wet share of each point.
    """
    from jackettwin.loads.kernels import morison  # imported here because it loads a compiler

    v = u if velocity is None else u - velocity
    shape = np.broadcast_shapes(v.shape, du.shape)
    length = np.broadcast_to(grid.weight * wet, shape[:-1])
    n = shape[-2]
    forces = np.empty((n, 3, int(np.prod(shape[:-2]))))
    # time is contiguous in the kernel, as in series of a random sea
    fields = (v,) if du is v else (v, du)
    seen, *others = (
        np.ascontiguousarray(np.broadcast_to(field, shape).reshape(-1, n, 3).transpose(2, 1, 0))
        for field in fields
    )
    morison(
        grid.drag_per_length,
        grid.inertia_per_length,
        grid.normal,
        seen,
        others[0] if others else seen,
        np.ascontiguousarray(length.reshape(-1, n).T),
        forces,
    )
    return forces.transpose(2, 0, 1).reshape(shape)


def nodal_loads(grid: MorisonPoints, forces: FloatArray) -> FloatArray:
    """Return loads on the assembly's DOFs (..., n_dof) from forces at the points (..., n, 3)."""
    flat = forces.reshape(-1, grid.points.size)
    return np.asarray((grid.N @ flat.T).T).reshape(*forces.shape[:-2], -1)


def added_mass(grid: MorisonPoints, *, eta: float = 0.0) -> sp.csr_array:
    """Return the hydrodynamic added mass ρC_a πD²/4 of the wet length, (n_dof, n_dof)."""
    per_length = grid.density_kg_m3 * grid.added_mass * 0.25 * np.pi * grid.diameter**2
    wet = per_length * wetness(grid, np.full(grid.weight.size, eta))
    return spread(grid, wet[:, None, None] * grid.normal)


def drag_damping(grid: MorisonPoints, sigma: FloatArray) -> sp.csr_array:
    """Return the linearised relative drag, (n_dof, n_dof): Borgman's (1967) ½ρ C_D D √(8/π) σ per length.

    Parameters
    ----------
    sigma : (n,) standard deviation of the water's normal velocity at the points [m/s]
    """
    wet = wetness(grid, np.zeros(grid.weight.size))
    per_length = grid.drag_per_length * np.sqrt(8.0 / np.pi) * sigma * wet
    return spread(grid, per_length[:, None, None] * grid.normal)


def spread(grid: MorisonPoints, per_length: FloatArray) -> sp.csr_array:
    """Return N P Nᵀ on the DOFs for a property per metre at each point, ``per_length`` (n, 3, 3)."""
    n = grid.weight.size
    blocks = per_length * grid.weight[:, None, None]
    P = sp.bsr_array((blocks, np.arange(n), np.arange(n + 1)), shape=(3 * n, 3 * n))
    return sp.csr_array(grid.N @ P @ grid.N.T)
