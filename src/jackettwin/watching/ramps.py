r"""When a change began that may have come little by little.

A ramp that began at τ and goes on is a sum of small steps at the begins that are kept since: with increments
w, :math:`a = \sum_{jk} w_j w_k u^T A_{jk} u` and :math:`c = \sum_j w_j u^T b_j` of a ramp along u are what a
and c of a step are. Dated as a step, a ramp seems to begin in its middle.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.watching.directions import Directions, log_along
from jackettwin.watching.memory import Bank


def increments(days: FloatArray, now: float) -> FloatArray:
    """Return the steps that make a ramp from each begin to one now, (n, n): w[i, j] at j, of a ramp from i.

    Examples
    --------
    >>> increments(np.array([0.0, 1.0, 3.0]), 4.0)[0]  # at half past each span: 1/8, 4/8, 7/8
    array([0.125, 0.375, 0.375])
    """
    middle = 0.5 * (days + np.append(days[1:], now))
    span = np.maximum(now - days, 1e-9)
    level = np.clip((middle - days[:, None]) / span[:, None], 0.0, 1.0)
    return np.asarray(np.triu(np.diff(level, axis=1, prepend=0.0)))


def log_ramps(directions: Directions, u: FloatArray, bank: Bank, days: FloatArray, now: float) -> FloatArray:
    """Return ln of the Bayes factors, over no change, of ramps and of steps along u by begin, (2, n)."""
    if bank.cross is None:
        raise ValueError("a bank without what ramps are judged by")
    lower = np.einsum("i,tbij,j->tb", u, bank.cross, u)
    info = lower + np.tril(lower, -1).T
    score, w = bank.score @ u, increments(days, now)
    a = np.stack([np.einsum("ij,jk,ik->i", w, info, w), np.diag(info)])
    return log_along(directions, a, np.stack([w @ score, score]))
