"""Profile likelihoods: the least χ² at each value of one parameter, the others free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jackettwin.updating.descent import constrained
from jackettwin.updating.problem import Problem

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


def profile(problem: Problem, theta: FloatArray, parameter: int, *, n: int = 11) -> Profile:
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
