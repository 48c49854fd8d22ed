"""Covariance-driven stochastic subspace identification: poles at every model order.

One factorisation serves all orders: the observability matrix of order n is the first n columns of
the largest one, and its shift equation is solved with the leading blocks of one QR.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy import linalg
from scipy.linalg import lapack

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.errors import NumericalError
from jackettwin.identification.mode_shapes import normalised

if TYPE_CHECKING:
    from collections.abc import Sequence


LEAST_SQUARE = 1e-9
"""Smallest ratio of squared singular values to the largest for which HᵀH may replace H: poles then agree to
1e-7."""
RANK = 1e-12
"""Singular values below this share of the largest are taken as zero."""

Weighting = Literal["br", "cva"]
StateMatrix = Literal["shift", "one-lag"]


@dataclass(frozen=True)
class Factors:
    """Singular vectors of a Hankel matrix H.

    Left vectors of small singular values are not stored, since they would be inaccurate; the products H v are
    accurate for every right vector v.

    Attributes
    ----------
    left : (n_rows, n_max)
        Leading left singular vectors, in columns.
    right : (n_columns, n_singular)
    images : (n_rows, n_singular)
        H times ``right``: left vectors times singular values.
    singular_values : (n_singular,)
    """

    left: FloatArray
    right: FloatArray
    images: FloatArray
    singular_values: FloatArray


@dataclass(frozen=True)
class Subspace:
    """Observability matrices of all orders up to the largest, and their state matrices.

    Attributes
    ----------
    observability : (n_rows, n_max)
        Column-nested: order n uses the first n columns.
    n_channels : int
    upper, right : (n_max, n_max)
        Upper triangle and right-hand side of the equation for the state matrix; order n uses the leading
        n × n blocks.
    basis : (n_rows − n_channels, n_max) or None
        Orthonormal basis of the observability matrix without its last block row (shift structure only).
    factors : Factors or None
        Of the Hankel matrix with unit weights; needed for the uncertainty.
    """

    observability: FloatArray
    n_channels: int
    upper: FloatArray
    right: FloatArray
    basis: FloatArray | None
    factors: Factors | None

    def state_matrix(self, order: int) -> FloatArray:
        """Return A of the given order, (order, order)."""
        return np.asarray(
            linalg.solve_triangular(
                self.upper[:order, :order], self.right[:order, :order], check_finite=False
            )
        )

    def orders(self, wanted: Sequence[int]) -> list[int]:
        """Return those of the wanted orders that the factorisation has columns for."""
        return [order for order in wanted if order <= self.observability.shape[1]]

    def output_matrix(self, order: int) -> FloatArray:
        """Return C of the given order, (n_channels, order)."""
        return self.observability[: self.n_channels, :order]


@dataclass(frozen=True)
class OrderPoles:
    """Poles of one model order: one of each conjugate pair, positive frequency, stable or not."""

    order: int
    eigenvalues: ComplexArray
    """Of the discrete state matrix, (n_poles,)."""
    shapes: ComplexArray
    """(n_poles, n_channels), 1 at the largest entry."""
    eigenvalue_deviations: ComplexArray | None = None
    """(n_blocks, n_poles): square root of the covariance, Σ over blocks of the products."""
    shape_deviations: ComplexArray | None = None
    """(n_blocks, n_poles, n_channels)."""


def hankel(covariances: FloatArray, block_rows: int, first_lag: int = 1, every: int = 1) -> FloatArray:
    """Return the block Hankel matrix with block (a, b) = R_{first_lag + a + every·b}.

    Thesis eq. (6.4) with its block columns reversed, which changes nothing below. Lag 0, which
    carries the measurement noise, is left out.

    Parameters
    ----------
    covariances : (n_lags + 1, n_channels, n_references)
        Lags 0 … at least ``first_lag + 2·block_rows − 2``.
    every : int
        Spacing of the block columns [samples]. The columns serve as instruments, so that fewer of them,
        spaced more widely, cover the same past.
    """
    _, n_channels, n_references = covariances.shape
    lags = covariances[first_lag : first_lag + 2 * block_rows - 1]
    blocks = np.lib.stride_tricks.sliding_window_view(lags, block_rows, axis=0)[::every]
    size = (block_rows * n_channels, len(blocks) * n_references)
    return np.asarray(blocks.transpose(3, 1, 0, 2).reshape(size))


def ssi_cov(
    covariances: FloatArray,
    *,
    block_rows: int,
    max_order: int,
    weighting: Weighting = "br",
    state_matrix: StateMatrix = "shift",
    factors: bool = True,
    every: int = 1,
) -> Subspace:
    r"""Factorise the covariances once for all model orders.

    .. math:: W_1 H W_2^T = U \Sigma V^T, \quad O = W_1^{-1} U_1 \Sigma_1^{1/2},
              \quad A = (O^\uparrow)^\dagger O^\downarrow

    Thesis eqs. (6.10)–(6.17); Peeters & De Roeck 1999. Weighting ``"br"`` takes unit weights, ``"cva"``
    the inverse Cholesky factors of the covariances of future and past. ``state_matrix="one-lag"``
    takes A from the Hankel matrix shifted by one lag instead of from the shift structure.

    Parameters
    ----------
    covariances : (2·block_rows + 1, n_channels, n_channels)
        Lags 0 … 2·block_rows.
    factors : bool
        Whether the factors needed for the uncertainty are stored; with unit weights and shift structure only.
    every : int
        Spacing of the block columns [samples], with unit weights and shift structure only.
    """
    n_channels = covariances.shape[1]
    if weighting == "br" and state_matrix == "shift":
        h = hankel(covariances, block_rows, every=every)
        return balanced_subspace(h, n_channels, max_order, factors=factors)
    h = hankel(covariances, block_rows)
    w1_inverse, w2_inverse = _weights(covariances, block_rows, weighting)
    u, s, vt = linalg.svd(_divide(h, w1_inverse, w2_inverse), full_matrices=False, check_finite=False)
    n = min(max_order, len(s) - n_channels)
    u1, root = u[:, :n], np.sqrt(s[:n])
    observability = np.asarray(u1 * root if w1_inverse is None else w1_inverse @ (u1 * root))
    if state_matrix == "shift":
        return _shift(observability, n_channels, None)
    shifted = _divide(hankel(covariances, block_rows, 2), w1_inverse, w2_inverse)
    right = np.asarray((u1.T @ shifted @ vt[:n].T) / np.outer(root, root))
    return Subspace(observability, n_channels, np.eye(n), right, None, None)


def balanced_subspace(h: FloatArray, n_channels: int, max_order: int, *, factors: bool = True) -> Subspace:
    """Factorise a Hankel matrix with unit weights and take A from the shift structure.

    The right vectors are those of HᵀH if that is accurate enough (``LEAST_SQUARE``).

    Parameters
    ----------
    factors : bool
        Whether the factors needed for the uncertainty are stored.
    """
    n = min(max_order, min(h.shape) - n_channels)
    first = 0 if factors else max(h.shape[1] - n, 0)
    values, vectors = linalg.eigh(
        h.T @ h, subset_by_index=[first, h.shape[1] - 1] if first else None, check_finite=False
    )
    if values[-n] > LEAST_SQUARE * values[-1]:
        right = vectors[:, ::-1]
    else:
        right = linalg.svd(h, full_matrices=False, check_finite=False)[2].T
    images = h @ right
    s = np.linalg.norm(images, axis=0)
    # the Hankel matrix of noise-free signals is rank-deficient: only non-zero singular values can be divisors
    n = min(n, int(np.sum(s > RANK * s[0])))
    left = images[:, :n] / s[:n]
    kept = Factors(left, right, images, s) if factors else None
    return _shift(np.asarray(left * np.sqrt(s[:n])), n_channels, kept)


def _shift(observability: FloatArray, n_channels: int, factors: Factors | None) -> Subspace:
    q, r = linalg.qr(observability[:-n_channels], mode="economic", check_finite=False)
    right = np.asarray(q.T @ observability[n_channels:])
    return Subspace(observability, n_channels, np.asarray(r), right, np.asarray(q), factors)


def order_poles(subspace: Subspace, orders: Sequence[int]) -> list[OrderPoles]:
    """Return the oscillating poles of each model order and their shapes at the sensors."""
    out = []
    for order in orders:
        eigenvalues, vectors = _oscillating(subspace.state_matrix(order))
        shapes = (subspace.output_matrix(order) @ vectors).T
        out.append(OrderPoles(order, eigenvalues, normalised(np.asarray(shapes))))
    return out


def _oscillating(a: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the eigenvalues of positive imaginary part and their vectors in columns."""
    real, imag, _, vectors, info = lapack.dgeev(a, compute_vl=0, overwrite_a=1)
    if info != 0:
        raise NumericalError(f"eigenvalues of order {len(a)} did not converge")
    k = np.flatnonzero(imag > 0.0)
    # LAPACK stores the vector of a conjugate pair as real and imaginary part in two columns
    return np.asarray(real[k] + 1j * imag[k]), np.asarray(vectors[:, k] + 1j * vectors[:, k + 1])


def frequency_and_damping(eigenvalues: ComplexArray, sample_rate_hz: float) -> tuple[FloatArray, FloatArray]:
    """Return f = |λ|/2π [Hz] and ζ = −Re λ/|λ| of discrete eigenvalues, λ = ln(μ)·sample rate.

    Thesis eqs. (6.21)–(6.22).
    """
    lam = np.log(eigenvalues) * sample_rate_hz
    size = np.abs(lam)
    return size / (2.0 * np.pi), -lam.real / size


def _weights(
    covariances: FloatArray, block_rows: int, weighting: Weighting
) -> tuple[FloatArray | None, FloatArray | None]:
    """Return W1⁻¹ and W2⁻¹, lower triangular (None for unit weights)."""
    if weighting == "br":
        return None, None
    lag = np.subtract.outer(np.arange(block_rows), np.arange(block_rows))
    both_signs = np.where((lag >= 0)[:, :, None, None], covariances[np.abs(lag)], 0.0)
    negative = (lag < 0)[:, :, None, None]
    both_signs = np.where(negative, covariances[np.abs(lag)].swapaxes(2, 3), both_signs)
    size = block_rows * covariances.shape[1]
    future = both_signs.transpose(0, 2, 1, 3).reshape(size, size)
    past = both_signs.swapaxes(0, 1).transpose(0, 2, 1, 3).reshape(size, size)
    return _root(future), _root(past)


def _root(matrix: FloatArray) -> FloatArray:
    """Return the Cholesky factor of a covariance matrix that may be slightly indefinite."""
    lift = 1e-10 * float(np.trace(matrix)) / len(matrix)
    while True:
        try:
            return np.asarray(linalg.cholesky(matrix + lift * np.eye(len(matrix)), lower=True))
        except linalg.LinAlgError:
            lift *= 10.0


def _divide(h: FloatArray, w1_inverse: FloatArray | None, w2_inverse: FloatArray | None) -> FloatArray:
    if w1_inverse is None or w2_inverse is None:
        return h
    left = linalg.solve_triangular(w1_inverse, h, lower=True)
    return np.asarray(linalg.solve_triangular(w2_inverse, left.T, lower=True).T)
