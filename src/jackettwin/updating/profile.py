"""Profile likelihoods: the least χ² at each value of one parameter, the others free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from jackettwin.updating.problem import Problem
from jackettwin.updating.solutions import Path

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """The least cost over the others as one parameter goes through its bounds.

    Attributes
    ----------
    values : (n,) of the parameter
    cost : (n,) least χ², prior included
    """

    name: str
    values: FloatArray
    cost: FloatArray


def profile(problem: Problem, theta: FloatArray, parameter: int, *, n: int = 15) -> Profile:
    """Return the profile of one parameter from a solution outwards, each point started from its neighbour."""
    z = np.log(theta)
    low, high = problem.prior.low[parameter], problem.prior.high[parameter]
    grid = np.unique(np.append(np.linspace(low, high, n), z[parameter]))
    centre = int(np.searchsorted(grid, z[parameter]))
    cost = np.empty(grid.size)
    for side in (range(centre, grid.size), range(centre - 1, -1, -1)):
        here = z
        for i in side:
            here, cost[i] = constrained(problem, here, parameter, float(grid[i]))
    return Profile(problem.parameters[parameter].name, np.exp(grid), cost)


def constrained(problem: Problem, z: FloatArray, parameter: int, value: float) -> tuple[FloatArray, float]:
    """Return the point of least cost with one ln θ held, and its cost."""
    path, held = Path(problem), z.copy()
    held[parameter] = value
    free = np.flatnonzero(np.arange(z.size) != parameter)
    if free.size == 0:
        return held, path.total(held)

    def full(y: FloatArray) -> FloatArray:
        held[free] = y
        return held

    def values(y: FloatArray) -> FloatArray:
        return path.values(full(y))

    def jacobian(y: FloatArray) -> FloatArray:
        return path.jacobian(full(y))[:, free]

    fit = least_squares(
        values,
        np.clip(z[free], problem.prior.low[free], problem.prior.high[free]),
        jac=jacobian,
        bounds=(problem.prior.low[free], problem.prior.high[free]),
        x_scale="jac",
        max_nfev=40,
    )
    return full(fit.x).copy(), float(2.0 * fit.cost)
