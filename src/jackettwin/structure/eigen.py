"""Real modes of Kφ = ω²Mφ."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, NumericalError

Matrix = Any
"""A NumPy array or a SciPy sparse array."""

AT_REST = 1e-4
"""Frequencies below this share of the elastic ones are rigid-body motions, not zero only by rounding."""
_SMALL = 150
"""Matrices up to this size are solved densely: Lanczos iteration needs larger ones."""


def lowest_modes(
    K: Matrix, M: Matrix, number: int, *, shift: float | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest ω [rad/s] and mass-normalised φ of Kφ = ω²Mφ; sparse matrices, M may be singular.

    Parameters
    ----------
    shift : float, optional
        A small negative number: K − shift·M must be definite for free-floating structures too.

    Raises
    ------
    InputError
        If K has a negative eigenvalue.
    NumericalError
        If the iteration does not converge.
    """
    n = int(K.shape[0])
    number = min(number, n)
    sigma = below_zero(K, M) if shift is None else shift
    if n <= max(_SMALL, 3 * number):
        w, x = _dense_modes(dense(K), dense(M), sigma, number)
    else:
        try:
            w, x = spla.eigsh(
                sp.csc_matrix(K),
                k=number,
                M=M,
                sigma=sigma,
                v0=np.random.default_rng(0).standard_normal(n),
                tol=0.0,
            )
        except (spla.ArpackError, RuntimeError) as error:
            raise NumericalError(f"undamped modes did not converge: {error}") from error
    if w.min(initial=0.0) < 1e-3 * sigma:  # rounding of a rigid-body mode is far smaller
        raise _unstable()
    order = np.argsort(w)
    return np.sqrt(np.maximum(w[order], 0.0)), x[:, order]


def refined_modes(
    K: Matrix, M: Matrix, x: FloatArray, number: int, *, shift: float
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest ω [rad/s] and mass-normalised φ from shapes x (n, k) of a similar structure.

    One step of inverse iteration, and Rayleigh and Ritz on the shapes before and after it: where x is off by
    ε, ω² is off by some ε⁴ (Bathe 2014, section 11.6), at a tenth of what :func:`lowest_modes` costs.

    Raises
    ------
    InputError
        If K has a negative eigenvalue among those of the shapes.
    NumericalError
        If M has one.
    """
    moved = definite_factor(K - shift * M).solve(np.asarray(M @ x))
    basis = np.linalg.qr(np.hstack([x, moved]))[0]
    try:
        w, q = la.eigh(basis.T @ (K @ basis), basis.T @ (M @ basis), subset_by_index=[0, number - 1])
    except la.LinAlgError as error:
        raise NumericalError(f"the mass of the structure is not positive: {error}") from error
    if w.min(initial=0.0) < 1e-3 * shift:
        raise _unstable()
    return np.sqrt(np.maximum(w, 0.0)), np.asarray(basis @ q)


def definite_factor(K: Matrix) -> Any:
    """Return the sparse factor of a positive definite matrix, which needs no pivots: its ``solve`` solves.

    Raises
    ------
    NumericalError
        If a pivot is zero.
    """
    try:
        return spla.splu(
            sp.csc_matrix(K),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise NumericalError(f"a motion of the structure meets no stiffness: {error}") from error


def below_zero(K: Matrix, M: Matrix) -> float:
    """Return a shift just below zero, small beside every elastic ω²."""
    return -1e-9 * float(K.diagonal().sum() / M.diagonal().sum())


def _dense_modes(K: FloatArray, M: FloatArray, sigma: float, number: int) -> tuple[FloatArray, FloatArray]:
    """Return (ω², x) of the lowest modes from M x = μ (K − σM) x, μ = 1/(ω² − σ)."""
    try:
        mu, x = la.eigh(M, K - sigma * M, subset_by_index=[M.shape[0] - number, M.shape[0] - 1])
    except la.LinAlgError:
        raise _unstable() from None
    moving = mu > 1e-14 * mu[-1]
    return sigma + 1.0 / mu[moving], x[:, moving] / np.sqrt(mu[moving])


def _unstable() -> InputError:
    return InputError(
        "the structure falls over: its stiffness with the weight on it is not positive",
        field="structure",
        remedy="stiffen the supports or the structure, lower the masses, or leave gravity out",
    )


def dense(matrix: Matrix) -> FloatArray:
    """Return a dense array of a dense or sparse matrix."""
    return np.asarray(matrix) if isinstance(matrix, np.ndarray) else np.asarray(matrix.toarray())
