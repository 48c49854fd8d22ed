"""The ways of searches: from every starting point down to its end, and what that end is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.progress import SILENT, Progress
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.clusters import linked
from jackettwin.updating.search.descent import End, descend, descend_simplex
from jackettwin.updating.search.path import Trail
from jackettwin.updating.search.solutions import SearchMethod, Solution

Fate = Literal["solution", "plateau", "stalled"]
"""What an end is: a solution; a place where the model is far from the data and no parameter changes that; or
no minimum at all, where the search gave up."""
_NEAR = 0.02
"""An end nearer than this to a solution in every ln θ is that solution."""


@dataclass(frozen=True)
class SearchPath:
    """One search from its start to its end.

    Attributes
    ----------
    points : (n, d) θ at every evaluation, the start first
    cost : (n,)
    end : (d,) θ
    end_cost : float
    fate : {"solution", "plateau", "stalled"}
    solution : int or None
        Place of the solution it ended in.
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
    """Return the ways of searches from some points.

    Parameters
    ----------
    starts : (n, d) θ, between the bounds
    solutions : of the same problem
    method : {"least-squares", "nelder-mead"}
        Ours, or the thesis's simplex.
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
    """Return the place of the solution that an end is, or is joined to without a climb."""
    if not end.settled:
        return None
    for i, known in enumerate(solutions):
        z = np.log(known.theta)
        if np.abs(end.z - z).max() < _NEAR:
            return i
        if abs(end.cost - known.cost) <= problem.allowance(known.cost):
            level, _ = linked(problem, End(z, known.cost, True), end)
            if level:
                return i
    return None
