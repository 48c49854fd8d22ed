"""Undamped and damped modes of the full model, by sparse methods.

Damped modes: the first-order system of the thesis, (7.2) and (7.5), is never formed. Arnoldi iteration
works on its inverse about a small positive real shift σ, where F(σ) is real, symmetric and positive definite
for any passive support. What it found is projected out and it runs again, until nothing is left inside the
disc asked for: that is what finds multiple poles. Each pole, or cluster of nearly equal poles, is then
refined on the non-linear F(λ)x = 0 itself, which keeps their number. A springpot starts from a Prony series
and is refined on its own law.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from scipy.sparse.csgraph import connected_components

from jackettwin.errors import InputError, NumericalError
from jackettwin.response.system import IntArray, Matrix, Pencil, System
from jackettwin.soil.viscoelastic import Prony, Springpot, prony_fit

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
Pair = tuple[complex, ComplexArray]
"""A pole and its shape on the pencil's DOFs."""

_SMALL = 300
"""State vectors shorter than this are solved densely: Arnoldi needs room."""
_REAL = 1e-9
"""A pole with |Im λ| below this share of |λ| is real."""
_AT_REST = 1e-10
"""A pole that a Newton step moves less than this (relative) is found."""
_ROUNDING = 1e-7
"""What rounding may leave in a pole of a finely cut mesh, whose stiffness spans many decades."""
_CLUSTER = 1e-5
"""Poles nearer than this (relative) are refined together, so that none falls on its neighbour."""


@dataclass(frozen=True)
class UndampedModes:
    """Real modes of (K + D(0)) φ = ω² M φ.

    Attributes
    ----------
    omega : (n_modes,) [rad/s], ascending
    shapes : (assembly.n_dof, n_modes) mass-normalised
    """

    omega: FloatArray
    shapes: FloatArray

    @property
    def frequency_hz(self) -> FloatArray:
        """Natural frequencies [Hz]."""
        return self.omega / (2.0 * pi)


@dataclass(frozen=True)
class DampedModes:
    """Complex modes F(λ)x = 0.

    Attributes
    ----------
    eigenvalues : (n_modes,) λ with Im λ > 0 [rad/s], by |λ|
    shapes : (assembly.n_dof, n_modes)
    real_poles : (n_real,) [rad/s], by |λ|
    """

    eigenvalues: ComplexArray
    shapes: ComplexArray
    real_poles: FloatArray

    @property
    def frequency_hz(self) -> FloatArray:
        """|λ|/2π [Hz], thesis (4.17)."""
        return np.abs(self.eigenvalues) / (2.0 * pi)

    @property
    def damping_ratio(self) -> FloatArray:
        """−Re λ/|λ|."""
        return -self.eigenvalues.real / np.abs(self.eigenvalues)


def undamped_modes(system: System, number: int) -> UndampedModes:
    """Return the ``number`` lowest undamped modes, by sparse shift-invert Lanczos.

    Raises
    ------
    InputError
        If the structure is not stable under its own weight.
    NumericalError
        If the iteration does not converge.
    """
    pencil = system.pencil
    w, x = lowest_modes(pencil.static_stiffness(), pencil.M, number, shift=_below_zero(pencil.K, pencil.M))
    return UndampedModes(w, system.expand(x))


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
    sigma = _below_zero(K, M) if shift is None else shift
    if n <= max(_SMALL // 2, 3 * number):
        w, x = _dense_modes(_dense(K), _dense(M), sigma, number)
    else:
        try:
            w, x = spla.eigsh(sp.csc_matrix(K), k=number, M=M, sigma=sigma, v0=_start(n), tol=0.0)
        except (spla.ArpackError, RuntimeError) as error:
            raise NumericalError(f"undamped modes did not converge: {error}") from error
    if w.min(initial=0.0) < 10.0 * sigma:
        raise _unstable()
    order = np.argsort(w)
    return np.sqrt(np.maximum(w[order], 0.0)), x[:, order]


def _below_zero(K: Matrix, M: Matrix) -> float:
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


def damped_modes(system: System, *, below_hz: float) -> DampedModes:
    """Return every pole with |λ|/2π below ``below_hz``: oscillating modes and real poles.

    The real poles of a springpot are a continuum, the law's branch cut; none is listed.

    Raises
    ------
    InputError
        If ``below_hz`` is not positive.
    NumericalError
        If the iteration does not converge or a refined pole does not come to rest.
    """
    if not 0.0 < below_hz < np.inf:
        raise InputError("must be positive", field="below_hz", value=below_hz, allowed="> 0")
    pencil, radius = system.pencil, 2.0 * pi * below_hz
    start = _finite(pencil, below_hz)
    values, vectors = _poles_within(start, radius * (1.0 + _CLUSTER))
    pairs: list[Pair] = []
    for members in _clusters(values):
        pairs += _refined(pencil, values[members], vectors[:, members], exact=start is pencil)
    pairs = sorted((pair for pair in pairs if abs(pair[0]) <= radius), key=lambda pair: abs(pair[0]))
    oscillating = [pair for pair in pairs if pair[0].imag > _REAL * abs(pair[0])]
    shapes = np.array([x for _, x in oscillating], dtype=np.complex128).reshape(-1, pencil.n).T
    return DampedModes(
        np.array([value for value, _ in oscillating], dtype=np.complex128),
        system.expand(shapes),
        np.array([value.real for value, _ in pairs if abs(value.imag) <= _REAL * abs(value)]),
    )


def state_matrix(pencil: Pencil) -> FloatArray:
    """Return the dense state matrix on [q, q̇, y] (thesis (7.2), (7.5)) of a pencil whose laws are all finite.

    The internal variables are displacements, τ ẏ = q − y, so that all states have one unit.

    Raises
    ------
    InputError
        If a law has no finite number of states.
    """
    if not all(isinstance(group.law, Prony) for group in pencil.groups):
        raise InputError(
            "a springpot has no finite state",
            field="law",
            value="springpot",
            allowed="elastic, kelvin-voigt, zener, maxwell, maxwell-3",
            remedy="use the damped modes of the full model, or a maxwell law instead",
        )
    n, branches = pencil.n, maxwell_branches(pencil)
    M, K, C = _dense(pencil.M), _dense(_instant_stiffness(pencil)), _dense(_damping(pencil))
    size = 2 * n + sum(dofs.size for _, _, _, dofs in branches)
    A = np.zeros((size, size))
    A[:n, n : 2 * n] = np.eye(n)
    forces = np.zeros((n, size))
    forces[:, :n], forces[:, n : 2 * n] = -K, -C
    at = 2 * n
    for k, tau, S, dofs in branches:
        here = np.arange(at, at + dofs.size)
        forces[:, here] = k * _dense(S)[:, dofs]
        A[here, dofs], A[here, here] = 1.0 / tau, -1.0 / tau
        at += dofs.size
    A[n : 2 * n] = la.solve(M, forces, assume_a="pos")
    return A


def _finite(pencil: Pencil, below_hz: float) -> Pencil:
    """Return the pencil itself if every law is a Prony series, else one with the springpots fitted."""
    if all(isinstance(group.law, Prony) for group in pencil.groups):
        return pencil
    laws = [
        prony_fit(group.law, 1e-4 * below_hz, 1e3 * below_hz)
        if isinstance(group.law, Springpot)
        else group.law
        for group in pencil.groups
    ]
    return pencil.with_laws(laws)


class Branch(NamedTuple):
    """A Maxwell branch on all the springs of a group: its internal variables live on ``dofs``."""

    k: float
    tau: float
    S: Matrix
    dofs: IntArray


def maxwell_branches(pencil: Pencil) -> list[Branch]:
    """Return every Maxwell branch with a live dashpot, in the order of the state vector."""
    return [
        Branch(k, tau, group.S, group.dofs)
        for group in pencil.groups
        if isinstance(group.law, Prony)
        for k, tau in zip(group.law.k, group.law.tau, strict=True)
        if k > 0.0 and tau > 0.0
    ]


def _instant_stiffness(pencil: Pencil) -> Matrix:
    """Return K + Σ (k0 + Σ k_j) S: the stiffness with all Maxwell dashpots locked."""
    total = pencil.static_stiffness()
    for branch in maxwell_branches(pencil):
        total = total + branch.k * branch.S
    return total


def _damping(pencil: Pencil) -> Matrix:
    total = pencil.rayleigh.alpha * pencil.M + pencil.rayleigh.beta * pencil.K
    for group in pencil.groups:
        if isinstance(group.law, Prony) and group.law.c:
            total = total + group.law.c * group.S
    return total


def _poles_within(pencil: Pencil, radius: float) -> tuple[ComplexArray, ComplexArray]:
    """Return all poles with |λ| ≤ radius and Im λ ≥ 0 and their displacement parts (n, n_poles).

    Of a nearly real pair both are returned: rounding may have made it from two real poles.
    """
    sigma = 0.02 * radius
    inverse, size = _inverse(pencil, sigma)
    Q = np.eye(size) if size <= _SMALL else _invariant_subspace(inverse, sigma, radius, size)
    theta, Y = np.linalg.eig(Q.T @ np.column_stack([inverse.matvec(q) for q in Q.T]))
    keep = _inside(theta, sigma, radius)
    values = (sigma + 1.0 / theta[keep]).astype(np.complex128)
    upper = values.imag >= -_CLUSTER * np.abs(values)
    return values[upper], Q[: pencil.n] @ Y[:, keep][:, upper]


def _inside(theta: ComplexArray, sigma: float, radius: float) -> npt.NDArray[np.bool_]:
    """Tell which eigenvalues θ = 1/(λ − σ) of the inverse belong to |λ| ≤ radius."""
    return np.asarray((np.abs(theta) > 0.0) & (np.abs(1.0 + sigma * theta) <= radius * np.abs(theta)))


def _invariant_subspace(inverse: spla.LinearOperator, sigma: float, radius: float, size: int) -> FloatArray:
    """Return an orthonormal basis of the states of all poles with |λ| ≤ radius.

    Arnoldi from one vector sees one state of a multiple pole. So it runs again beside what is already known,
    from another start, until all it finds lies outside.
    """
    Q, k = np.zeros((size, 0)), 60
    while True:
        known = Q

        def rest(b: FloatArray, known: FloatArray = known) -> FloatArray:
            y = inverse.matvec(b - known @ (known.T @ b))
            return np.asarray(y - known @ (known.T @ y))

        k = min(k, size - Q.shape[1] - 2)
        if k < 1:
            return np.eye(size)
        try:
            theta, x = spla.eigs(
                spla.LinearOperator((size, size), matvec=rest, dtype=np.float64),
                k=k, which="LM", v0=_start(size, Q.shape[1]), ncv=min(size, 2 * k + 20), tol=0.0,
                maxiter=2000,
            )  # fmt: skip
        except (spla.ArpackError, RuntimeError) as error:
            raise NumericalError(f"damped modes did not converge: {error}") from error
        found = _inside(theta, sigma, radius)
        if not found.any():
            return Q
        Q = _extended(Q, x[:, found])
        k = 60 if found.all() else 8


def _extended(Q: FloatArray, x: ComplexArray) -> FloatArray:
    """Return the basis with the real and imaginary parts of ``x`` added, as far as they are independent."""
    parts = np.hstack([x.real, x.imag])
    parts = parts - Q @ (Q.T @ parts)
    u, s, _ = la.svd(parts, full_matrices=False)
    # what is nearly dependent would add noise; the next run finds it cleanly
    new = u[:, s > 1e-6 * s[0]]
    new = new - Q @ (Q.T @ new)
    return np.hstack([Q, np.linalg.qr(new)[0]])


def _inverse(pencil: Pencil, sigma: float) -> tuple[spla.LinearOperator, int]:
    """Return (A − σI)⁻¹ of the state matrix A through one factorisation of F(σ), and its size."""
    branches = maxwell_branches(pencil)
    size = 2 * pencil.n + sum(branch.dofs.size for branch in branches)
    n, M, C = pencil.n, pencil.M, _damping(pencil)
    F = sp.csc_array(pencil.F(sigma))
    lu = _factorised(F.real.copy())

    def solve(b: FloatArray) -> FloatArray:
        bq, bv = b[:n], b[n : 2 * n]
        rhs = -(M @ (bv + sigma * bq)) - C @ bq
        at = 2 * n
        for k, tau, S, dofs in branches:
            spread = np.zeros(n)
            spread[dofs] = b[at : at + dofs.size] * tau / (1.0 + sigma * tau)
            rhs -= k * (S @ spread)
            at += dofs.size
        q = lu.solve(rhs)
        parts = [q, sigma * q + bq]
        at = 2 * n
        for _, tau, _, dofs in branches:
            parts.append((q[dofs] - tau * b[at : at + dofs.size]) / (1.0 + sigma * tau))
            at += dofs.size
        return np.concatenate(parts)

    return spla.LinearOperator((size, size), matvec=solve, dtype=np.float64), size


def _clusters(values: ComplexArray) -> list[IntArray]:
    """Return groups of poles that lie too close to be refined one by one."""
    near = np.abs(values[:, None] - values) <= _CLUSTER * np.abs(values)
    n_groups, group = connected_components(near.astype(float), directed=False)
    return [np.flatnonzero(group == g) for g in range(n_groups)]


def _refined(pencil: Pencil, values: ComplexArray, x: ComplexArray, *, exact: bool) -> list[Pair]:
    """Return the poles of one cluster on the pencil itself; ``exact`` if the starts come from its own laws.

    Raises
    ------
    NumericalError
        If a pole of the pencil does not come to rest where Arnoldi found it.
    """
    if not values.imag.any():  # real poles are as exact as Arnoldi made them; the start law's are none
        return [(complex(v), y) for v, y in zip(values, x.T, strict=True)] if exact else []
    found, y, at_rest = _newton(pencil, values, x)
    moved = np.abs(found.mean() - values.mean()) > (1e-6 if exact else 0.1) * np.abs(values.mean())
    if at_rest and not moved:
        return list(zip(map(complex, found), y.T, strict=True))
    if exact:
        raise NumericalError(f"the pole near λ = {values.mean():.6g} rad/s could not be refined")
    return []  # an artefact of the start law near the branch cut


def _newton(
    pencil: Pencil, values: ComplexArray, x: ComplexArray, steps: int = 20
) -> tuple[ComplexArray, ComplexArray, bool]:
    r"""Refine a cluster of poles together: inverse iteration and Rayleigh–Ritz on F(λ) about their mean.

    With one pole this is Newton's method; F is symmetric, so that
    :math:`δ = -u^T F u / u^T F' u` with :math:`u = F^{-1} F' x` converges cubically.
    """
    last = np.inf
    for _ in range(steps):
        mean = complex(values.mean())
        F, dF = pencil.F(mean), pencil.dF(mean)
        try:
            x = _factorised(F).solve(dF @ x)
        except RuntimeError:  # F is singular to the last digit: the vectors are as good as they get
            pass
        Q = np.linalg.qr(x)[0]
        delta, y = la.eig(-(Q.T @ (F @ Q)), Q.T @ (dF @ Q))
        values, x = mean + delta, Q @ y
        change = abs(values.mean() - mean) / abs(mean)
        if change <= _AT_REST or 0.5 * last <= change <= _ROUNDING:
            break
        last = change
    return values, x / np.linalg.norm(x, axis=0), change <= _ROUNDING


def _factorised(F: sp.csc_array) -> spla.SuperLU:
    """Return the factors of a symmetric matrix: a symmetric order of elimination fills in least."""
    return spla.splu(sp.csc_matrix(F), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.1)


def _dense(matrix: sp.csc_array | FloatArray) -> FloatArray:
    return np.asarray(matrix.toarray() if sp.issparse(matrix) else matrix)


def _start(n: int, seed: int = 0) -> FloatArray:
    """Return a fixed start vector with something of every mode in it."""
    return np.random.default_rng(seed).standard_normal(n)
