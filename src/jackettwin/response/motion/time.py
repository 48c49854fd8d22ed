r"""Exact time stepping of a linear model with internal variables, for loads linear between samples.

The state :math:`x = [q, \dot q, y]` follows :math:`\dot x = A x + B f`. With f linear within a step h,

.. math:: x_{k+1} = e^{Ah} x_k + P_0 f_k + P_1 f_{k+1}

holds exactly (first-order hold; Franklin, Powell & Workman 1998, section 6.3.2), without numerical damping
and for any h, however stiff the dashpots. Forces that depend on the motion enter as a feedback g(t, x),
evaluated at both ends of each step with second-order accuracy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
from numba import njit

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError, require
from jackettwin.response.state import maxwell_branches, state_matrix
from jackettwin.response.system import Pencil
from jackettwin.structure import dense

Feedback = Callable[[int, FloatArray], FloatArray]
"""Force (m_g,) at step k in state x."""


@dataclass(frozen=True)
class StateSpace:
    """ẋ = Ax + Bf with displacements first, then velocities, then internal variables.

    Attributes
    ----------
    A : (n_states, n_states)
    B : (n_states, n) states from forces on the ``n`` coordinates
    """

    A: FloatArray
    B: FloatArray

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return int(self.B.shape[1])


@dataclass(frozen=True)
class Hold:
    """x_{k+1} = E x_k + P0 f_k + P1 f_{k+1}."""

    E: FloatArray
    P0: FloatArray
    P1: FloatArray


def state_space(pencil: Pencil) -> StateSpace:
    """Return the first-order form of a pencil whose laws have a finite number of states.

    Raises
    ------
    InputError
        If a law is a springpot.
    """
    A = state_matrix(pencil)
    B = np.zeros((A.shape[0], pencil.n))
    B[pencil.n : 2 * pencil.n] = la.inv(dense(pencil.M))
    return StateSpace(A, B)


def first_order_hold(A: FloatArray, B: FloatArray, step_s: float) -> Hold:
    """Return the exact step of ẋ = Ax + Bf for forces that are linear within it.

    Raises
    ------
    InputError
        If the step is not positive.
    """
    require(0.0 < step_s < np.inf, "must be positive", field="step_s", value=step_s, allowed="> 0")
    n, m = B.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n], block[:n, n : n + m] = A * step_s, B * step_s
    block[n : n + m, n + m :] = np.eye(m)
    exact = la.expm(block)
    ramp = exact[:n, n + m :]
    return Hold(exact[:n, :n], exact[:n, n : n + m] - ramp, ramp)


def march(hold: Hold, x0: FloatArray, f: FloatArray) -> FloatArray:
    """Return the states (n_steps + 1, n_states) under given forces ``f`` (n_steps + 1, m)."""
    gain = f[:-1] @ hold.P0.T + f[1:] @ hold.P1.T
    return np.asarray(_steps(np.ascontiguousarray(hold.E), np.asarray(x0, dtype=np.float64), gain))


@njit(cache=True)
def _steps(E: FloatArray, x0: FloatArray, gain: FloatArray) -> FloatArray:
    """Return x_{k+1} = E x_k + g_k from x_0, (n_steps + 1, n_states)."""
    x = np.empty((gain.shape[0] + 1, x0.size))
    x[0] = x0
    for k in range(gain.shape[0]):
        x[k + 1] = E @ x[k] + gain[k]
    return x


def periodic_start(hold: Hold, f: FloatArray) -> FloatArray:
    """Return the initial state of the periodic motion under forces ``f`` (n_steps + 1, m) with f[−1] = f[0].

    A record that starts there has no transient.

    Raises
    ------
    NumericalError
        If a motion of the model is undamped, as in a mechanism.
    """
    end, power = _end(hold.E, f[:-1] @ hold.P0.T + f[1:] @ hold.P1.T)
    left = np.eye(end.size) - power
    x0 = np.linalg.solve(left, end)
    if not np.isfinite(x0).all():
        raise NumericalError("no periodic motion: a motion of the model is not damped")
    return np.asarray(x0)


def _end(E: FloatArray, gain: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Σ E^{n−1−k} g_k and Eⁿ for gains g (n, n_states), by repeated doubling of the step."""
    power, square = np.linalg.matrix_power(E, gain.shape[0]), E
    while gain.shape[0] > 1:
        if gain.shape[0] % 2:
            gain = np.vstack([np.zeros_like(gain[:1]), gain])
        gain, square = gain[0::2] @ square.T + gain[1::2], square @ square
    return gain[0], power


def march_with_feedback(
    hold: Hold,
    feedback_hold: Hold,
    x0: FloatArray,
    f: FloatArray,
    feedback: Feedback,
    *,
    evaluations: int = 1,
) -> tuple[FloatArray, FloatArray]:
    """Return states and feedback forces (n_steps + 1, m_g) under ``f`` and forces that depend on the motion.

    Each step extrapolates the feedback, evaluates it at the resulting state, and corrects; ``evaluations``
    further iterations approach the implicit solution.

    Parameters
    ----------
    feedback_hold : Hold
        The same E, with P0 and P1 of the feedback's input.

    Raises
    ------
    NumericalError
        If the motion grows without bound.
    """
    gain = f[:-1] @ hold.P0.T + f[1:] @ hold.P1.T
    P0, P1 = feedback_hold.P0, feedback_hold.P1
    x = np.empty((f.shape[0], x0.size))
    x[0] = x0
    g = np.empty((f.shape[0], P0.shape[1]))
    g[0] = feedback(0, x0)
    before = g[0]
    with np.errstate(over="ignore", invalid="ignore"):  # checked at the end
        for k in range(gain.shape[0]):
            base = hold.E @ x[k] + gain[k] + P0 @ g[k]
            guess = 2.0 * g[k] - before
            for _ in range(evaluations):
                guess = feedback(k + 1, base + P1 @ guess)
            x[k + 1] = base + P1 @ guess
            before, g[k + 1] = g[k], guess
    if not np.isfinite(x[-1]).all():
        raise NumericalError("the motion grows without bound: shorten the load step")
    return x, g


def free_decay(pencil: Pencil, x0: FloatArray, *, step_s: float, n_steps: int) -> FloatArray:
    """Return displacements (n_steps + 1, n) after release from rest at ``x0``, where dashpots are relaxed."""
    space = state_space(pencil)
    state = np.zeros(space.A.shape[0])
    state[: pencil.n] = x0
    state[2 * pencil.n :] = np.concatenate([np.empty(0), *(x0[b.dofs] for b in maxwell_branches(pencil))])
    hold = first_order_hold(space.A, space.B, step_s)
    return march(hold, state, np.zeros((n_steps + 1, pencil.n)))[:, : pencil.n]
