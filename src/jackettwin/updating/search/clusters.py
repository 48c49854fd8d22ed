"""Which end points belong together: a cluster is one solution, with its extent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.descent import End
from jackettwin.updating.search.path import Path, constrained, held_minimum

_SAME = 0.02
"""End points closer than this in every ln θ are one."""
_STAGES = 10
"""Steps of the walk from one end point to another."""
_MOST_STEPS = 10_000
"""Most steps of all walks between end points: about a minute. Those not compared by then are listed apart."""
_JUMP = 4.0
"""If the other parameters move by more than so many steps at once, they may have jumped over a ridge."""
_LOOSE = 0.1
"""Where a surrogate leads, the cost may be higher by this share of what may be neglected."""
_NARROW = 0.05
"""A solution whose ln θ the cost fixes better than this is a point, not a cluster."""


def gather(
    problem: Problem,
    ends: list[tuple[End, int]],
    *,
    known: list[tuple[End, int]] | None = None,
    most_steps: int = _MOST_STEPS,
) -> tuple[list[tuple[End, int]], bool]:
    """Return one end point a cluster, lowest first, and how many ended in it; and whether all were compared.

    Parameters
    ----------
    ends : end points and how many searches each stands for
    known : clusters gathered before, known to be distinct
    most_steps : of all walks between them
    """
    before = known or []
    distinct = {id(end) for end, _ in before}
    kept: list[tuple[End, int]] = []
    left = most_steps
    for end, count in sorted([*before, *ends], key=lambda pair: pair[0].cost):
        for i, (other, others) in enumerate(kept):
            if id(end) in distinct and id(other) in distinct:
                continue
            same = bool(np.abs(end.z - other.z).max() < _SAME)
            if not same and left > 0:
                same, steps = linked(problem, other, end)
                left -= steps
            if same:
                kept[i] = (other, others + count)
                break
        else:
            kept.append((end, count))
    return kept, left > 0


def linked(problem: Problem, low: End, high: End) -> tuple[bool, int]:
    """Return whether a walk from the higher end point to the lower one never has to climb, and its steps.

    One coordinate is stepped and the others are refitted, first the coordinate in which the two lie farthest
    apart. If the cost falls on the way, the higher end point was a shoulder and no minimum. What may as well
    be nothing in a law may stand at another place in the lower one.
    """
    found, taken = _joined(problem, low, high)
    through = None if found else _through_nothing(problem, low, high)
    if through is not None:
        found, steps = _joined(problem, low, through)
        taken += steps
    return found, taken


def _through_nothing(problem: Problem, low: End, high: End) -> End | None:
    """Return the higher end point with the weakest part of its laws put where the lower has it.

    The part is first taken away; None if the cost does not allow that.
    """
    family, path, here = problem.model.family, Path(problem), high
    allowance, n = problem.allowance(high.cost), len(family.parameters)
    if problem.model.tie_groups.one_loss:
        return None  # its laws share parameters
    of_laws = problem.states[0].weights[: problem.model.n_of_law]
    for columns in (of_laws == 1.0).argmax(axis=1).reshape(-1, n):
        weakest = family.weakest(np.exp(here.z[columns]))
        if weakest is None:
            return None
        j = int(columns[weakest])
        without, _, _ = _walk(path, here, j, float(problem.prior.low[j]), allowance)
        if without is None:
            return None
        z, like = without.copy(), np.exp(low.z[columns])
        z[columns] = np.log(family.moved(np.exp(without[columns]), like))
        z, j = np.clip(z, problem.prior.low, problem.prior.high), int(columns[family.weakest(like) or 0])
        z, cost = constrained(path, z, j, float(z[j]), enough=high.cost + allowance)
        if cost > high.cost + allowance:
            return None
        here = End(z, cost, True)
    return here


def _joined(problem: Problem, low: End, high: End) -> tuple[bool, int]:
    """Return whether some coordinate's walk leads from the higher end point to the lower, and its steps."""
    span = np.abs(high.z - low.z) / (problem.prior.high - problem.prior.low)
    allowance, taken = problem.allowance(high.cost), 0
    for j in np.argsort(-span):
        if span[j] > 1e-3:
            path = Path(problem)
            there, steps, fell = _walk(path, high, int(j), float(low.z[j]), allowance)
            taken += steps
            if fell or (there is not None and _level(path, there, low.z, high.cost + allowance)):
                return True, taken
    return False, taken


def _walk(path: Path, start: End, j: int, to: float, allowance: float) -> tuple[FloatArray | None, int, bool]:
    """Return where a walk along one coordinate ends, its steps, and whether the cost fell on the way.

    None if it climbs before.
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


def _level(path: Path, start: FloatArray, end: FloatArray, ceiling: float) -> bool:
    """Return whether the cost stays below a ceiling on the straight line between two points."""
    between = np.linspace(0.0, 1.0, _STAGES)[1:-1]
    costs = path.problem.costs(start + between[:, None] * (end - start), path.last)
    return bool((costs <= ceiling).all())


def extent(problem: Problem, end: End) -> tuple[FloatArray, list[FloatArray]]:
    """Return the range of each ln θ (d, 2), the others refitted, in which the cost hardly rises.

    The second value holds the points reached, for parameters with a wide range.
    """
    points = []
    path = Path(problem)
    J, allowance = path(end.z)[1], problem.allowance(end.cost)
    curvature = J.T @ J
    spread = np.full(end.z.size, np.inf)
    if np.linalg.cond(curvature) < 1e12:
        spread = np.sqrt(allowance * np.diag(np.linalg.inv(curvature)))
    sides = np.stack([end.z - spread, end.z + spread], axis=1)
    # with a likelihood the posterior says how far, and better
    for j in np.flatnonzero(spread > _NARROW) if problem.relative else ():
        for side, limit in enumerate((problem.prior.low[j], problem.prior.high[j])):
            point = _reach(path, end, int(j), float(limit), allowance)
            points.append(point)
            sides[j, side] = point[j]
    return np.clip(sides, problem.prior.low[:, None], problem.prior.high[:, None]), points


def _reach(path: Path, end: End, j: int, limit: float, allowance: float) -> FloatArray:
    """Return the point with the farthest value of one ln θ that keeps the cost.

    It is sought on the surrogate at the end, for poles stay there where the cost does; if the cost is not
    kept where that leads, by asking the structure at every step.
    """
    near, ceiling = path.surrogate(end.z), end.cost + allowance
    if near is not None:
        far = _farthest(lambda z: held_minimum(path.problem, near, z, j, ceiling), end.z, j, limit, ceiling)
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
    """Return the farthest point below a ceiling: walk towards the limit of one ln θ, halve the step."""
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
