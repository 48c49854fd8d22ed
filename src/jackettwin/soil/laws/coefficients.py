"""Support laws as rows of coefficients, and D(s) of one or many laws at once.

A row is (k0, c, k_α, α, ω0, m, k_1, τ_1, k_2, τ_2, …):

    D(s) = k0 + c s + m s² + k_α (s/ω0)^α + Σ k_j τ_j s/(1 + τ_j s).

No law has a mass; water that moves with the structure has.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray

K0, C, K_ALPHA, ALPHA, OMEGA0, MASS, BRANCHES = range(7)
"""Places in a row; branches k_1, τ_1, k_2, … follow from BRANCHES on."""


def static_rows(rows: FloatArray) -> FloatArray:
    """Return the rows of springs with the laws' static stiffness, masses kept: the undamped structure.

    The springpot's is Re D(iω0), for D(0) is zero.

    Parameters
    ----------
    rows : (..., width)
    """
    springs = np.zeros_like(rows)
    springs[..., OMEGA0] = 1.0
    springs[..., MASS] = rows[..., MASS]
    springs[..., K0] = rows[..., K0] + rows[..., K_ALPHA] * np.cos(0.5 * np.pi * rows[..., ALPHA])
    return springs


def law_stiffness(rows: FloatArray, s: ComplexArray | complex) -> ComplexArray:
    """Return D(s) [N/m].

    Parameters
    ----------
    rows : (..., width)
    s : of a shape that broadcasts with (...) [rad/s]
    """
    s = np.asarray(s, dtype=np.complex128)
    k0, c, k_alpha, alpha, omega0, m = (rows[..., j] for j in range(BRANCHES))
    D = k0 + c * s + m * s**2
    if np.any(k_alpha):
        D = D + k_alpha * (s / omega0) ** alpha
    for j in range(BRANCHES, rows.shape[-1], 2):
        k, tau = rows[..., j], rows[..., j + 1]
        D = D + k * (tau * s / (1.0 + tau * s))
    return np.asarray(D)


def law_slope(rows: FloatArray, s: ComplexArray | complex) -> ComplexArray:
    """Return dD/ds [N·s/m]; the arguments are those of :func:`law_stiffness`."""
    s = np.asarray(s, dtype=np.complex128)
    c, k_alpha, alpha, omega0, m = (rows[..., j] for j in range(C, BRANCHES))
    slope = c + 2.0 * m * s
    if np.any(k_alpha):
        slope = slope + alpha * k_alpha * (s / omega0) ** alpha / s
    for j in range(BRANCHES, rows.shape[-1], 2):
        k, tau = rows[..., j], rows[..., j + 1]
        slope = slope + k * tau / (1.0 + tau * s) ** 2
    return np.asarray(slope)
