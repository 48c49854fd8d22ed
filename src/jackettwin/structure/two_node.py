r"""Elements other than tubes, as matrices between two nodes: cables, springs, beams of any section.

They carry load and have weight, but waves do not load them and no code check covers them.
Gravity adds the stiffness of their axial force to beams and cables (``weight.py``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.structure import beam

Matrix = tuple[tuple[float, ...], ...]

_EACH = 12
"""Degrees of freedom of an element: six of each node."""


@dataclass(frozen=True)
class TwoNodeElement:
    """Stiffness and mass between two nodes, on [u, v, w, θx, θy, θz] of each in global axes, (12, 12).

    ``polar_radius_m`` is a beam's √(I_p/A): what an axial force does to its torsion. ``damping`` is the
    element's own, which takes the place of the steel's.
    """

    name: str
    kind: str
    start: str
    end: str
    stiffness: Matrix
    mass: Matrix
    polar_radius_m: float = 0.0
    damping: Matrix | None = None


@dataclass(frozen=True)
class BeamSection:
    """Section of a beam of any shape about its principal axes x and y; its centroid is its shear centre.

    ``A_x``, ``A_y`` are shear areas [m²], infinite where shear does not bend it; ``I_x``, ``I_y`` second
    moments of area, ``I_p`` the polar one and ``J`` the torsion constant [m⁴].
    """

    A: float
    A_x: float
    A_y: float
    I_x: float
    I_y: float
    I_p: float
    J: float


def two_node_element(
    name: str,
    kind: str,
    nodes: tuple[str, str],
    stiffness: FloatArray,
    mass: FloatArray | None = None,
    *,
    polar_radius_m: float = 0.0,
    damping: FloatArray | None = None,
) -> TwoNodeElement:
    """Return an element from its matrices in global axes, (12, 12); without mass if None."""

    def rows(matrix: FloatArray) -> Matrix:
        return tuple(tuple(float(v) for v in row) for row in matrix)

    M = np.zeros((_EACH, _EACH)) if mass is None else mass
    own = None if damping is None else rows(damping)
    return TwoNodeElement(name, kind, *nodes, rows(stiffness), rows(M), polar_radius_m, own)


def cable_matrices(
    a: FloatArray, b: FloatArray, *, EA: float, tension: float, mass_per_m: float
) -> tuple[FloatArray, FloatArray]:
    r"""Return stiffness and mass of a taut cable from a to b, (12, 12) in global axes.

    With the slack length :math:`L_0 = L/(1+ε_0)`, :math:`ε_0 = T/EA`: :math:`EA/L_0` along the cable,
    :math:`T/L` across it (SubDyn theory manual, section on pretension cables). Rotations take no part.

    Parameters
    ----------
    EA, tension : [N]
    mass_per_m : of the slack cable [kg/m]
    """
    L = float(np.linalg.norm(b - a))
    strain = tension / EA
    slack = L / (1.0 + strain)
    R = beam.local_axes(a[None], b[None])
    K = _translations(R[0], EA / slack, tension / L, np.array([[1.0, -1.0], [-1.0, 1.0]]))
    return K, bar_mass(a, b, mass=mass_per_m * slack)


def bar_mass(a: FloatArray, b: FloatArray, *, mass: float) -> FloatArray:
    """Return SubDyn's mass of cables and rigid links, (12, 12): without rotary inertia of the ends."""
    R = beam.local_axes(a[None], b[None])[0]
    along = mass * np.outer(R[0], R[0])
    across = mass * (np.eye(3) - np.outer(R[0], R[0]))
    own, other = along / 3.0 + across * 13.0 / 35.0, along / 6.0 + across * 9.0 / 70.0
    M = np.zeros((_EACH, _EACH))
    M[:3, :3] = M[6:9, 6:9] = own
    M[:3, 6:9] = M[6:9, :3] = other
    return M


def _translations(axes: FloatArray, along: float, across: float, pattern: FloatArray) -> FloatArray:
    direction = np.outer(axes[0], axes[0])
    block = along * direction + across * (np.eye(3) - direction)
    K = np.zeros((_EACH, _EACH))
    for i in range(2):
        for j in range(2):
            K[6 * i : 6 * i + 3, 6 * j : 6 * j + 3] = pattern[i, j] * block
    return K


def spring_matrix(k: FloatArray, axes: FloatArray) -> FloatArray:
    """Return [[k, −k], [−k, k]], (12, 12): a 6×6 spring between two nodes; ``axes`` are its own, in rows."""
    T = np.kron(np.eye(2), axes)
    turned = T.T @ k @ T
    return np.block([[turned, -turned], [-turned, turned]])


def beam_matrices(
    axes: FloatArray,
    L: float,
    section: BeamSection,
    *,
    E: float,
    G: float,
    rho: float,
    shear: bool,
    rotary_inertia: bool = True,
    shear_in_mass: bool = False,
) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of a uniform beam whose planes of bending differ, (12, 12) in global axes.

    Parameters
    ----------
    axes : (3, 3) rows: along the beam, then the section's x and y
    rotary_inertia, shear_in_mass : bool
        SubDyn's beams, the default, have the one in their mass and not the other.
    """

    def plane(I: float, A_shear: float, J: float, *, sheared: bool) -> beam.BeamProperties:  # noqa: E741
        Phi = 12.0 * E * I / (G * A_shear * L**2) if sheared else 0.0
        values = (E, G, rho, section.A, I, J, L, Phi)
        return beam.BeamProperties(*(np.array([value]) for value in values))

    # bending in the plane of x is about y, and the other way round
    both = (section.I_y, section.A_x), (section.I_x, section.A_y)
    K = _merged(*(beam.stiffness(plane(*one, section.J, sheared=shear))[0] for one in both))
    sheared = shear and shear_in_mass
    M = _merged(
        *(
            beam.mass(plane(*one, section.I_p, sheared=sheared), rotary_inertia=rotary_inertia)[0]
            for one in both
        )
    )
    K_global, M_global = (beam.to_global(matrix[None], axes[None])[0] for matrix in (K, M))
    return K_global, M_global


def _merged(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the first matrix with the x-z plane of the second."""
    merged = first.copy()
    at = np.ix_(beam.BENDING_XZ, beam.BENDING_XZ)
    merged[at] = second[at]
    return merged
