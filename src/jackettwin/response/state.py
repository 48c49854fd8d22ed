"""The first-order form ẋ = Ax of a system whose laws have a finite number of states."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.response.system import Matrix, Pencil
from jackettwin.structure import dense


class Branch(NamedTuple):
    """A Maxwell branch on all springs of a group, with internal variables on ``dofs``."""

    k: float
    tau: float
    S: Matrix
    dofs: IntArray


def maxwell_branches(pencil: Pencil) -> list[Branch]:
    """Return the Maxwell branches with non-zero stiffness and damping, in the order of the state vector."""
    return [Branch(k, tau, group.S, group.dofs) for group in pencil.groups for k, tau in group.law.branches]


def _instant_stiffness(pencil: Pencil) -> Matrix:
    """Return K + Σ (k0 + Σ k_j) S: the stiffness with all Maxwell dashpots locked."""
    total = pencil.static_stiffness()
    for branch in maxwell_branches(pencil):
        total = total + branch.k * branch.S
    return total


def damping_matrix(pencil: Pencil) -> Matrix:
    """Return C = αM + βK + Σ c S, the matrix of viscous damping."""
    total = pencil.rayleigh.alpha * pencil.M + pencil.rayleigh.beta * pencil.K
    for group in pencil.groups:
        if group.law.dashpot:
            total = total + group.law.dashpot * group.S
    return total


def state_matrix(pencil: Pencil) -> FloatArray:
    """Return the dense state matrix on [q, q̇, y] (thesis (7.2), (7.5)) of a pencil with laws of finite state.

    The internal variables are displacements, τ ẏ = q − y.

    Raises
    ------
    InputError
        If a law has no finite number of states.
    """
    if not all(group.law.is_rational for group in pencil.groups):
        raise InputError(
            "a springpot has no finite number of states",
            field="law",
            value="springpot",
            allowed="a law of springs, dashpots and Maxwell branches",
            remedy="use the damped modes of the full model, or a maxwell law instead",
        )
    n, branches = pencil.n, maxwell_branches(pencil)
    M, K, C = dense(pencil.M), dense(_instant_stiffness(pencil)), dense(damping_matrix(pencil))
    size = 2 * n + sum(dofs.size for _, _, _, dofs in branches)
    A = np.zeros((size, size))
    A[:n, n : 2 * n] = np.eye(n)
    forces = np.zeros((n, size))
    forces[:, :n], forces[:, n : 2 * n] = -K, -C
    at = 2 * n
    for k, tau, S, dofs in branches:
        here = np.arange(at, at + dofs.size)
        forces[:, here] = k * dense(S)[:, dofs]
        A[here, dofs], A[here, here] = 1.0 / tau, -1.0 / tau
        at += dofs.size
    A[n : 2 * n] = la.solve(M, forces, assume_a="pos")
    return A


def shifted_inverse(pencil: Pencil, sigma: float) -> tuple[spla.LinearOperator, int]:
    """Return (A − σI)⁻¹ of the state matrix A through one factorisation of F(σ), and its size."""
    branches = maxwell_branches(pencil)
    size = 2 * pencil.n + sum(branch.dofs.size for branch in branches)
    n, M, C = pencil.n, pencil.M, damping_matrix(pencil)
    F = sp.csc_array(pencil.F(sigma))
    lu = factorised(F.real.copy())

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


def factorised(F: sp.csc_array) -> spla.SuperLU:
    """Return the factors of a symmetric matrix, by a symmetric elimination order with least fill-in."""
    return spla.splu(sp.csc_matrix(F), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.1)
