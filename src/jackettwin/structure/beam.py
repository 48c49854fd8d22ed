r"""Two-node beam element in space: thesis appendix A (11.1)–(11.2), many elements at once.

Local DOFs: :math:`[u, v, w, θ_x, θ_y, θ_z]` at each end, x along the element. With
:math:`Φ = 12EI/(κGAL²)` the same matrices serve both theories: Φ = 0 is Euler–Bernoulli (the thesis's),
Φ > 0 is Timoshenko (Przemieniecki 1968, section 5.6; mass of Friedman & Kosmatka 1993, eqs. (30)–(33)).
(11.1) misprints the sign of entry (3, 11); (3.16) is singular for vertical members: another reference
axis is used there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray

AXIAL = (0, 6)
TORSION = (3, 9)
BENDING_XY = (1, 5, 7, 11)
BENDING_XZ = (2, 4, 8, 10)
# θ_y = −dw/dx: bending in the x-z plane is that in the x-y plane with the rotations reversed.
_REVERSED = np.array([1.0, -1.0, 1.0, -1.0])


@dataclass(frozen=True)
class BeamProperties:
    """Properties of ``n_elements`` elements, each array (n_elements,); SI units."""

    E: FloatArray
    G: FloatArray
    rho: FloatArray
    A: FloatArray
    I: FloatArray  # noqa: E741 - the paper's symbol
    J: FloatArray
    L: FloatArray
    Phi: FloatArray
    """12EI/(κGAL²), zero for Euler–Bernoulli."""


def stiffness(p: BeamProperties) -> FloatArray:
    """Return local stiffness matrices (11.1), shape (n_elements, 12, 12)."""
    K = np.zeros((p.L.size, 12, 12))
    _put(K, AXIAL, (p.E * p.A / p.L)[:, None, None] * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    _put(K, TORSION, (p.G * p.J / p.L)[:, None, None] * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    L, Phi, zero = p.L, p.Phi, np.zeros_like(p.L)
    plane = _symmetric(
        [
            [12.0 + zero, 6.0 * L, -12.0 + zero, 6.0 * L],
            [(4.0 + Phi) * L**2, -6.0 * L, (2.0 - Phi) * L**2],
            [12.0 + zero, -6.0 * L],
            [(4.0 + Phi) * L**2],
        ]
    )
    _put_bending(K, (p.E * p.I / (L**3 * (1.0 + Phi)))[:, None, None] * plane)
    return K


def mass(p: BeamProperties, *, rotary_inertia: bool = False) -> FloatArray:
    """Return local consistent mass matrices (11.2), shape (n_elements, 12, 12).

    ``rotary_inertia`` adds the ρI terms that Euler–Bernoulli theory leaves out.
    """
    M = np.zeros((p.L.size, 12, 12))
    pair = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
    _put(M, AXIAL, (p.rho * p.A * p.L)[:, None, None] * pair)
    _put(M, TORSION, (p.rho * p.J * p.L)[:, None, None] * pair)
    L, F = p.L, p.Phi
    translation = _symmetric(
        [
            [
                70 * F**2 + 147 * F + 78, (35 * F**2 + 77 * F + 44) * L / 4,
                35 * F**2 + 63 * F + 27, -(35 * F**2 + 63 * F + 26) * L / 4,
            ],
            [
                (7 * F**2 + 14 * F + 8) * L**2 / 4, (35 * F**2 + 63 * F + 26) * L / 4,
                -(7 * F**2 + 14 * F + 6) * L**2 / 4,
            ],
            [70 * F**2 + 147 * F + 78, -(35 * F**2 + 77 * F + 44) * L / 4],
            [(7 * F**2 + 14 * F + 8) * L**2 / 4],
        ]
    )  # fmt: skip
    _put_bending(M, (p.rho * p.A * L / (210.0 * (1.0 + F) ** 2))[:, None, None] * translation)
    if rotary_inertia:
        zero = np.zeros_like(L)
        rotation = _symmetric(
            [
                [36.0 + zero, (3.0 - 15.0 * F) * L, -36.0 + zero, (3.0 - 15.0 * F) * L],
                [(10 * F**2 + 5 * F + 4) * L**2, (15.0 * F - 3.0) * L, (5 * F**2 - 5 * F - 1) * L**2],
                [36.0 + zero, (15.0 * F - 3.0) * L],
                [(10 * F**2 + 5 * F + 4) * L**2],
            ]
        )
        _put_bending(M, (p.rho * p.I / (30.0 * (1.0 + F) ** 2 * L))[:, None, None] * rotation)
    return M


def geometric_stiffness(N: FloatArray, p: BeamProperties) -> FloatArray:
    """Return the stiffness that an axial force adds (tension positive), shape (n_elements, 12, 12).

    Cubic shape functions and the torsion term N·J/A (Przemieniecki 1968, eq. (15.34)).

    Parameters
    ----------
    N : (n_elements,) axial force [N]
    """
    K = np.zeros((p.L.size, 12, 12))
    L, zero = p.L, np.zeros_like(p.L)
    plane = _symmetric(
        [
            [36.0 + zero, 3.0 * L, -36.0 + zero, 3.0 * L],
            [4.0 * L**2, -3.0 * L, -(L**2)],
            [36.0 + zero, -3.0 * L],
            [4.0 * L**2],
        ]
    )
    _put_bending(K, (N / (30.0 * L))[:, None, None] * plane)
    _put(K, TORSION, (N * p.J / (p.A * L))[:, None, None] * np.array([[1.0, -1.0], [-1.0, 1.0]]))
    return K


def translation_shape(xi: FloatArray | float, L: FloatArray | float, Phi: float = 0.0) -> FloatArray:
    """Return (..., 3, 12): the local translation at ``xi`` = x/L (...,) from the end displacements."""
    N = np.zeros((*np.shape(xi), 3, 12))
    N[..., 0, 0], N[..., 0, 6] = 1.0 - xi, xi
    first = (1.0 - 3.0 * xi**2 + 2.0 * xi**3 + Phi * (1.0 - xi)) / (1.0 + Phi)
    slope_1 = L * (xi - 2.0 * xi**2 + xi**3 + 0.5 * Phi * (xi - xi**2)) / (1.0 + Phi)
    slope_2 = L * (-(xi**2) + xi**3 - 0.5 * Phi * (xi - xi**2)) / (1.0 + Phi)
    plane = np.stack([first, slope_1, 1.0 - first, slope_2], axis=-1)
    N[..., 1, BENDING_XY] = plane
    N[..., 2, BENDING_XZ] = plane * _REVERSED
    return N


def rotation_shape(xi: float, L: float, Phi: float = 0.0) -> FloatArray:
    """Return (3, 12): the local rotation of the section at ``xi`` = x/L from the end displacements."""
    N = np.zeros((3, 12))
    N[0, [3, 9]] = 1.0 - xi, xi
    sway = 6.0 * (xi**2 - xi) / L
    first = 1.0 - 4.0 * xi + 3.0 * xi**2 + Phi * (1.0 - xi)
    second = -2.0 * xi + 3.0 * xi**2 + Phi * xi
    plane = np.array([sway, first, -sway, second]) / (1.0 + Phi)
    N[2, BENDING_XY] = plane
    N[1, BENDING_XZ] = -plane * _REVERSED
    return N


def strain_shape(xi: float, L: float, y: float, z: float, Phi: float = 0.0) -> FloatArray:
    """Return (12,): the axial strain at ``xi`` = x/L and the point (y, z) of the section, u' − y θz' + z θy'.

    The curvatures are the derivatives of :func:`rotation_shape`.
    """
    B = np.zeros(12)
    B[[0, 6]] = -1.0 / L, 1.0 / L
    sway = 6.0 * (2.0 * xi - 1.0) / L
    plane = np.array([sway, -4.0 + 6.0 * xi - Phi, -sway, -2.0 + 6.0 * xi + Phi]) / (L * (1.0 + Phi))
    B[list(BENDING_XY)] = -y * plane
    B[list(BENDING_XZ)] = -z * plane * _REVERSED
    return B


def axial_force(p: BeamProperties, R: FloatArray, u: FloatArray) -> FloatArray:
    """Return the mean axial force [N] of each element from its end displacements.

    Parameters
    ----------
    R : (n_elements, 3, 3) local axes in rows
    u : (n_elements, 12) end displacements in global axes [m, rad]
    """
    extension = np.einsum("ei,ei->e", R[:, 0], u[:, 6:9] - u[:, :3])
    force: FloatArray = p.E * p.A / p.L * extension
    return force


def local_axes(start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the local axes as rows of (n_elements, 3, 3) rotation matrices, x' along the element.

    y' is horizontal; for members within 0.6° of the vertical the reference is the global x axis.
    """
    x = end - start
    x = x / np.linalg.norm(x, axis=1, keepdims=True)
    vertical = np.hypot(x[:, 0], x[:, 1]) < 1e-2
    reference = np.where(vertical[:, None], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0])
    y = np.cross(reference, x)
    y = y / np.linalg.norm(y, axis=1, keepdims=True)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def to_global(matrices: FloatArray, R: FloatArray) -> FloatArray:
    """Return TᵀKT with T = diag(R, R, R, R), thesis (3.17); shapes (n_elements, 12, 12)."""
    T = np.zeros((R.shape[0], 12, 12))
    for block in range(0, 12, 3):
        T[:, block : block + 3, block : block + 3] = R
    return np.asarray(np.swapaxes(T, 1, 2) @ matrices @ T)


def _put(target: FloatArray, dofs: tuple[int, ...], block: FloatArray) -> None:
    target[np.ix_(np.arange(target.shape[0]), np.array(dofs), np.array(dofs))] += block


def _put_bending(target: FloatArray, plane: FloatArray) -> None:
    _put(target, BENDING_XY, plane)
    _put(target, BENDING_XZ, plane * np.outer(_REVERSED, _REVERSED))


def _symmetric(upper: list[list[FloatArray]]) -> FloatArray:
    """Return (n_elements, n, n) symmetric matrices from the rows of their upper triangle."""
    n = len(upper)
    full = np.empty((upper[0][0].size, n, n))
    for i, row in enumerate(upper):
        for j, entry in enumerate(row, start=i):
            full[:, i, j] = full[:, j, i] = entry
    return full
