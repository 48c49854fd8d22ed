"""The cost around a point, as a function of one or two parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.soil import Parameter
from jackettwin.updating.problem import Problem

_PIECE = 500
"""Points that are computed at once: compiled code lets no other thread report progress meanwhile."""


@dataclass(frozen=True)
class CostSurface:
    """Cost as a function of two parameters, with all others fixed.

    Attributes
    ----------
    parameters : the two parameters; the first is along x
    x, y : (n_x,) and (n_y,) values
    cost : (n_y, n_x), NaN where the model lacks a mode of the data
    """

    parameters: tuple[Parameter, Parameter]
    x: FloatArray
    y: FloatArray
    cost: FloatArray


@dataclass(frozen=True)
class CostCurve:
    """Cost as one parameter is multiplied by factors, (n,) each; NaN where a mode is missing."""

    parameter: Parameter
    value: float
    factor: FloatArray
    cost: FloatArray


def cost_surface(
    problem: Problem, theta: FloatArray, axes: tuple[int, int], x: FloatArray, y: FloatArray
) -> CostSurface:
    """Return the cost as a function of two parameters (thesis figures 8.2, 8.3).

    Parameters
    ----------
    theta : (d,) values of the other parameters
    axes : indices of the two among the problem's parameters
    x, y : values of the two parameters
    """
    moved = np.tile(theta, (y.size * x.size, 1))
    moved[:, axes[0]], moved[:, axes[1]] = np.tile(x, y.size), np.repeat(y, x.size)
    parameters = (problem.parameters[axes[0]], problem.parameters[axes[1]])
    return CostSurface(parameters, x, y, _costs(problem, theta, moved).reshape(y.size, x.size))


def cost_curve(
    problem: Problem, theta: FloatArray, parameter: int, *, span: float = 0.5, n: int = 41
) -> CostCurve:
    """Return the cost as one parameter varies from 1 − span to 1 + span times its value, within its bounds.

    Thesis figures 8.5 and 8.6. The value itself is one of the points.
    """
    p, value = problem.parameters[parameter], float(theta[parameter])
    low, high = max(1.0 - span, p.low / value), min(1.0 + span, p.high / value)
    factor = np.unique(np.append(np.linspace(low, high, n), np.clip(1.0, low, high)))
    moved = np.tile(theta, (factor.size, 1))
    moved[:, parameter] *= factor
    return CostCurve(p, value, factor, _costs(problem, theta, moved))


def _costs(problem: Problem, theta: FloatArray, moved: FloatArray) -> FloatArray:
    anchor = problem.anchor(np.log(theta))
    pieces = np.array_split(np.log(moved), -(-len(moved) // _PIECE))
    return np.concatenate([problem.costs(piece, anchor) for piece in pieces])
