"""Division of a structure into elements and numbered degrees of freedom, and assembly of their matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.errors import require
from jackettwin.structure import beam
from jackettwin.structure.model import Beam, Member, Structure
from jackettwin.structure.sections import tube_properties
from jackettwin.structure.two_node import TwoNodeElement, beam_matrices, two_node_element

BEAMS = ("euler-bernoulli", "timoshenko")


@dataclass(frozen=True)
class Mesh:
    """Nodes and elements as arrays.

    Attributes
    ----------
    node_names : tuple of str
        The structure's nodes first, in its order; then the inner nodes of subdivided members.
    coordinates : (n_nodes, 3) array [m]
    start, end : (n_elements,) node numbers
    member : (n_elements,) index into ``structure.members``
    properties : BeamProperties
    axes : (n_elements, 3, 3) local axes
    others : tuple of TwoNodeElement
        What is no tube: the structure's elements, and the pieces of its beams.
    """

    node_names: tuple[str, ...]
    coordinates: FloatArray
    start: IntArray
    end: IntArray
    member: IntArray
    properties: beam.BeamProperties
    axes: FloatArray
    others: tuple[TwoNodeElement, ...] = ()

    @property
    def n_dof(self) -> int:
        """Number of degrees of freedom before any constraint."""
        return DOFS_PER_NODE * len(self.node_names)

    def element_dofs(self) -> IntArray:
        """Return the DOF numbers of every element, (n_elements, 12)."""
        offsets = np.arange(DOFS_PER_NODE)
        return np.hstack(
            [DOFS_PER_NODE * self.start[:, None] + offsets, DOFS_PER_NODE * self.end[:, None] + offsets]
        )

    def node_dofs(self, name: str) -> IntArray:
        """Return the six DOF numbers of a node."""
        return DOFS_PER_NODE * self.node_names.index(name) + np.arange(DOFS_PER_NODE)


def discretise(
    structure: Structure,
    *,
    theory: str | None = None,
    subdivide: int | None = None,
    rotary_inertia: bool = False,
) -> Mesh:
    """Return the elements of a structure, each member and beam cut into ``subdivide`` equal pieces.

    A member may have its own number. Tapered ones take the mean diameter and wall of each piece.
    ``rotary_inertia`` is that of the beams that are no tubes, whose matrices are made here.

    Raises
    ------
    InputError
        If the beam theory is unknown or ``subdivide`` is not a positive integer.
    """
    theory = structure.beam if theory is None else theory
    n = structure.subdivide if subdivide is None else subdivide
    require(theory in BEAMS, "unknown beam theory", field="beam", value=theory, allowed=", ".join(BEAMS))
    require(1 <= n <= 1000, "elements a member", field="subdivide", value=n, allowed="1 to 1000")
    members = structure.members
    names, coordinates, along = _nodes(structure, n)
    counts = np.array([nodes.size - 1 for nodes in along[: len(members)]], dtype=np.intp)
    start, end = (
        np.concatenate([np.zeros(0, dtype=np.intp), *(nodes[piece] for nodes in along[: len(members)])])
        for piece in (slice(None, -1), slice(1, None))
    )
    of = np.repeat(np.arange(len(members)), counts)
    at = (np.arange(of.size) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) / counts[of]
    D = _along(members, "outer_diameter_m", of, at)
    t = _along(members, "thickness_m", of, at)
    E, G, rho = (
        np.array([getattr(m.material, key) for m in members], dtype=np.float64)[of]
        for key in ("youngs_modulus_pa", "shear_modulus_pa", "density_kg_m3")
    )
    L = np.linalg.norm(coordinates[end] - coordinates[start], axis=1)
    tube = tube_properties(D, t, E / (2.0 * G) - 1.0)
    Phi = 12.0 * E * tube.I / (tube.kappa * G * tube.A * L**2) if theory == "timoshenko" else np.zeros_like(L)
    return Mesh(
        node_names=names,
        coordinates=coordinates,
        start=start,
        end=end,
        member=of,
        properties=beam.BeamProperties(E=E, G=G, rho=rho, A=tube.A, I=tube.I, J=tube.J, L=L, Phi=Phi),
        axes=beam.local_axes(coordinates[start], coordinates[end]),
        others=(
            *structure.elements,
            *(
                element
                for one, nodes in zip(structure.beams, along[len(members) :], strict=True)
                for element in _pieces(
                    one,
                    [names[k] for k in nodes],
                    coordinates[nodes],
                    shear=theory == "timoshenko",
                    rotary_inertia=rotary_inertia,
                    shear_in_mass=structure.shear_in_mass,
                )
            ),
        ),
    )


def _pieces(
    one: Beam, names: list[str], points: FloatArray, *, shear: bool, rotary_inertia: bool, shear_in_mass: bool
) -> list[TwoNodeElement]:
    """Return the elements of a beam of any section, from node to node along it."""
    axes = beam_axes(points[0], points[-1], one.twist_rad)
    material, section = one.material, one.section
    K, M = beam_matrices(
        axes,
        float(np.linalg.norm(points[1] - points[0])),
        section,
        E=material.youngs_modulus_pa,
        G=material.shear_modulus_pa,
        rho=material.density_kg_m3,
        shear=shear,
        rotary_inertia=rotary_inertia,
        shear_in_mass=shear_in_mass,
    )
    radius = (section.I_p / section.A) ** 0.5
    whole = len(names) == 2
    return [
        two_node_element(one.name if whole else f"{one.name}/{k}", "beam", ends, K, M, polar_radius_m=radius)
        for k, ends in enumerate(pairwise(names), start=1)
    ]


def beam_axes(start: FloatArray, end: FloatArray, twist_rad: float) -> FloatArray:
    """Return (3, 3): along a beam, then its section's x and y, in rows; ``twist_rad`` as of a ``Beam``."""
    along, y, z = beam.local_axes(start[None], end[None])[0]
    c, s = np.cos(twist_rad), np.sin(twist_rad)
    return np.array([along, c * y + s * z, c * z - s * y])


def _along(members: tuple[Member, ...], attribute: str, of: IntArray, at: FloatArray) -> FloatArray:
    """Return a measure of the tubes at shares ``at`` of the lengths of the members ``of``, (n_elements,)."""
    first = np.array([getattr(m.section_start, attribute) for m in members], dtype=np.float64)
    last = np.array([getattr(m.section_end, attribute) for m in members], dtype=np.float64)
    return np.asarray(first[of] + (last - first)[of] * at)


def _nodes(structure: Structure, usual: int) -> tuple[tuple[str, ...], FloatArray, list[IntArray]]:
    """Return node names, coordinates, and the numbers of the nodes along every member, then every beam."""
    names = list(structure.nodes)
    number = {name: i for i, name in enumerate(names)}
    points = [np.array([structure.nodes[name] for name in names], dtype=np.float64).reshape(-1, 3)]
    along = []
    for member in structure.bars:
        n = member.elements or usual
        inner = range(len(names), len(names) + n - 1)
        along.append(np.array([number[member.start], *inner, number[member.end]], dtype=np.intp))
        if n > 1:
            names += [f"{member.name}/{k}" for k in range(1, n)]
            a, b = np.array(structure.nodes[member.start]), np.array(structure.nodes[member.end])
            points.append(a + (b - a) * (np.arange(1, n) / n)[:, None])
    return tuple(names), np.vstack(points), along


Blocks = Sequence[tuple[IntArray, FloatArray]]
"""Dense square matrices, each with the DOFs that it is on."""


def sum_of_elements(mesh: Mesh, matrices: FloatArray, blocks: Blocks = ()) -> sp.csc_array:
    """Return the sum of the elements' matrices (n_elements, 12, 12) and of blocks, on all DOFs."""
    dofs = mesh.element_dofs()
    rows, columns = np.repeat(dofs, 12, axis=1).ravel(), np.tile(dofs, (1, 12)).ravel()
    return _summed(mesh, [(rows, columns, matrices.ravel()), *_entries(blocks)])


def sum_of_blocks(mesh: Mesh, blocks: Blocks) -> sp.csc_array:
    """Return the sum of dense blocks."""
    return _summed(mesh, _entries(blocks)) if blocks else sp.csc_array((mesh.n_dof, mesh.n_dof))


Entries = tuple[IntArray, IntArray, FloatArray]


def _entries(blocks: Blocks) -> list[Entries]:
    return [(np.repeat(dofs, dofs.size), np.tile(dofs, dofs.size), np.ravel(block)) for dofs, block in blocks]


def _summed(mesh: Mesh, entries: list[Entries]) -> sp.csc_array:
    rows, columns, values = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    total = sp.coo_array((values, (rows, columns)), shape=(mesh.n_dof, mesh.n_dof)).tocsc()
    total.eliminate_zeros()
    return total
