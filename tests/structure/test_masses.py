"""Rigid bodies on nodes: the thesis's RNA matrix, and a body's motion about another point."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.structure.masses import (
    body_from_static_moments,
    lever_arm_stiffness,
    rigid_body_mass,
    rigid_transfer,
)
from jackettwin.structure.model import PointMass

m, ax, ay, az = 80.9e4, -3.5, 0.7, 4.0
Ixx, Iyy, Izz, Ixy, Ixz, Iyz = 4.84e8, 2.78e8, 2.79e8, 1e7, -2e7, 3e7
BODY = PointMass("n", m, (ax, ay, az), (Ixx, Iyy, Izz, Ixy, Ixz, Iyz))


def test_rna_matrix_entry_by_entry() -> None:
    """Thesis equation (3.21), table 3.2 with products of inertia and a lateral offset added."""
    expected = np.array(
        [
            [m, 0, 0, 0, m * az, -m * ay],
            [0, m, 0, -m * az, 0, m * ax],
            [0, 0, m, m * ay, -m * ax, 0],
            [0, -m * az, m * ay, Ixx + m * (ay**2 + az**2), Ixy - m * ax * ay, Ixz - m * ax * az],
            [m * az, 0, -m * ax, Ixy - m * ax * ay, Iyy + m * (ax**2 + az**2), Iyz - m * ay * az],
            [-m * ay, m * ax, 0, Ixz - m * ax * az, Iyz - m * ay * az, Izz + m * (ax**2 + ay**2)],
        ]
    )
    np.testing.assert_allclose(rigid_body_mass(BODY), expected, rtol=1e-15)


def test_kinetic_energy_is_that_of_the_centre_of_gravity() -> None:
    """Invariant: ½ q̇ᵀMq̇ = ½ m |v + ω×a|² + ½ ωᵀIω."""
    rate = np.array([1.0, -2.0, 0.5, 0.01, 0.03, -0.02])
    v, omega = rate[:3] + np.cross(rate[3:], (ax, ay, az)), rate[3:]
    I = np.array([[Ixx, Ixy, Ixz], [Ixy, Iyy, Iyz], [Ixz, Iyz, Izz]])  # noqa: E741
    energy = 0.5 * m * v @ v + 0.5 * omega @ I @ omega
    assert 0.5 * rate @ rigid_body_mass(BODY) @ rate == pytest.approx(energy, rel=1e-14)


def test_a_body_by_its_moments_about_the_node_is_the_same_body() -> None:
    M = rigid_body_mass(BODY)
    J = M[3:, 3:]
    again = body_from_static_moments(
        node="n",
        mass_kg=m,
        static_moment_kg_m=(m * ax, m * ay, m * az),
        inertia_about_node_kg_m2=(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]),
    )
    np.testing.assert_allclose(rigid_body_mass(again), M, rtol=1e-12, atol=1e-6)


def test_moments_that_no_body_has_are_refused() -> None:
    """An inertia about the node smaller than that of the mass at its own offset."""
    with pytest.raises(InputError, match="inertia about the centre of gravity must not be negative"):
        body_from_static_moments(
            node="n",
            mass_kg=1e3,
            static_moment_kg_m=(0, 0, 5e3),
            inertia_about_node_kg_m2=(1e4, 1e4, 1e4, 0, 0, 0),
        )


def test_rigid_transfer_moves_the_end_of_an_arm() -> None:
    motion = np.array([0.1, 0.2, 0.3, 0.01, 0.02, 0.03])
    arm = np.array([1.0, -2.0, 5.0])
    expected = np.concatenate([motion[:3] + np.cross(motion[3:], arm), motion[3:]])
    np.testing.assert_allclose(rigid_transfer(arm) @ motion, expected, rtol=1e-14)


def test_lever_arm_stiffness_is_the_second_derivative_of_the_work() -> None:
    """Work of a dead force under finite rotations, by differences of the exact rotation matrix."""
    from scipy.spatial.transform import Rotation

    force, arm = np.array([3.0, -1.0, -9.0]), np.array([0.4, 0.2, 2.0])

    def potential(theta: np.ndarray) -> float:
        return float(-force @ (Rotation.from_rotvec(theta).as_matrix() @ arm))

    h, numeric, eye = 1e-4, np.empty((3, 3)), np.eye(3)
    for i in range(3):
        for j in range(3):
            corners = [
                potential(h * (a * eye[i] + b * eye[j])) for a, b in ((1, 1), (1, -1), (-1, 1), (-1, -1))
            ]
            numeric[i, j] = (corners[0] - corners[1] - corners[2] + corners[3]) / (4 * h**2)
    np.testing.assert_allclose(lever_arm_stiffness(force, arm), numeric, atol=1e-6)
