"""What the cost looks like around a solution: curves over one parameter, surfaces over two."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jackettwin.updating.problem import Problem
from jackettwin.updating.solutions import cost

FloatArray = npt.NDArray[np.float64]


def sensitivity_curve(
    problem: Problem,
    theta: FloatArray,
    parameter: int,
    *,
    span: float = 0.5,
    n: int = 41,
) -> tuple[FloatArray, FloatArray]:
    """Return (factor, cost) as one parameter goes from 1 − span to 1 + span times its value.

    These are the thesis's figures 8.5 and 8.6.
    """
    factors = np.linspace(1.0 - span, 1.0 + span, n)
    values = np.empty(n)
    for i, factor in enumerate(factors):
        moved = theta.copy()
        moved[parameter] *= factor
        values[i] = cost(problem, moved)
    return factors, values


def cost_surface(
    problem: Problem,
    theta: FloatArray,
    axes: tuple[int, int],
    x: FloatArray,
    y: FloatArray,
) -> FloatArray:
    """Return the cost (n_y, n_x) over two parameters, the others held at ``theta`` (figures 8.2, 8.3)."""
    surface = np.empty((y.size, x.size))
    for i, second in enumerate(y):
        for j, first in enumerate(x):
            moved = theta.copy()
            moved[axes[0]], moved[axes[1]] = first, second
            surface[i, j] = cost(problem, moved)
    return surface
