r"""First-order uncertainty of SSI-cov poles and shapes at every model order, without Kronecker products.

Poles depend only on the column space of the observability matrix. To first order only the part of its
perturbation outside that space matters (perturbation of a singular subspace):

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
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import linalg

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.identification.mode_shapes import normalised
from jackettwin.identification.subspace.ssi_cov import Factors, OrderPoles, Subspace, hankel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


@dataclass(frozen=True)
class Propagation:
    """The part of the perturbed factorisation that is common to all model orders.

    Perturbations are only needed multiplied with O↓ᵀ and Qᵀ (on U↑), with Qᵀ (on U↓) and with the selection
    of the first block row. These 3 n_max + n_channels rows are called *tests*.

    Attributes
    ----------
    inside : (n_max, n_blocks, n_max)
        D Σ₁^½ along the leading left vectors; order n uses the rows from n on and the first n columns.
    seen : (3 n_max + n_channels, n_max)
        The tests on the leading left vectors.
    beyond : (3 n_max + n_channels, n_blocks, n_max)
        The tests on U D Σ₁^½ outside the leading left vectors.
    """

    subspace: Subspace
    inside: FloatArray
    seen: FloatArray
    beyond: FloatArray


def block_deviations(blocks: FloatArray, block_rows: int, every: int = 1) -> Iterable[FloatArray]:
    """Yield ΔH_b such that Σ vec ΔH_b vec ΔH_bᵀ is the covariance of the mean Hankel matrix.

    Parameters
    ----------
    blocks : (n_blocks, n_lags + 1, n_channels, n_channels)
        From ``block_covariances``.
    every : int
        As in ``hankel``.
    """
    n_blocks = len(blocks)
    mean = blocks.mean(axis=0)
    for block in blocks:
        yield hankel((block - mean) / np.sqrt(n_blocks * (n_blocks - 1.0)), block_rows, every=every)


def propagation(
    subspace: Subspace, deviations: Iterable[FloatArray], precision: type[np.floating[Any]] = np.float64
) -> Propagation:
    """Return the part common to all orders; for unit weights and the shift structure only.

    Parameters
    ----------
    precision : numpy.float64 or numpy.float32
        Precision of the products with ΔH. Since a standard deviation from thirty blocks has an error of 13 %,
        single precision suffices and halves the work.

    Raises
    ------
    InputError
        If the subspace was computed without the factors.
    """
    if subspace.basis is None or subspace.factors is None:
        raise InputError(
            "uncertainty needs unit weights and the shift structure",
            field="state_matrix",
            value="one-lag",
            allowed="shift",
            remedy="set state_matrix to shift and weighting to br",
        )
    multiply = _Multiplied.of(subspace, subspace.factors, subspace.basis, precision)
    pairs = [multiply.parts(delta.astype(precision, copy=False)) for delta in deviations]
    inside, beyond = (np.stack(parts, axis=1) for parts in zip(*pairs, strict=True))
    return Propagation(subspace, inside, multiply.on_leading, beyond)


@dataclass(frozen=True)
class _Multiplied:
    r"""The matrices with which every ΔH is multiplied.

    With the images :math:`h_k = H v_k = \sigma_k u_k` of the directions beyond the leading ones

    .. math:: \sum_k u_k D_{kj} = \frac{(I - U_1 U_1^T)\,\Delta H v_j}{\sigma_j}
       + \sum_k h_k \frac{h_k^T \Delta H v_j/\sigma_j + v_k^T \Delta H^T u_j}{\sigma_j^2-\sigma_k^2},

    which needs no left vector of a small singular value.

    Attributes
    ----------
    rows : (3 n_max + n_channels + n_max + n_others, n_rows)
        The tests, the leading left vectors and the images of the others.
    left, right : the leading vectors in columns
    others : (n_columns, n_others), right vectors
    on_leading, on_others : the tests on the leading left vectors and on the images
    s : (n_singular,)
    """

    rows: FloatArray
    left: FloatArray
    right: FloatArray
    others: FloatArray
    on_leading: FloatArray
    on_others: FloatArray
    s: FloatArray

    @classmethod
    def of(
        cls, subspace: Subspace, factors: Factors, basis: FloatArray, precision: type[np.floating[Any]]
    ) -> _Multiplied:
        """Return the factors of a subspace in one precision."""
        u, n, width = factors.left, factors.left.shape[1], subspace.n_channels
        tests = np.zeros((3 * n + width, len(u)))
        tests[:n, :-width] = subspace.observability[width:].T
        tests[n : 2 * n, :-width] = tests[2 * n : 3 * n, width:] = basis.T
        tests[3 * n :, :width] = np.eye(width)
        images = factors.images[:, n:]
        parts = (
            np.vstack([tests, u.T, images.T]),
            u,
            factors.right[:, :n],
            factors.right[:, n:],
            tests @ u,
            tests @ images,
            factors.singular_values,
        )
        return cls(*(part.astype(precision) for part in parts))

    def parts(self, delta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ``inside`` and ``beyond`` of one deviation, (n_max, n_max) and (n_tests, n_max)."""
        n, n_tests = self.left.shape[1], len(self.on_leading)
        near, far = self.s[:n], self.s[:, None]
        root = np.sqrt(near)
        beyond = np.arange(len(self.s))[:, None] > np.arange(n)
        weight = root / np.where(beyond, (near - far) * (near + far), np.inf)
        moved = delta @ self.right
        tested, leading, others = np.split(self.rows @ moved, [n_tests, n_tests + n])
        turned = self.others.T @ (delta.T @ self.left)
        inside = (leading * near + leading.T * far[:n]) * weight[:n]
        outside = (tested - self.on_leading @ leading) / root
        return inside, outside + self.on_others @ ((others / near + turned) * weight[n:])


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
        Selects the eigenvalues (n,) to report; by default all of positive frequency.
    real : bool
        Report real eigenvalues between 0 and 1 instead.
    """
    out, sums = [], _Sums(len(shared.inside), shared.beyond.copy())
    for order in sorted(orders, reverse=True):
        eigenvalues, vectors = linalg.eig(shared.subspace.state_matrix(order), check_finite=False)
        mu = eigenvalues.real
        chosen = (eigenvalues.imag == 0.0) & (mu > 0.0) & (mu < 1.0) if real else eigenvalues.imag > 0.0
        if keep is not None:
            chosen &= keep(eigenvalues)
        sums.reach(shared, order)
        out.append(_one_order(shared.subspace, sums.tested, eigenvalues, vectors, np.flatnonzero(chosen)))
    return out[::-1]


@dataclass
class _Sums:
    """The tests on U D Σ₁^½ summed over the rows of D from one order on; lower orders add further rows.

    Attributes
    ----------
    first : int
        First row of D that is included.
    tested : (3 n_max + n_channels, n_blocks, n_max)
    """

    first: int
    tested: FloatArray

    def reach(self, shared: Propagation, order: int) -> None:
        """Add the rows of D down to an order."""
        if order < self.first:
            added = slice(order, self.first)
            inside = shared.inside[added].reshape(self.first - order, -1)
            self.tested += (shared.seen[:, added] @ inside).reshape(self.tested.shape)
            self.first = order


def _one_order(
    subspace: Subspace, tested: FloatArray, eigenvalues: ComplexArray, vectors: ComplexArray, chosen: IntArray
) -> OrderPoles:
    """Propagate to the chosen poles of an order: δOψ, then δAψ, then eigenvalue and shape."""
    n, n_max = len(eigenvalues), tested.shape[2]
    raw_shapes = subspace.output_matrix(n) @ vectors
    bare = OrderPoles(n, eigenvalues[chosen], normalised(np.asarray(raw_shapes[:, chosen].T)))
    if not len(chosen):
        return bare
    mu, psi, upper = eigenvalues[chosen], vectors[:, chosen], subspace.upper[:n, :n]
    # (O↓ − μO↑)ψ = O↓ψ − μQRψ: the tests of O↓ᵀ and of Qᵀ on the upper part
    residual = np.vstack([psi, -mu * (upper @ psi)])
    rows = np.r_[0:n, n_max : n_max + n, 2 * n_max : 2 * n_max + n, 3 * n_max : len(tested)]
    own = tested[rows, :, :n]
    turned = _complex_product(own[: 2 * n].reshape(2 * n, -1).T, residual)
    turned = turned.reshape(-1, n, len(chosen)).transpose(1, 0, 2)
    seen = _complex_product(own[n:], psi)
    t = _stack_times(np.asarray(linalg.inv(upper, check_finite=False).T), turned)
    t += seen[n : 2 * n] - mu * seen[:n]
    modal = _stack_times(np.asarray(np.linalg.inv(upper @ vectors)), t)
    index = np.arange(len(chosen))
    gap = mu - eigenvalues[:, None]
    gap[chosen, index] = np.inf
    delta_mu = modal[chosen, :, index].T
    delta_shape = seen[2 * n :] + _stack_times(np.asarray(raw_shapes), modal / gap[:, None, :])
    return replace(
        bare,
        eigenvalue_deviations=delta_mu,
        shape_deviations=_of_normalised(raw_shapes[:, chosen], delta_shape),
    )


def _of_normalised(raw: ComplexArray, delta: ComplexArray) -> ComplexArray:
    """Return the deviations (n_blocks, n_poles, n_channels) of shapes divided by their largest entry."""
    index = np.arange(raw.shape[1])
    largest = np.argmax(np.abs(raw), axis=0)
    top = raw[largest, index]
    at_top = delta[largest, :, index].T
    return np.asarray(((delta - (raw / top)[:, None, :] * at_top) / top).transpose(1, 2, 0))


def _complex_product(a: FloatArray, b: ComplexArray) -> ComplexArray:
    """Return real a (…, n) times complex b (n, m): one real product, in the precision of a."""
    both = np.ascontiguousarray(a) @ np.hstack([b.real, b.imag]).astype(a.dtype, copy=False)
    m = b.shape[1]
    return np.asarray(both[..., :m] + 1j * both[..., m:], dtype=complex)


def _stack_times(a: ComplexArray | FloatArray, b: ComplexArray) -> ComplexArray:
    """Return a (n, k) times b (k, n_blocks, n_poles)."""
    return np.asarray(a @ b.reshape(len(b), -1)).reshape(len(a), *b.shape[1:])
