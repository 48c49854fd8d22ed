"""What the cost looks like around a solution: curves over one parameter, surfaces over two."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem


def sensitivity_curve(
    problem: Problem,
    theta: FloatArray,
    parameter: int,
    *,
    span: float = 0.5,
    n: int = 41,
) -> tuple[FloatArray, FloatArray]:
    """Return (factor, cost) as one parameter goes from 1 − span to 1 + span times its value, within bounds.

    These are the thesis's figures 8.5 and 8.6.
    """
    p, value = problem.parameters[parameter], theta[parameter]
    factors = np.linspace(max(1.0 - span, p.low / value), min(1.0 + span, p.high / value), n)
    moved = np.tile(theta, (n, 1))
    moved[:, parameter] *= factors
    return factors, _costs(problem, theta, moved)


def cost_surface(
    problem: Problem,
    theta: FloatArray,
    axes: tuple[int, int],
    x: FloatArray,
    y: FloatArray,
) -> FloatArray:
    """Return the cost (n_y, n_x) over two parameters, the others held at ``theta`` (figures 8.2, 8.3)."""
    moved = np.tile(theta, (y.size * x.size, 1))
    moved[:, axes[0]], moved[:, axes[1]] = np.tile(x, y.size), np.repeat(y, x.size)
    return _costs(problem, theta, moved).reshape(y.size, x.size)


def _costs(problem: Problem, theta: FloatArray, moved: FloatArray) -> FloatArray:
    near = problem.anchor(np.log(theta))
    return np.array([r @ r for r, _, _ in (problem.evaluate(z, near) for z in np.log(moved))])
