"""Rigid bodies on nodes and at the end of rigid arms."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.structure.model import Inertia, PointMass, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence


def cross_matrix(a: Sequence[float] | FloatArray) -> FloatArray:
    """Return S(a) with S(a)·b = a × b, (..., 3, 3) of a (..., 3)."""
    v = np.asarray(a, dtype=np.float64)
    out = np.zeros((*v.shape, 3))
    for row, column, axis, sign in ((0, 1, 2, -1.0), (0, 2, 1, 1.0), (1, 2, 0, -1.0)):
        out[..., row, column], out[..., column, row] = sign * v[..., axis], -sign * v[..., axis]
    return out


def rigid_body_mass(body: PointMass) -> FloatArray:
    r"""Return the 6×6 mass matrix about the node, thesis eq. (3.21).

    :math:`M = [[m I, −m S(a)], [m S(a), I_{cg} − m S(a)S(a)]]`, a the offset of the centre of gravity.
    """
    m, S = body.mass_kg, cross_matrix(body.cg_offset_m)
    M = np.zeros((6, 6))
    M[:3, :3] = m * np.eye(3)
    M[:3, 3:] = -m * S
    M[3:, :3] = m * S
    M[3:, 3:] = body.inertia_tensor - m * S @ S
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


def body_from_static_moments(
    *,
    node: str,
    mass_kg: float,
    static_moment_kg_m: Vector,
    inertia_about_node_kg_m2: tuple[float, float, float, float, float, float],
    part: str = "",
) -> PointMass:
    """Return a rigid body given by its moments about its node (``mass_kg`` > 0).

    Raises
    ------
    InputError
        If the moments leave a negative inertia about the centre of gravity.
    """
    a = np.asarray(static_moment_kg_m) / mass_kg
    xx, yy, zz, xy, xz, yz = inertia_about_node_kg_m2
    S = cross_matrix(a)
    I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) + mass_kg * S @ S  # noqa: E741
    rows, columns = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)
    inertia = tuple(float(I[i, j]) for i, j in zip(rows, columns, strict=True))
    return PointMass(node, mass_kg, (float(a[0]), float(a[1]), float(a[2])), cast("Inertia", inertia), part)


def about_vertical(angle: float) -> FloatArray:
    """Return the rotation (3, 3) about the vertical by ``angle`` [rad], right-handed."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def turned_body(body: PointMass, angle: float) -> PointMass:
    """Return a body turned about the vertical through its node by ``angle`` [rad], right-handed."""
    R = about_vertical(angle)
    a, I = R @ np.array(body.cg_offset_m), R @ body.inertia_tensor @ R.T  # noqa: E741
    inertia = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])
    return replace(
        body,
        cg_offset_m=cast("Vector", tuple(map(float, a))),
        inertia_kg_m2=cast("Inertia", tuple(map(float, inertia))),
    )
