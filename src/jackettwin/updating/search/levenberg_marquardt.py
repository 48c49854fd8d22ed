r"""Least squares in narrow curved valleys: Levenberg–Marquardt with geodesic acceleration.

The step v of

.. math:: (J^T J + λ S^{-2})\, v = -J^T r

is corrected by a/2, with a the solution for the second derivative of the residuals along v (Transtrum &
Sethna 2012, *Improvements to the Levenberg–Marquardt algorithm*); a step with too large a correction is
shortened. S contains the widths between the bounds. Each step needs two evaluations, so that the method is
meant for inexpensive functions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jackettwin.arrays import FloatArray

Rows = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Residuals (n,) and their Jacobian (n, d) at a point (d,)."""

_MOST_BENT = 0.75
"""Largest ratio of the correction a to the step v; otherwise the step is shortened."""
_PROBE = 0.1
"""Share of the step over which the second derivative is taken."""
_LONGER, _SHORTER = 5.0, 3.0
"""Divisor of the damping after a successful step, and its factor after a failure."""
_MOST_STEPS = 60
"""Most steps; in a valley so curved that they do not suffice, the next search goes on from there."""
_FIRST, _LAST = 1e-4, 1e14
"""Initial damping, and damping at which the iteration ends, since no step is short enough."""


def damped_least_squares(
    rows: Rows,
    start: FloatArray,
    low: FloatArray,
    high: FloatArray,
    *,
    held: tuple[int, ...] = (),
    tolerance: float = 1e-9,
    enough: float = 0.0,
) -> FloatArray:
    """Return a point of least squares between bounds.

    Parameters
    ----------
    rows : residuals and Jacobian at a point
    start, low, high : (d,)
    held : tuple of int
        Fixed coordinates.
    tolerance : float
        The iteration ends if a step changes all coordinates, or the relative cost, by less than this.
    enough : float
        The iteration also ends if the cost is not higher than this.
    """
    low, high = low.copy(), high.copy()
    for side in (low, high):
        side[list(held)] = start[list(held)]
    z, damping, width = start, _FIRST, high - low
    r, J = rows(z)
    cost = float(r @ r)
    for _ in range(_MOST_STEPS):
        if cost <= enough:
            break
        gradient = r @ J
        free = ~(((z <= low) & (gradient > 0.0)) | ((z >= high) & (gradient < 0.0)))
        U, s, Vt = np.linalg.svd(J * (width * free), full_matrices=False)
        while damping < _LAST:
            u = _bent_step(rows, z, r, J, U * (s / (s * s + damping)), Vt, width, low, high)
            if u is not None:
                after = np.minimum(np.maximum(z + width * u, low), high)
                r_after, J_after = rows(after)
                cost_after = float(r_after @ r_after)
                if cost_after < cost:
                    break
            damping *= _SHORTER
        else:
            break
        moved, gained = np.abs(after - z).max(), cost - cost_after
        z, r, J, cost, damping = after, r_after, J_after, cost_after, damping / _LONGER
        if moved < tolerance or gained < tolerance * cost:
            break
    return z


def _bent_step(
    rows: Rows,
    z: FloatArray,
    r: FloatArray,
    J: FloatArray,
    left: FloatArray,
    right: FloatArray,
    width: FloatArray,
    low: FloatArray,
    high: FloatArray,
) -> FloatArray | None:
    """Return the step (d,) relative to the bounds' width, None if its correction is too large.

    Parameters
    ----------
    left, right : (n, k), (k, d) factors of the transposed solution matrix for a residual
    """
    v = -(r @ left) @ right
    there = z + (_PROBE * width) * v
    if (there < low).any() or (there > high).any():
        return v  # no evaluation beyond the bounds
    bend = (2.0 / _PROBE) * ((rows(there)[0] - r) / _PROBE - J @ (width * v))
    a = -0.5 * ((bend @ left) @ right)
    return v + a if 2.0 * np.linalg.norm(a) <= _MOST_BENT * np.linalg.norm(v) else None
