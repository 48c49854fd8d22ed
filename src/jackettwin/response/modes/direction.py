"""Horizontal direction of a mode's motion."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import ComplexArray


def principal_direction(moved: ComplexArray) -> tuple[float, float]:
    """Return the horizontal direction [rad] of largest motion of some points (n, 2), and its sum of squares.

    Examples
    --------
    >>> angle, square = principal_direction(np.array([[3.0, 3.0], [-1j, -1j]]))
    >>> round(float(np.degrees(angle)), 6), round(square, 6)
    (45.0, 20.0)
    """
    xx, xy, yy = (float(np.sum((moved[:, i] * moved[:, j].conj()).real)) for i, j in ((0, 0), (0, 1), (1, 1)))
    return 0.5 * float(np.arctan2(2.0 * xy, xx - yy)), 0.5 * (xx + yy + float(np.hypot(2.0 * xy, xx - yy)))
