"""Exact stepping of a small linear model, internal variables included."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.linalg import expm

from jackettwin.response.state import maxwell_branches, state_matrix
from jackettwin.response.system import Pencil

FloatArray = npt.NDArray[np.float64]


def free_decay(pencil: Pencil, x0: FloatArray, *, step_s: float, n_steps: int) -> FloatArray:
    """Return displacements (n_steps + 1, n) after release from rest at ``x0``, dashpots relaxed there.

    The state steps by the matrix exponential: exact for any step.
    """
    A = state_matrix(pencil)
    state = np.zeros(A.shape[0])
    state[: pencil.n] = x0
    state[2 * pencil.n :] = np.concatenate([np.empty(0), *(x0[b.dofs] for b in maxwell_branches(pencil))])
    return _march(expm(A * step_s), np.zeros_like(state), state, pencil.n, n_steps)


def step_response(pencil: Pencil, force: FloatArray, *, step_s: float, n_steps: int) -> FloatArray:
    """Return displacements (n_steps + 1, n) under a constant force applied at t = 0 to the model at rest."""
    A = state_matrix(pencil)
    size = A.shape[0]
    augmented = np.zeros((size + 1, size + 1))
    augmented[:size, :size] = A
    augmented[pencil.n : 2 * pencil.n, size] = np.linalg.solve(pencil.M, force)
    exact = expm(augmented * step_s)
    return _march(exact[:size, :size], exact[:size, size], np.zeros(size), pencil.n, n_steps)


def _march(A: FloatArray, b: FloatArray, state: FloatArray, n: int, n_steps: int) -> FloatArray:
    out = np.empty((n_steps + 1, n))
    out[0] = state[:n]
    for k in range(n_steps):
        state = A @ state + b
        out[k + 1] = state[:n]
    return out
