r"""The books of a motion: work put in = energy stored + energy dissipated.

Stored: :math:`½\dot q^T M \dot q + ½ q^T K_0 q + ½ Σ (q−y)^T k S (q−y)`; dissipated per second:
:math:`\dot q^T C \dot q + Σ (q−y)^T (k/τ) S (q−y)`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.response.state import damping_matrix, maxwell_branches
from jackettwin.response.system import Pencil
from jackettwin.structure.eigen import dense


class Energy(NamedTuple):
    """Work of the forces since the start, energy stored and energy dissipated since, each (n_times,) [J]."""

    work: FloatArray
    stored: FloatArray
    dissipated: FloatArray


def energy(pencil: Pencil, states: FloatArray, force: FloatArray, *, step_s: float) -> Energy:
    """Return the energy of a motion from its states (n_times, n_states) under forces (n_times, n).

    Rates are integrated by the trapezoidal rule: the steps must resolve the motion.
    """
    n = pencil.n
    q, v = states[:, :n], states[:, n : 2 * n]

    def form(a: FloatArray, matrix: FloatArray, b: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("ti,ij,tj->t", a, matrix, b, optimize=True))

    stored = 0.5 * (form(v, dense(pencil.M), v) + form(q, dense(pencil.static_stiffness()), q))
    loss = form(v, dense(damping_matrix(pencil)), v)
    at = 2 * n
    for k, tau, S, dofs in maxwell_branches(pencil):
        stretch = q[:, dofs] - states[:, at : at + dofs.size]
        twice = form(stretch, k * dense(S)[np.ix_(dofs, dofs)], stretch)
        stored, loss = stored + 0.5 * twice, loss + twice / tau
        at += dofs.size
    power = np.einsum("ti,ti->t", force, v)
    return Energy(_integral(power, step_s), stored, _integral(loss, step_s))


def _integral(rate: FloatArray, step_s: float) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1])) * step_s])
