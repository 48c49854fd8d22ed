"""Clustering of end points: a cluster is one solution, with its extent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.descent import End
from jackettwin.updating.search.path import PathEvaluator, constrained, held_minimum
from jackettwin.updating.search.shorter_law import ShorterLaws

SAME = 0.02
"""End points closer than this in every ln θ are the same."""
_STAGES = 10
"""Number of steps of the walk from one end point to another."""
_MOST_STEPS = 10_000
"""Largest number of steps of all walks: about a minute. End points not compared by then are listed
separately."""
_JUMP = 4.0
"""Change of the other parameters in one step, in steps, above which they may have crossed a ridge."""
_LOOSE = 0.1
"""Share of the negligible cost by which the cost may be higher at a point found with a surrogate."""
_NARROW = 0.05
"""A solution whose ln θ are determined better than this is a point, not a cluster."""


def gather(
    problem: Problem,
    ends: list[tuple[End, int]],
    *,
    known: list[tuple[End, int]] | None = None,
    most_steps: int = _MOST_STEPS,
) -> tuple[list[tuple[End, int]], bool]:
    """Return one end point per cluster with its number of searches, lowest first, and if all were compared.

    Parameters
    ----------
    ends : end points with the number of searches that each represents
    known : previous clusters, which are distinct
    most_steps : largest number of steps of all walks between them
    """
    before, shorter = known or [], ShorterLaws(problem)
    distinct = {id(end) for end, _ in before}
    kept: list[tuple[End, int]] = []
    left = most_steps
    for end, count in sorted([*before, *ends], key=lambda pair: pair[0].cost):
        others = [i for i, (other, _) in enumerate(kept) if not distinct >= {id(end), id(other)}]
        # a look before any walk: most end points lie on top of another, or in another arm of its valley
        place = next((i for i in others if np.abs(end.z - kept[i][0].z).max() < SAME), None)
        if place is None:
            place = next((i for i in others if shorter.same(kept[i][0], end)), None)
        for i in others:
            if place is not None or left <= 0:
                break
            same, steps = joined(problem, kept[i][0], end)
            left -= steps
            place = i if same else None
        if place is None:
            kept.append((end, count))
        else:
            kept[place] = (kept[place][0], kept[place][1] + count)
    return kept, left > 0


def joined(problem: Problem, low: End, high: End) -> tuple[bool, int]:
    """Return whether a path of falling cost leads from the higher end point to the lower, and its steps.

    One coordinate is stepped and the others are refitted, starting with the coordinate in which the two
    differ most. If the cost falls on the way, the higher end point was a shoulder and no minimum.
    """
    span = np.abs(high.z - low.z) / (problem.prior.high - problem.prior.low)
    allowance, taken = problem.allowance(high.cost), 0
    for j in np.argsort(-span):
        if span[j] > 1e-3:
            path = PathEvaluator(problem)
            there, steps, fell = _walk(path, high, int(j), float(low.z[j]), allowance)
            taken += steps
            if fell or (there is not None and _level(path, there, low.z, high.cost + allowance)):
                return True, taken
    return False, taken


def _walk(
    path: PathEvaluator, start: End, j: int, to: float, allowance: float
) -> tuple[FloatArray | None, int, bool]:
    """Return the end of a walk along one coordinate, its steps, and whether the cost decreased on the way.

    The end is None if the cost rises before it is reached.
    """
    here, step = start.z, abs(start.z[j] - to) / _STAGES
    near, ceiling = path.surrogate(here), start.cost + allowance
    for steps, value in enumerate(np.linspace(start.z[j], to, _STAGES + 1)[1:], start=1):
        there, cost = constrained(path, here, j, float(value), near=near, enough=ceiling)
        jumped = np.abs(there - here).max() > _JUMP * step
        if cost > ceiling or (jumped and not _level(path, here, there, ceiling)):
            return None, steps, False
        if cost < start.cost - allowance:
            return there, steps, True
        here = there
    return here, _STAGES, False


def _level(path: PathEvaluator, start: FloatArray, end: FloatArray, ceiling: float) -> bool:
    """Return whether the cost stays below a ceiling on the straight line between two points."""
    between = np.linspace(0.0, 1.0, _STAGES)[1:-1]
    costs = path.problem.costs(start + between[:, None] * (end - start), path.last)
    return bool((costs <= ceiling).all())


def extent(problem: Problem, end: End) -> tuple[FloatArray, list[FloatArray]]:
    """Return the range of each ln θ (d, 2), the others refitted, in which the cost hardly rises.

    The second value holds the points reached, for parameters with a wide range.
    """
    points = []
    path = PathEvaluator(problem)
    J, allowance = path(end.z)[1], problem.allowance(end.cost)
    curvature = J.T @ J
    spread = np.full(end.z.size, np.inf)
    if np.linalg.cond(curvature) < 1e12:
        spread = np.sqrt(allowance * np.diag(np.linalg.inv(curvature)))
    sides = np.stack([end.z - spread, end.z + spread], axis=1)
    # with a likelihood the posterior gives the range more accurately
    for j in np.flatnonzero(spread > _NARROW) if problem.relative else ():
        for side, limit in enumerate((problem.prior.low[j], problem.prior.high[j])):
            point = _reach(path, end, int(j), float(limit), allowance)
            points.append(point)
            sides[j, side] = point[j]
    return np.clip(sides, problem.prior.low[:, None], problem.prior.high[:, None]), points


def _reach(path: PathEvaluator, end: End, j: int, limit: float, allowance: float) -> FloatArray:
    """Return the point with the farthest value of one ln θ at practically equal cost.

    It is sought with the surrogate at the end point, since equal cost implies nearly equal poles; if the cost
    increases at the point found, with the full model.
    """
    near, ceiling = path.surrogate(end.z), end.cost + allowance
    if near is not None:
        far = _farthest(
            lambda z: held_minimum(path.problem, near, z, (j,), ceiling), end.z, j, limit, ceiling
        )
        if path.total(far) <= ceiling + _LOOSE * allowance:
            return far
    return _farthest(lambda z: constrained(path, z, j, float(z[j])), end.z, j, limit, ceiling)


def _farthest(
    refitted: Callable[[FloatArray], tuple[FloatArray, float]],
    here: FloatArray,
    j: int,
    limit: float,
    ceiling: float,
) -> FloatArray:
    """Return the farthest point with a cost below a limit, by steps in one ln θ that are halved."""
    last = float(here[j])
    step = (limit - last) / _STAGES
    for _ in range(3 * _STAGES):
        if abs(step) < 1e-2 or abs(limit - last) < 1e-9:
            break
        value = last + step if abs(step) < abs(limit - last) else limit
        start = here.copy()
        start[j] = value
        there, cost = refitted(start)
        if cost <= ceiling:
            here, last = there, value
        else:
            step *= 0.5
    return here
