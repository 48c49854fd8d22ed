"""Paths of searches from every starting point to their ends, and the kinds of these."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.progress import SILENT, Progress
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.clusters import joined
from jackettwin.updating.search.descent import End, descend, descend_simplex
from jackettwin.updating.search.path import Trail
from jackettwin.updating.search.shorter_law import ShorterLaws
from jackettwin.updating.search.solutions import SearchMethod, Solution

Fate = Literal["solution", "plateau", "stalled"]
"""Kind of an end: a solution; a plateau, where the model is far from the data and no parameter changes that;
or a point that is no minimum, where the search stalled."""
_NEAR = 0.02
"""Largest difference of every ln θ between an end and the solution it counts as."""


@dataclass(frozen=True)
class SearchPath:
    """One search from its start to its end.

    Attributes
    ----------
    points : (n, d) θ at every evaluation, the start first
    cost : (n,) cost at these points
    end : (d,) θ at the end
    end_cost : float
    fate : {"solution", "plateau", "stalled"}
    solution : int or None
        Index of the solution at which it ended.
    """

    points: FloatArray
    cost: FloatArray
    end: FloatArray
    end_cost: float
    fate: Fate
    solution: int | None


def search_paths(
    problem: Problem,
    starts: FloatArray,
    solutions: Sequence[Solution],
    *,
    method: SearchMethod = "least-squares",
    progress: Progress = SILENT,
) -> tuple[SearchPath, ...]:
    """Return the paths of searches from some points.

    Parameters
    ----------
    starts : (n, d) θ, between the bounds
    solutions : solutions of the same problem
    method : {"least-squares", "nelder-mead"}
        The method of this package, or the simplex method of the thesis.
    """
    paths = []
    low, high = problem.prior.low, problem.prior.high
    for i, theta in enumerate(starts, start=1):
        progress.within(f"path {i} of {len(starts)}")
        trail: Trail = []
        run = descend if method == "least-squares" else descend_simplex
        end = run(problem, np.clip(np.log(theta), low, high), trail=trail)
        place = _solution(problem, end, solutions)
        points, cost = (np.array(column) for column in zip(*trail, strict=True))
        fate: Fate = "solution" if place is not None else "plateau" if end.settled else "stalled"
        paths.append(SearchPath(np.exp(points), cost, np.exp(end.z), end.cost, fate, place))
    return tuple(paths)


def _solution(problem: Problem, end: End, solutions: Sequence[Solution]) -> int | None:
    """Return the index of the solution of an end: the same point, or connected to it without a barrier."""
    if not end.settled:
        return None
    for i, known in enumerate(solutions):
        z = np.log(known.theta)
        if np.abs(end.z - z).max() < _NEAR:
            return i
        if abs(end.cost - known.cost) <= problem.allowance(known.cost):
            low = End(z, known.cost, True)
            level = ShorterLaws(problem).same(low, end) or joined(problem, low, end)[0]
            if level:
                return i
    return None
