r"""First-order uncertainty of SSI-cov poles and shapes at every model order, without Kronecker products.

Poles depend on the column space of the observability matrix only, so of its perturbation only the part
outside that space matters (first-order perturbation of a singular subspace):

.. math:: \delta O = U_K D\,\Sigma_1^{1/2}, \quad
   D_{kj} = \frac{\sigma_j\, u_k^T \Delta H v_j + \sigma_k\, v_k^T \Delta H^T u_j}{\sigma_j^2-\sigma_k^2},
   \quad j \le n < k

and with :math:`A = (O^\uparrow)^\dagger O^\downarrow`, :math:`A\psi = \mu\psi`

.. math:: \delta A\,\psi = (O^\uparrow)^\dagger(\delta O^\downarrow - \mu\,\delta O^\uparrow)\psi
   + (O^{\uparrow T} O^\uparrow)^{-1}\delta O^{\uparrow T}(O^\downarrow - \mu O^\uparrow)\psi.

This is the propagation of Döhler & Mevel 2013 (their Algorithm 2), regrouped: the products with ΔH are
formed once for all orders.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import linalg

from jackettwin.errors import InputError
from jackettwin.identification.mac import normalised
from jackettwin.identification.ssi_cov import OrderPoles, Subspace, hankel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Propagation:
    """Everything about the perturbed factorisation that all model orders share."""

    subspace: Subspace
    left: FloatArray
    """U, (n_rows, n_rows)."""
    columns: FloatArray
    """(n_rows, n_blocks, n_max): Uᵀ ΔH V₁."""
    rows: FloatArray
    """(n_rows, n_blocks, n_max): (U₁ᵀ ΔH V)ᵀ, zero-padded to n_rows."""
    squares: tuple[FloatArray, FloatArray]
    """σ_j (n_max,) and σ_k (n_rows,), zero-padded."""
    low: FloatArray
    """Qᵀ U↓, (n_max, n_rows)."""
    up: FloatArray
    """Qᵀ U↑, (n_max, n_rows)."""
    residual_low: FloatArray
    """U↑ᵀ O↓, (n_rows, n_max)."""
    residual_up: FloatArray
    """U↑ᵀ O↑, (n_rows, n_max)."""


def block_deviations(blocks: FloatArray, block_rows: int) -> Iterable[FloatArray]:
    """Yield ΔH_b such that Σ vec ΔH_b vec ΔH_bᵀ is the covariance of the mean Hankel matrix.

    Parameters
    ----------
    blocks : (n_blocks, n_lags + 1, n_channels, n_channels)
        From ``block_covariances``.
    """
    n_blocks = len(blocks)
    mean = blocks.mean(axis=0)
    for block in blocks:
        yield hankel((block - mean) / np.sqrt(n_blocks * (n_blocks - 1.0)), block_rows)


def stacked_hankel(
    y: FloatArray, block_rows: int, n_blocks: int
) -> tuple[FloatArray, Callable[[], Iterable[FloatArray]]]:
    """Return the Hankel matrix by stacked data and a source of its block deviations.

    The estimator of pyOMA2's ``cov`` (Döhler & Mevel 2013, §3.2): every block of a segment averages
    over the same instants. For comparison; gaps are not allowed.

    Parameters
    ----------
    y : (n_channels, n_samples)
    """
    n_channels, n_samples = y.shape
    length = n_samples - 2 * block_rows + 1
    if length < n_blocks:
        raise InputError(
            "record too short for its blocks",
            field="blocks",
            value=n_blocks,
            allowed=f"≤ {max(length, 0)}",
            remedy="use a longer record or fewer blocks",
        )

    def products(start: int, stop: int) -> FloatArray:
        future = [y[:, block_rows + i + start : block_rows + i + stop] for i in range(block_rows)]
        past = [y[:, block_rows - 1 - j + start : block_rows - 1 - j + stop] for j in range(block_rows)]
        return np.asarray(np.vstack(future) @ np.vstack(past).T / (stop - start))

    whole = products(0, length)

    def deviations() -> Iterable[FloatArray]:
        size = length // n_blocks
        for b in range(n_blocks):
            yield (products(b * size, (b + 1) * size) - whole) / np.sqrt(n_blocks * (n_blocks - 1.0))

    return whole, deviations


def propagation(subspace: Subspace, deviations: Iterable[FloatArray]) -> Propagation:
    """Form what all orders share. Unit weights and shift structure only."""
    if subspace.basis is None or subspace.factors is None:
        raise InputError(
            "uncertainty needs the shift structure",
            field="state_matrix",
            value="one-lag",
            allowed="shift",
            remedy="set state_matrix to shift",
        )
    u, v = subspace.factors.left, subspace.factors.right
    n_max, n_channels = subspace.observability.shape[1], subspace.n_channels
    n_rows = len(u)
    columns, rows = [], []
    for delta in deviations:
        columns.append(u.T @ (delta @ v[:, :n_max]))
        crossed = v.T @ (delta.T @ u[:, :n_max])
        rows.append(np.pad(crossed[:n_rows], ((0, max(n_rows - len(crossed), 0)), (0, 0))))
    s = subspace.factors.singular_values
    sigma = np.pad(s, (0, n_rows - len(s)))
    q, o = subspace.basis, subspace.observability
    return Propagation(
        subspace=subspace,
        left=u,
        columns=np.stack(columns, axis=1),
        rows=np.stack(rows, axis=1),
        squares=(sigma[:n_max], sigma),
        low=q.T @ u[n_channels:],
        up=q.T @ u[:-n_channels],
        residual_low=u[:-n_channels].T @ o[n_channels:],
        residual_up=u[:-n_channels].T @ o[:-n_channels],
    )


def order_poles_with_uncertainty(
    shared: Propagation,
    orders: Sequence[int],
    keep: Callable[[ComplexArray], BoolArray] | None = None,
    *,
    real: bool = False,
) -> list[OrderPoles]:
    """Return the poles of each order with the deviations of eigenvalues and shapes.

    Parameters
    ----------
    keep : callable, optional
        Which of the eigenvalues (n,) to report; default all of positive frequency.
    real : bool
        Report real eigenvalues between 0 and 1 instead.
    """
    out = []
    for order in orders:
        eigenvalues, vectors = linalg.eig(shared.subspace.state_matrix(order), check_finite=False)
        mu = eigenvalues.real
        chosen = (eigenvalues.imag == 0.0) & (mu > 0.0) & (mu < 1.0) if real else eigenvalues.imag > 0.0
        if keep is not None:
            chosen &= keep(eigenvalues)
        out.append(_one_order(shared, order, eigenvalues, vectors, np.flatnonzero(chosen)))
    return out


def _one_order(
    shared: Propagation,
    n: int,
    eigenvalues: ComplexArray,
    vectors: ComplexArray,
    chosen: npt.NDArray[np.intp],
) -> OrderPoles:
    """Propagate to the chosen poles of order n: ``e = Dψ``, then δAψ, then eigenvalue and shape."""
    subspace = shared.subspace
    n_channels, n_blocks = subspace.n_channels, shared.columns.shape[1]
    raw_shapes = subspace.output_matrix(n) @ vectors
    bare = OrderPoles(n, eigenvalues[chosen], normalised(np.asarray(raw_shapes[:, chosen].T)))
    if not len(chosen):
        return bare
    mu, psi = eigenvalues[chosen], vectors[:, chosen]
    d = _outside(shared, n)
    e = _real_times(d, psi)
    residual = shared.residual_low[n:, :n] @ psi - mu * (shared.residual_up[n:, :n] @ psi)
    t = np.moveaxis(_real_times(d.transpose(1, 2, 0), residual), 1, 0)
    upper = subspace.upper[:n, :n]
    to_modes = np.asarray(np.linalg.inv(upper @ vectors), dtype=complex)
    t = _real_stack_times(np.ascontiguousarray(linalg.inv(upper, check_finite=False).T), t)
    t += _real_stack_times(shared.low[:n, n:], e) - mu * _real_stack_times(shared.up[:n, n:], e)
    modal = _stack_times(to_modes, t)
    index = np.arange(len(chosen))
    gap = mu - eigenvalues[:, None]
    gap[chosen, index] = np.inf
    delta_mu = modal[chosen, :, index].T
    delta_shape = _real_stack_times(shared.left[:n_channels, n:], e)
    delta_shape += _stack_times(np.asarray(raw_shapes, dtype=complex), modal / gap[:, None, :])
    return replace(
        bare,
        eigenvalue_deviations=delta_mu.reshape(n_blocks, -1),
        shape_deviations=_of_normalised(raw_shapes[:, chosen], delta_shape),
    )


def _of_normalised(raw: ComplexArray, delta: ComplexArray) -> ComplexArray:
    """Return the deviations (n_blocks, n_poles, n_channels) of shapes divided by their largest entry."""
    index = np.arange(raw.shape[1])
    largest = np.argmax(np.abs(raw), axis=0)
    top = raw[largest, index]
    at_top = delta[largest, :, index].T
    return np.asarray(((delta - (raw / top)[:, None, :] * at_top) / top).transpose(1, 2, 0))


def _outside(shared: Propagation, n: int) -> FloatArray:
    """Return D Σ₁^{1/2} of order n for every block, (n_rows − n, n_blocks, n)."""
    near, far = shared.squares[0][:n], shared.squares[1][n:, None]
    root = np.sqrt(near) / (near**2 - far**2)
    d = shared.columns[n:, :, :n] * (near * root)[:, None, :]
    d += shared.rows[n:, :, :n] * (far * root)[:, None, :]
    return np.asarray(d)


def _real_times(a: FloatArray, b: ComplexArray) -> ComplexArray:
    """Return a @ b with real a (…, n) and complex b (n, m), as one real product."""
    m = b.shape[1]
    both = a.reshape(-1, a.shape[-1]) @ np.hstack([b.real, b.imag])
    return np.asarray(both[:, :m] + 1j * both[:, m:]).reshape(*a.shape[:-1], m)


def _real_stack_times(a: FloatArray, b: ComplexArray) -> ComplexArray:
    """Return real a (n, k) times complex b (k, n_blocks, n_poles), as one real product."""
    flat = np.ascontiguousarray(b).view(np.float64).reshape(len(b), -1)
    return np.asarray(a @ flat).view(np.complex128).reshape(len(a), *b.shape[1:])


def _stack_times(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """Return a (n, k) times b (k, n_blocks, n_poles), both complex."""
    return np.asarray(a @ b.reshape(len(b), -1)).reshape(len(a), *b.shape[1:])
