"""Profile likelihoods: the smallest χ² at each value of one parameter, with the others free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.path import PathEvaluator, constrained

_REFINEMENTS = 4
"""Most rounds of halving, to a sixteenth of the first steps."""
_NEAR, _STEP = 8.0, 2.0
"""Where χ² is below the lowest plus the first, steps that change χ² by more than the second are halved."""


@dataclass(frozen=True)
class Profile:
    """The smallest cost over all other parameters as one parameter varies within its bounds.

    Attributes
    ----------
    values : (n,) values of the parameter
    cost : (n,) smallest χ², including the prior
    """

    name: str
    values: FloatArray
    cost: FloatArray


def profile(problem: Problem, theta: FloatArray, parameter: int, *, n: int = 11) -> Profile:
    """Return the profile of one parameter outwards from a solution, each point started from its neighbour.

    Where it rises steeply near its lowest point, intermediate points are added.
    """
    z = np.log(theta)
    low, high = problem.prior.low[parameter], problem.prior.high[parameter]
    grid = np.unique(np.append(np.linspace(low, high, n), z[parameter]))
    centre = int(np.searchsorted(grid, z[parameter]))
    points, cost = np.empty((grid.size, z.size)), np.empty(grid.size)
    for side in (range(centre, grid.size), range(centre - 1, -1, -1)):
        path, here = PathEvaluator(problem), z
        for i in side:
            here, cost[i] = constrained(path, here, parameter, float(grid[i]))
            points[i] = here
    for _ in range(_REFINEMENTS):
        near = np.minimum(cost[1:], cost[:-1]) < cost.min() + _NEAR
        steep = np.flatnonzero(near & (np.abs(np.diff(cost)) > _STEP))
        for i in steep[::-1]:
            start = points[i] if cost[i] < cost[i + 1] else points[i + 1]
            between = 0.5 * (points[i, parameter] + points[i + 1, parameter])
            here, value = constrained(PathEvaluator(problem), start, parameter, float(between))
            points, cost = np.insert(points, i + 1, here, axis=0), np.insert(cost, i + 1, value)
    return Profile(problem.parameters[parameter].name, np.exp(points[:, parameter]), cost)
