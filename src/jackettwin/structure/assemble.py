"""Elements to sparse system matrices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import IntArray
from jackettwin.axes import DOFS_PER_NODE
from jackettwin.errors import InputError
from jackettwin.structure import beam
from jackettwin.structure.masses import rigid_body_mass, rigid_transfer
from jackettwin.structure.mesh import Blocks, Mesh, discretise, sum_of_elements
from jackettwin.structure.model import Structure
from jackettwin.structure.weight import WeightForces, geometric_stiffness, weight_forces


@dataclass(frozen=True)
class Assembly:
    """The free (unsupported) structure: M ẍ + K x = f.

    Attributes
    ----------
    mesh : Mesh
    stiffness, mass : (n_dof, n_dof) sparse
        On the independent DOFs; ``stiffness`` holds the geometric part if gravity acts.
    expand : (mesh.n_dof, n_dof) sparse
        Gives every node's motion from the independent DOFs (rigid links are eliminated).
    independent : (n_dof,)
        Which of the mesh's DOFs the independent ones are.
    weight : WeightForces, optional
        What self-weight presses on; None where gravity does not act.
    """

    structure: Structure
    mesh: Mesh
    stiffness: sp.csc_array
    mass: sp.csc_array
    expand: sp.csr_array
    independent: IntArray
    weight: WeightForces | None

    def __repr__(self) -> str:
        gravity = "with" if self.gravity else "without"
        return f"Assembly({self.structure.name!r}, {self.stiffness.shape[0]} DOFs, {gravity} gravity)"

    @property
    def gravity(self) -> bool:
        """Whether ``stiffness`` holds the geometric part of the self-weight."""
        return self.weight is not None

    @property
    def n_dof(self) -> int:
        """Number of independent degrees of freedom."""
        return int(self.mass.shape[0])

    def dofs(self, node: str) -> IntArray:
        """Return the six independent DOF numbers of a node.

        Raises
        ------
        InputError
            If the node does not exist or follows another by a rigid link.
        """
        if node not in self.structure.nodes:
            raise InputError("no such node", field="node", value=node, remedy="name a node of the structure")
        first, *_, last = self.mesh.node_dofs(node)
        own = self.expand.indices[self.expand.indptr[first] : self.expand.indptr[last + 1]]
        if own.size != DOFS_PER_NODE:
            raise InputError(
                "node follows another by a rigid link",
                field="node",
                value=node,
                remedy="name the link's leader",
            )
        return np.asarray(own, dtype=np.intp)


def assemble(
    structure: Structure,
    *,
    beam_theory: str | None = None,
    rotary_inertia: bool | None = None,
    subdivide: int | None = None,
    gravity: bool = False,
    weight: WeightForces | None = None,
) -> Assembly:
    """Return the sparse matrices of the free structure.

    Parameters
    ----------
    beam_theory : {"euler-bernoulli", "timoshenko"}, optional
        Default: the structure's own.
    rotary_inertia : bool, optional
        Add ρI to the consistent mass. Default: the structure's own (Timoshenko beams always have it).
    subdivide : int, optional
        Elements a member. Default: the structure's own.
    gravity : bool
        Add the geometric (P-Δ) stiffness of the self-weight; axial forces from a static solution with the
        reaction nodes clamped.
    weight : WeightForces, optional
        The forces to take for that: those of the whole of which this structure is a part.

    Raises
    ------
    InputError
        If an option is out of range, or gravity is asked of a structure that stands on nothing.
    """
    theory = structure.beam if beam_theory is None else beam_theory
    rotary = (
        structure.rotary_inertia if rotary_inertia is None else rotary_inertia
    ) or theory == "timoshenko"
    mesh = discretise(structure, theory=theory, subdivide=subdivide, rotary_inertia=rotary)
    p, R = mesh.properties, mesh.axes
    K = sum_of_elements(mesh, beam.to_global(beam.stiffness(p), R), _elements(mesh, "stiffness"))
    inertial = p if structure.shear_in_mass else replace(p, Phi=np.zeros_like(p.Phi))
    M = sum_of_elements(
        mesh,
        beam.to_global(beam.mass(inertial, rotary_inertia=rotary), R),
        [*_elements(mesh, "mass"), *_point_masses(structure, mesh)],
    )
    T, independent = _rigid_links(structure, mesh)
    if gravity:
        weight = weight_forces(structure, mesh, K, M, T) if weight is None else weight
        K = K + geometric_stiffness(structure, mesh, weight)
    if structure.rigid_links:
        K, M = sp.csc_array(T.T @ K @ T), sp.csc_array(T.T @ M @ T)
    return Assembly(structure, mesh, K, M, T, independent, weight if gravity else None)


def _elements(mesh: Mesh, matrix: Literal["stiffness", "mass"]) -> Blocks:
    """Return the matrices of the elements that are no tubes."""
    return [
        (np.concatenate([mesh.node_dofs(e.start), mesh.node_dofs(e.end)]), np.array(getattr(e, matrix)))
        for e in mesh.others
    ]


def _point_masses(structure: Structure, mesh: Mesh) -> Blocks:
    blocks = [(mesh.node_dofs(m.node), rigid_body_mass(m)) for m in structure.masses]
    for reaction in structure.reactions:
        if reaction.mass is not None:
            blocks.append((mesh.node_dofs(reaction.node), np.array(reaction.mass)))
    return blocks


def _rigid_links(structure: Structure, mesh: Mesh) -> tuple[sp.csr_array, IntArray]:
    """Return T with u = T q, and which DOFs are in q: of followers an angle for each released axis."""
    gone, entries = [np.zeros(0, dtype=np.intp)], []
    for link in structure.rigid_links:
        rows, columns = mesh.node_dofs(link.follower), mesh.node_dofs(link.leader)
        arm = np.subtract(structure.nodes[link.follower], structure.nodes[link.leader])
        entries.append((np.repeat(rows, 6), np.tile(columns, 6), rigid_transfer(arm).ravel()))
        free = len(link.release)
        for angle, axis in zip(rows[3:], link.release, strict=False):
            entries.append((rows[3:], np.repeat(angle, 3), np.array(axis)))
        gone.append(np.concatenate([rows[:3], rows[3 + free :]]))
    followers = [mesh.node_dofs(link.follower) for link in structure.rigid_links]
    keep = np.setdiff1d(np.arange(mesh.n_dof), np.concatenate(gone))
    own = np.setdiff1d(keep, np.concatenate([gone[0], *followers]))
    rows, columns, values = (
        np.concatenate(parts) for parts in zip((own, own, np.ones(own.size)), *entries, strict=True)
    )
    at = np.searchsorted(keep, columns)
    result = sp.coo_array((values, (rows, at)), shape=(mesh.n_dof, keep.size)).tocsr()
    result.eliminate_zeros()
    return result, np.asarray(keep, dtype=np.intp)
