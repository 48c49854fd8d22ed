"""P-Δ effect: axial forces of self-weight, and the geometric stiffness that they cause.

The forces are found once, on the whole structure with its reaction nodes clamped; a part of it (a foundation
cut at its interface) takes them over, so that a jacket feels the tower it no longer has.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError
from jackettwin.structure import beam
from jackettwin.structure.eigen import definite_factor
from jackettwin.structure.masses import lever_arm_stiffness
from jackettwin.structure.mesh import Blocks, Mesh, sum_of_elements
from jackettwin.structure.model import PILES, Structure
from jackettwin.structure.two_node import TwoNodeElement


@dataclass(frozen=True)
class WeightForces:
    """Effect of self-weight on the parts of a structure, tension positive.

    Attributes
    ----------
    members : axial force [N] of every element of each member, by the member's name
    elements : axial force [N] of the elements that are no tubes, by name
    links : force [N] that pulls each follower of a rigid link, by the follower's name, (3,)
    """

    members: Mapping[str, FloatArray]
    elements: Mapping[str, float]
    links: Mapping[str, FloatArray]


def weight_forces(
    structure: Structure, mesh: Mesh, K: sp.csc_array, M: sp.csc_array, T: sp.csr_array
) -> WeightForces:
    """Return the forces of self-weight, reaction nodes clamped.

    Parameters
    ----------
    K, M : (mesh.n_dof, mesh.n_dof) without geometric stiffness
    T : (mesh.n_dof, n) all DOFs from the independent ones

    Raises
    ------
    InputError
        If the structure stands on nothing.
    """
    if not structure.reactions:
        raise InputError(
            "gravity needs ground under the structure",
            field="reaction_nodes",
            value=[],
            remedy="name the nodes that stand on the ground, or leave gravity out",
        )
    downwards = np.tile([0.0, 0.0, -GRAVITY_M_S2, 0.0, 0.0, 0.0], len(mesh.node_names))
    weight = M @ downwards
    held = np.concatenate([mesh.node_dofs(name) for name in structure.reaction_nodes])
    free = np.setdiff1d(np.arange(T.shape[1]), (T[held].nonzero())[1])
    Tf = sp.csc_array(T[:, free])
    u = Tf @ definite_factor(Tf.T @ K @ Tf).solve(Tf.T @ weight)
    N = beam.axial_force(mesh.properties, mesh.axes, u[mesh.element_dofs()])
    # ground holds a pile along its length: what it would carry hanging from its foot says nothing
    buried = np.array([member.part == PILES for member in structure.members], dtype=bool)
    N = np.where(buried[mesh.member], 0.0, N)
    pulls = weight - K @ u
    return WeightForces(
        members={m.name: N[mesh.member == k] for k, m in enumerate(structure.members)},
        elements={e.name: _axial_force(mesh, e, u) for e in mesh.others},
        links={link.follower: pulls[mesh.node_dofs(link.follower)[:3]] for link in structure.rigid_links},
    )


def geometric_stiffness(structure: Structure, mesh: Mesh, forces: WeightForces) -> sp.csc_array:
    """Return the stiffness that the forces of self-weight add on all DOFs of the mesh.

    Of a beam of any section as of a tube, of a cable as its tension; springs and rigid links have no length
    along which their force could turn.
    """
    N = np.concatenate([np.zeros(0), *(forces.members[m.name] for m in structure.members)])
    tubes = beam.to_global(beam.geometric_stiffness(N, mesh.properties), mesh.axes)
    blocks = [
        (_dofs(mesh, e), geometric)
        for e in mesh.others
        if (geometric := _of_element(mesh, e, forces.elements[e.name])) is not None
    ]
    return sum_of_elements(mesh, tubes, [*blocks, *_lever_arms(structure, mesh, forces)])


def _dofs(mesh: Mesh, element: TwoNodeElement) -> IntArray:
    return np.concatenate([mesh.node_dofs(element.start), mesh.node_dofs(element.end)])


def _ends(mesh: Mesh, element: TwoNodeElement) -> FloatArray:
    return mesh.coordinates[[mesh.node_names.index(node) for node in (element.start, element.end)]]


def _axial_force(mesh: Mesh, element: TwoNodeElement, u: FloatArray) -> float:
    a, b = _ends(mesh, element)
    L = float(np.linalg.norm(b - a))
    if L == 0.0:
        return 0.0
    pull = (np.array(element.stiffness) @ u[_dofs(mesh, element)])[6:9]
    return float(pull @ (b - a) / L)


def _of_element(mesh: Mesh, element: TwoNodeElement, N: float) -> FloatArray | None:
    """Return an element's geometric stiffness in global axes, (12, 12); None if it has none."""
    if element.kind not in ("beam", "cable"):
        return None
    ends = _ends(mesh, element)
    axes, L = beam.local_axes(ends[:1], ends[1:]), np.linalg.norm(ends[1] - ends[0])
    if element.kind == "cable":
        across = N / L * (np.eye(3) - np.outer(axes[0, 0], axes[0, 0]))
        K = np.zeros((12, 12))
        K[np.ix_(_TRANSLATIONS, _TRANSLATIONS)] = np.kron([[1.0, -1.0], [-1.0, 1.0]], across)
        return K
    one = np.ones(1)
    p = beam.BeamProperties(
        E=one, G=one, rho=one, A=one, I=one, J=one * element.polar_radius_m**2, L=one * L, Phi=0.0 * one
    )
    return np.asarray(beam.to_global(beam.geometric_stiffness(one * N, p), axes)[0])


_TRANSLATIONS = (0, 1, 2, 6, 7, 8)


def _lever_arms(structure: Structure, mesh: Mesh, forces: WeightForces) -> Blocks:
    """Return the rotational stiffness of forces at the end of rigid arms: eccentric masses, rigid links."""
    blocks = []
    for body in structure.masses:
        force = np.array([0.0, 0.0, -body.mass_kg * GRAVITY_M_S2])
        blocks.append((mesh.node_dofs(body.node)[3:], lever_arm_stiffness(force, np.array(body.cg_offset_m))))
    for link in structure.rigid_links:
        arm = np.subtract(structure.nodes[link.follower], structure.nodes[link.leader])
        block = lever_arm_stiffness(forces.links[link.follower], arm)
        blocks.append((mesh.node_dofs(link.leader)[3:], block))
    return blocks
