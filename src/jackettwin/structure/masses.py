"""Rigid bodies on nodes and at the end of rigid arms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jackettwin.structure.model import PointMass, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence

FloatArray = npt.NDArray[np.float64]


def cross_matrix(a: Sequence[float] | FloatArray) -> FloatArray:
    """Return S(a) with S(a)·b = a × b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def rigid_body_mass(body: PointMass) -> FloatArray:
    r"""Return the 6×6 mass matrix about the node, thesis eq. (3.21).

    :math:`M = [[m I, −m S(a)], [m S(a), I_{cg} − m S(a)S(a)]]`, a the offset of the centre of gravity.
    """
    m, S = body.mass_kg, cross_matrix(body.cg_offset_m)
    xx, yy, zz, xy, xz, yz = body.inertia_kg_m2
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    M = np.zeros((6, 6))
    M[:3, :3] = m * np.eye(3)
    M[:3, 3:] = -m * S
    M[3:, :3] = m * S
    M[3:, 3:] = inertia - m * S @ S
    return M


def lever_arm_stiffness(force: FloatArray, arm: FloatArray) -> FloatArray:
    """Return the 3×3 rotational stiffness of a dead force at the end of a rigid arm.

    The arm's end moves by θ×r + ½ θ×(θ×r); the force's work in the second term gives
    K = (f·r) I − ½(f rᵀ + r fᵀ).
    """
    coupling = np.outer(force, arm)
    return np.asarray((force @ arm) * np.eye(3) - 0.5 * (coupling + coupling.T))


def rigid_transfer(arm: FloatArray) -> FloatArray:
    """Return the 6×6 matrix that moves the motion of a rigid body's leader to a point at ``arm`` from it."""
    T = np.eye(6)
    T[:3, 3:] = -cross_matrix(arm)
    return T


def rna_from_static_moments(
    *,
    node: str,
    mass_kg: float,
    static_moment_kg_m: Vector,
    inertia_about_node_kg_m2: tuple[float, float, float, float, float, float],
) -> PointMass:
    """Return a rotor-nacelle assembly given by its moments about its node."""
    a = np.asarray(static_moment_kg_m) / mass_kg
    xx, yy, zz, xy, xz, yz = inertia_about_node_kg_m2
    about_node = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    S = cross_matrix(a)
    I = about_node + mass_kg * S @ S  # noqa: E741
    return PointMass(
        node=node,
        mass_kg=mass_kg,
        cg_offset_m=(float(a[0]), float(a[1]), float(a[2])),
        inertia_kg_m2=(
            float(I[0, 0]),
            float(I[1, 1]),
            float(I[2, 2]),
            float(I[0, 1]),
            float(I[0, 2]),
            float(I[1, 2]),
        ),
        part="rna",
    )
