"""Compiled time stepping of a model with rotor feedback.

The scheme is that of ``march_with_feedback``: the rotor is the feedback that every asset in wind has, and
twelve thousand calls of it in ten minutes cost more than what they compute. Numba keeps the compiled march
with the blade elements inside and does not see when these change: touch this file with ``loads/kernels.py``.
"""

# mypy: disable-error-code="no-untyped-def, no-untyped-call, untyped-decorator, call-arg"

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError
from jackettwin.loads.kernels import blade_elements, compiled
from jackettwin.response import Hold
from jackettwin.simulate.motion.wind import RotorLoads


def march_with_rotor(
    hold: Hold, x0: FloatArray, f: FloatArray, rotor: RotorLoads, damping: FloatArray, top: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return states, and what the rotor adds at the top (n_steps + 1, 6) to ``f`` (n_steps + 1, n).

    Parameters
    ----------
    damping : (6, 6) of the rotor at the tower top that the model knows already
    top : (6, n) motion of the tower top from the coordinates

    Raises
    ------
    NumericalError
        If the motion grows without bound.
    """
    gain = f[:-1] @ hold.P0.T + f[1:] @ hold.P1.T
    own = (np.ascontiguousarray(P @ top.T) for P in (hold.P0, hold.P1))
    with np.errstate(over="ignore", invalid="ignore"):  # seen at the end
        x, g = _march(
            np.ascontiguousarray(hold.E), *own, x0, gain, np.ascontiguousarray(top), rotor.turn,
            rotor.still, damping, rotor.rotor.fixed, rotor.angle, rotor.wind,
        )  # fmt: skip
    if not np.isfinite(x[-1]).all():
        raise NumericalError("the motion grows without bound: shorten the load step")
    return x, g


@compiled
def _march(E, P0, P1, x0, gain, top, turn, still, damping, rotor, angle, wind):
    n, n_times, turns = top.shape[1], still.shape[0], turn.shape[0]
    x, g = np.empty((gain.shape[0] + 1, x0.size)), np.empty((gain.shape[0] + 1, 6))
    motion, load = np.empty((1, 6)), np.empty((1, 6))
    x[0] = x0
    for k in range(gain.shape[0] + 1):
        if k > 0:
            base = E @ x[k - 1] + gain[k - 1] + P0 @ g[k - 1]
            guess = 2.0 * g[k - 1] - g[max(k - 2, 0)]
            x[k] = base + P1 @ guess
        at, R = k % n_times, turn[k % turns]
        velocity = top @ x[k, n : 2 * n]
        motion[0] = R.T @ velocity
        blade_elements(*rotor, angle[at : at + 1], wind[at : at + 1], motion, load)
        g[k] = R @ load[0] - still[at] + damping @ velocity
        if k > 0:
            x[k] = base + P1 @ g[k]
    return x, g
