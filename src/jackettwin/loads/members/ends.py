r"""Loads on the ends of members with axial coefficients.

At a joint, with the outward normals n of all member ends there,

.. math:: F = -C_{p} p A + \rho C_{a} \frac{V V^T}{|V|} \dot u + \frac{\rho C_{d}}{4|A|^2} |u·A| (u·A) A,
          \qquad A = \sum πR^2 n, \quad V = \sum \tfrac{2π}{3}R^3 n

and the same over every ring of a tapered member, where A = −π(R_2² − R_1²) k, V = ⅔π|R_2³ − R_1³| k and k
points from R_1 to R_2, so that the pressure acts on closed bodies. R includes marine growth.

The coefficients are those of OpenFAST's HydroDyn (``AxCp``, ``AxCa``, ``AxCd``; v5, module Morison), 0 by
default. The ends of continuous legs cancel; those of braces are treated as free ends in the water, so that
C_p = 1 gives an upper bound for a jacket.

Water does not reach a buried end: joints below the bed have no loads, as in HydroDyn (v5, Morison.f90:
``Position(3) >= -WtrDpth``). Feet on the bed have none either, since their legs or piles continue into the
ground; HydroDyn's files lower them by a millimetre for this purpose.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import require
from jackettwin.files import ForceCoefficient
from jackettwin.loads.members.coefficients import Coefficients
from jackettwin.loads.members.morison import distribution
from jackettwin.loads.sea.current import Current
from jackettwin.loads.sea.waves import Waves
from jackettwin.structure import PILES, Assembly, Structure

_RING_M = 0.5
"""Length of a ring of a tapered member."""
_ROUNDING_M = 1e-6
"""A joint at most this far below the bed counts as on it."""
_ON_THE_BED_M = 0.011
"""A foot at most this far above the bed counts as in it, as depths are given to the centimetre."""


@dataclass(frozen=True)
class EndCoefficients:
    """Axial coefficients of dynamic pressure, of the water's acceleration and of drag."""

    pressure: ForceCoefficient = 0.0
    added_mass: ForceCoefficient = 0.0
    drag: ForceCoefficient = 0.0

    def __post_init__(self) -> None:
        for field in ("pressure", "added_mass", "drag"):
            value = getattr(self, field)
            require(0.0 <= value < np.inf, "out of range", field=field, value=value, allowed="≥ 0")

    @property
    def any(self) -> bool:
        """Whether ends are loaded at all."""
        return max(self.pressure, self.added_mass, self.drag) > 0.0


@dataclass(frozen=True)
class Ends:
    """The joints with ends in the water, then the rings of tapered members.

    Attributes
    ----------
    points : (n, 3) z up from still water [m]
    area : (n, 3) A [m²]
    volume : (n, 3) V [m³]
    N : (assembly.n_dof, 3n) nodal loads from forces at the joints
    """

    points: FloatArray
    area: FloatArray
    volume: FloatArray
    N: sp.csr_array
    coefficients: EndCoefficients
    density_kg_m3: float


def member_ends(
    assembly: Assembly,
    coefficients: EndCoefficients,
    water: Coefficients,
    *,
    highest_z: float,
    lowest_z: float,
) -> Ends:
    """Return the ends of members at joints between the bed and a height, in m from still water."""
    structure = assembly.structure
    area: dict[str, FloatArray] = {}
    volume: dict[str, FloatArray] = {}
    for member in structure.members:
        if member.part == PILES:
            continue
        along = np.subtract(structure.nodes[member.end], structure.nodes[member.start])
        along = along / np.linalg.norm(along)
        for node, section, outward in (
            (member.start, member.section_start, -along),
            (member.end, member.section_end, along),
        ):
            z = structure.nodes[node][2] - structure.sea_level_z_m
            R = 0.5 * section.outer_diameter_m + float(water.thickness(np.array([z]))[0])
            area[node] = area.get(node, np.zeros(3)) + np.pi * R**2 * outward
            volume[node] = volume.get(node, np.zeros(3)) + 2.0 * np.pi / 3.0 * R**3 * outward
    sea = np.array([0.0, 0.0, structure.sea_level_z_m])
    names = [n for n in area if _is_open(structure, n, lowest_z, highest_z)]
    rows = [assembly.expand[assembly.mesh.node_dofs(name)[:3]] for name in names]
    blank = sp.csr_array((0, assembly.n_dof))
    rings = _rings(assembly, water)
    here = (rings.points[:, 2] >= lowest_z) & (rings.points[:, 2] <= highest_z)
    at_rings = distribution(assembly, rings.element[here], rings.xi[here])
    at_joints = sp.csr_array((sp.vstack(rows) if rows else blank).T)
    return Ends(
        points=np.vstack([*(np.subtract(structure.nodes[n], sea) for n in names), rings.points[here]]),
        area=np.vstack([*(area[n] for n in names), rings.area[here]]),
        volume=np.vstack([*(volume[n] for n in names), rings.volume[here]]),
        N=sp.csr_array(sp.hstack([at_joints, at_rings])),
        coefficients=coefficients,
        density_kg_m3=water.density_kg_m3,
    )


def _is_open(structure: Structure, node: str, bed_z: float, highest_z: float) -> bool:
    """Return whether water can reach the ends of members at a node."""
    z = structure.nodes[node][2] - structure.sea_level_z_m
    buried = _ON_THE_BED_M if node in structure.reaction_nodes else -_ROUNDING_M
    return bed_z + buried <= z <= highest_z


class _Rings(NamedTuple):
    """Rings of tapered members: middles, A, V, elements and positions along these."""

    points: FloatArray
    area: FloatArray
    volume: FloatArray
    element: IntArray
    xi: FloatArray


def _rings(assembly: Assembly, water: Coefficients) -> _Rings:
    structure, mesh = assembly.structure, assembly.mesh
    none = np.zeros((0, 3))
    found = [_Rings(none, none, none, np.zeros(0, dtype=np.intp), np.zeros(0))]
    for index, member in enumerate(structure.members):
        if member.part == PILES:
            continue
        first, last = (np.array(structure.nodes[node]) for node in (member.start, member.end))
        first, last = (end - [0.0, 0.0, structure.sea_level_z_m] for end in (first, last))
        length = float(np.linalg.norm(last - first))
        s = np.linspace(0.0, 1.0, int(np.ceil(length / _RING_M)) + 1)
        D0, D1 = (x.outer_diameter_m for x in (member.section_start, member.section_end))
        R = 0.5 * (D0 + s * (D1 - D0)) + water.thickness(first[2] + s * (last[2] - first[2]))
        middle, wider = 0.5 * (s[:-1] + s[1:]), np.pi * np.diff(R**2)
        kept = np.abs(wider) > 1e-9
        along, middle = (last - first) / length, middle[kept]
        elements = np.flatnonzero(mesh.member == index)
        place = middle * elements.size
        at = np.minimum(place.astype(np.intp), elements.size - 1)
        found.append(
            _Rings(
                first + middle[:, None] * (last - first),
                -wider[kept, None] * along,
                2.0 * np.pi / 3.0 * np.abs(np.diff(R**3))[kept, None] * along,
                elements[at],
                place - at,
            )
        )
    return _Rings(*(np.concatenate(part) for part in zip(*found, strict=True)))


def end_forces(ends: Ends, waves: Waves, t: FloatArray, *, current: Current | None = None) -> FloatArray:
    """Return the forces at the joints (n_times, n, 3) [N]; joints above the surface have none."""
    c, rho = ends.coefficients, ends.density_kg_m3
    u, du = waves.motion(ends.points, t)
    if current is not None:
        u = u + current.velocity(ends.points[:, 2])
    forces = -c.pressure * rho * waves.pressure(ends.points, t)[..., None] * ends.area
    size = np.maximum(np.linalg.norm(ends.volume, axis=1), 1e-12)
    forces += rho * c.added_mass * ((du * ends.volume).sum(-1) / size)[..., None] * ends.volume
    through = (u * ends.area).sum(-1)
    square = np.maximum((ends.area**2).sum(-1), 1e-24)
    forces += 0.25 * rho * c.drag * (np.abs(through) * through / square)[..., None] * ends.area
    wet = ends.points[:, 2] <= waves.surface(ends.points, t)
    return np.asarray(forces * wet[..., None])
