"""Undamped and damped modes of the full model, by sparse methods.

Damped modes: the first-order system of the thesis, (7.2) and (7.5), is never formed. Arnoldi iteration
works on its inverse about a small positive real shift σ, where F(σ) is real, symmetric and positive definite
for any passive support; each eigenpair is then refined on the non-linear F(λ)x = 0 itself. A springpot
starts from a Prony series and is refined on its own law.
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

from jackettwin.errors import NumericalError
from jackettwin.response.system import IntArray, Matrix, Pencil, System
from jackettwin.soil.viscoelastic import Prony, Springpot, prony_fit

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

_SMALL = 300
"""State vectors shorter than this are solved densely: Arnoldi needs room."""
_REAL = 1e-9
"""A pole with |Im λ| below this share of |λ| is real."""


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
    NumericalError
        If the iteration does not converge.
    """
    K, M = system.pencil.static_stiffness(), system.pencil.M
    number = min(number, system.pencil.n)
    if system.pencil.n <= max(_SMALL // 2, 3 * number):
        w, x = la.eigh(K.toarray(), M.toarray(), subset_by_index=[0, number - 1])
    else:
        # a shift just below zero keeps K − σM definite for free-floating structures too
        scale = float(K.diagonal().sum() / M.diagonal().sum())
        try:
            w, x = spla.eigsh(K, k=number, M=M, sigma=-1e-9 * scale, v0=_start(system.pencil.n), tol=0.0)
        except (spla.ArpackError, RuntimeError) as error:
            raise NumericalError(f"undamped modes did not converge: {error}") from error
    order = np.argsort(w)
    return UndampedModes(np.sqrt(np.maximum(w[order], 0.0)), system.expand(x[:, order]))


def damped_modes(system: System, *, below_hz: float) -> DampedModes:
    """Return every pole with |λ|/2π below ``below_hz``: oscillating modes and real poles.

    Raises
    ------
    NumericalError
        If the iteration does not converge or a refined pole fails its residual.
    """
    pencil = system.pencil
    radius = 2.0 * pi * below_hz
    start = _finite(pencil, below_hz)
    values, vectors = _poles_within(start, radius)
    exact = start is pencil
    keep = values.imag > -_REAL * np.abs(values)
    starts = zip(values[keep], vectors[:, keep].T, strict=True)
    pairs = [_refine(pencil, value, x) for value, x in starts if exact or value.imag > 0.0]
    pairs = _distinct([pair for pair in pairs if abs(pair[0]) <= radius])
    oscillating = [p for p in pairs if p[0].imag > _REAL * abs(p[0])]
    real = [p[0].real for p in pairs if abs(p[0].imag) <= _REAL * abs(p[0])] if exact else []
    shapes = np.array([x for _, x in oscillating], dtype=np.complex128).reshape(-1, pencil.n).T
    return DampedModes(
        np.array([v for v, _ in oscillating], dtype=np.complex128),
        system.expand(shapes),
        np.array(sorted(real, key=abs)),
    )


def state_matrix(pencil: Pencil) -> FloatArray:
    """Return the dense state matrix on [q, q̇, y] (thesis (7.2), (7.5)) of a pencil whose laws are all finite.

    The internal variables are displacements, τ ẏ = q − y, so that all states have one unit.
    """
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
        prony_fit(group.law, 1e-4 * below_hz, 1e3 * below_hz, per_decade=3)
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
    """Return all poles with |λ| ≤ radius and their displacement parts (n, n_poles)."""
    n, branches = pencil.n, maxwell_branches(pencil)
    n_internal = sum(dofs.size for _, _, _, dofs in branches)
    size = 2 * n + n_internal
    if size <= _SMALL:
        values, vectors = np.linalg.eig(state_matrix(pencil))
        return values, vectors[:n]
    # two shifts: what one Arnoldi run might miss of a multiple pole, the other finds
    found = [_arnoldi(pencil, branches, shift * radius, radius, size) for shift in (0.02, 0.05)]
    return np.concatenate([v for v, _ in found]), np.concatenate([x for _, x in found], axis=1)


def _arnoldi(
    pencil: Pencil,
    branches: list[Branch],
    sigma: float,
    radius: float,
    size: int,
) -> tuple[ComplexArray, ComplexArray]:
    """Return the poles nearest to σ that fill the disc |λ| ≤ radius."""
    operator = _inverse(pencil, branches, sigma, size)
    k = min(60, size - 2)
    while True:
        try:
            theta, x = spla.eigs(
                operator, k=k, which="LM", v0=_start(size), ncv=min(size, 2 * k + 20), tol=0.0, maxiter=2000
            )
        except (spla.ArpackError, RuntimeError) as error:
            raise NumericalError(f"damped modes did not converge: {error}") from error
        values = sigma + 1.0 / theta
        if np.abs(values - sigma).max() > radius + sigma or k >= size - 2:
            inside = np.abs(values) <= radius
            return values[inside], x[: pencil.n, inside]
        k = min(2 * k, size - 2)


def _inverse(
    pencil: Pencil,
    branches: list[Branch],
    sigma: float,
    size: int,
) -> spla.LinearOperator:
    """Return (A − σI)⁻¹ of the state matrix A through one factorisation of F(σ)."""
    n, M, C = pencil.n, pencil.M, _damping(pencil)
    F = sp.csc_array(pencil.F(sigma))
    lu = spla.splu(sp.csc_matrix((np.ascontiguousarray(F.data.real), F.indices, F.indptr), shape=F.shape))

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

    return spla.LinearOperator((size, size), matvec=solve, dtype=np.float64)


def _refine(pencil: Pencil, value: complex, x: ComplexArray, steps: int = 12) -> tuple[complex, ComplexArray]:
    """Return an eigenpair of F by non-linear inverse iteration (Newton on F(λ)x = 0, wᴴx = 1)."""
    real = abs(value.imag) <= _REAL * abs(value)
    value = complex(value.real, 0.0) if real else value
    x = x / np.linalg.norm(x)
    for _ in range(steps):
        F, dF = pencil.F(value), pencil.dF(value)
        try:
            u = _solve(F, dF @ x)
        except RuntimeError:  # F(λ) is singular to the last digit: λ is exact
            break
        step = 1.0 / np.vdot(x, u)
        value = value - (complex(step.real, 0.0) if real else complex(step))
        x = u / np.linalg.norm(u)
        if abs(step) <= 1e-13 * abs(value):
            break
    return value, x


def _solve(F: sp.csc_array, b: ComplexArray) -> ComplexArray:
    if sp.issparse(F):
        return np.asarray(spla.splu(sp.csc_matrix(F)).solve(b))
    return np.asarray(la.solve(F, b))


def _distinct(pairs: list[tuple[complex, ComplexArray]]) -> list[tuple[complex, ComplexArray]]:
    """Return the pairs by |λ|, one of each: equal poles are kept apart if their vectors are independent."""
    kept: list[tuple[complex, ComplexArray]] = []
    for value, x in sorted(pairs, key=lambda pair: abs(pair[0])):
        same = [y for other, y in kept if abs(other - value) <= 1e-8 * abs(value)]
        if same:
            basis = la.orth(np.array(same).T)
            rest = x - basis @ (basis.conj().T @ x)
            if np.linalg.norm(rest) < 1e-3:
                continue
        kept.append((value, x))
    return kept


def _dense(matrix: sp.csc_array | FloatArray) -> FloatArray:
    return np.asarray(matrix.toarray() if sp.issparse(matrix) else matrix)


def _start(n: int) -> FloatArray:
    """Return a fixed start vector with something of every mode in it."""
    return np.random.default_rng(0).standard_normal(n)
