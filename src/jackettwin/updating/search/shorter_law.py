"""Omission of redundant branches: two fits are the same solution if both reduce to the same shorter law.

If the data need fewer branches than a law has, the cost has a valley with many arms, since a redundant branch
may have any relaxation time. Walks along single parameters do not lead from one arm into the next. All arms
meet where the branch has no stiffness. Hence each end point is moved there, weakest branch first, while the
cost does not rise. Two end points are one solution if the cost does not rise on the way of mixtures between
what is left of them either: the poles are nearly linear in a law's stiffness, which is linear in the mixture.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.soil import ABSENT
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.descent import End
from jackettwin.updating.search.levenberg_marquardt import Rows, damped_least_squares
from jackettwin.updating.search.path import PathEvaluator, held_minimum, minimum, squares

_NOTHING = float(np.log(ABSENT))
_DEEP = 0.01
"""Share of the allowed increase of the cost to which the branches that are left are refitted at each step."""
_SLOW = 1e-6
"""Decrease of the cost in one step, relative, below which the branches that are left cannot be refitted."""
_LAST = 1e-9
"""Share of the cost to which they are refitted at last: the valley of a weak branch is curved, and the cost
would rise on the straight way between points only near its bottom."""
_BETWEEN = np.linspace(0.0, 1.0, 10)[1:-1]
"""Points at which the cost is computed on the way to a vanishing branch, and from one law to another."""


class ShorterLaws:
    """The shorter law of each end point, computed once.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self._path = PathEvaluator(problem)
        self._known: dict[int, tuple[End, FloatArray | None]] = {}

    def __call__(self, end: End) -> FloatArray | None:
        """Return the parameters of the shorter law, or None if the data need every branch."""
        if id(end) not in self._known:
            self._known[id(end)] = (end, shorter_law(self._path, end))
        return self._known[id(end)][1]

    def same(self, low: End, high: End) -> bool:
        """Return whether the cost rises nowhere on a way of mixtures between what is left of both."""
        problem = self._path.problem
        if not _separate(problem):
            return False
        start, end = (z if (z := self(of)) is not None else of.z for of in (low, high))
        ceiling = high.cost + problem.allowance(high.cost)
        way = _mixtures(problem, start, end)
        return _level(self._path, way, ceiling) or all(self._bottom(z, ceiling) <= ceiling for z in way)

    def _bottom(self, z: FloatArray, ceiling: float) -> float:
        """Return the least cost with times as they are, or one that is low enough."""
        problem = self._path.problem
        stiff = [j for own in _columns(problem) for j in own[[0, *problem.model.family.omissible]]]
        held = np.setdiff1d(np.arange(z.size), [j for j in stiff if z[j] >= problem.prior.low[j]])
        there, _ = minimum(self._path, z, held=tuple(held), tolerance=_SLOW, enough=ceiling)
        return self._path.total(there)


def shorter_law(path: PathEvaluator, end: End) -> FloatArray | None:
    """Return the shorter law of an end point, without its redundant branches.

    Parameters
    ----------
    path : PathEvaluator
        Whose last modes are those of a point with nearly the same poles, if there is one.

    Returns
    -------
    (d,) ln θ, each law's remaining branches first and the others after them, without stiffness. None if no
    branch can go.
    """
    problem, z = path.problem, end.z
    omissible = problem.model.family.omissible
    if not _separate(problem):
        return None
    near = path.surrogate(z)
    if near is None:
        return None
    gone: tuple[int, ...] = ()
    ceiling = end.cost + problem.allowance(end.cost)
    enough = end.cost + _DEEP * problem.allowance(end.cost)
    columns = _columns(problem)
    for own in columns:
        branches = [int(j) for j in own[list(omissible)]]
        for _ in branches:
            for j in sorted(set(branches) - set(gone), key=z.__getitem__):
                without = _without(path, near, z, j, gone, enough, ceiling)
                if without is not None:
                    z, gone = without, (*gone, j)
                    break
            else:
                break
    if not gone:
        return None
    prior = problem.prior
    bottom = damped_least_squares(near, z, prior.low, prior.high, held=gone, tolerance=_LAST)
    return _in_order(problem, bottom if path.total(bottom) <= ceiling else z, columns, gone)


def _separate(problem: Problem) -> bool:
    """Return whether the law has branches, and no parameters shared between several stiffnesses."""
    return bool(problem.model.family.omissible) and not problem.model.tie_groups.one_loss


def _mixtures(problem: Problem, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return points (n, d) on the way from one point to another on which the laws are mixtures."""
    way = start + _BETWEEN[:, None] * (end - start)
    for own in _columns(problem):
        way[:, own] = np.log(problem.model.family.between(np.exp(start[own]), np.exp(end[own]), _BETWEEN))
    return np.asarray(way)


def _columns(problem: Problem) -> list[IntArray]:
    """Return the coordinates of each law's parameters in the first state, (n_parameters,) each."""
    of_laws = problem.states[0].weights[: problem.model.n_of_law]
    n = len(problem.model.family.parameters)
    return list((of_laws == 1.0).argmax(axis=1).reshape(-1, n))


def _without(
    path: PathEvaluator,
    near: Rows,
    z: FloatArray,
    j: int,
    gone: tuple[int, ...],
    enough: float,
    ceiling: float,
) -> FloatArray | None:
    """Return the point without one more branch, the others refitted; None if the cost rises on the way.

    Poles, and so the laws' stiffness there, hardly change in such a valley: the point is sought with the
    surrogate at the end point, and the model confirms it and the way.
    """
    start, held = z.copy(), (j, *gone)
    start[j] = _NOTHING
    prior = path.problem.prior
    there = damped_least_squares(
        near, start, prior.low, prior.high, held=held, tolerance=_SLOW, enough=enough
    )
    if squares(near(there)[0]) > ceiling:
        return None
    way = z + _BETWEEN[:, None] * (there - z)
    # a branch counts by its stiffness, not by the logarithm of it
    way[:, j] = np.log(np.exp(z[j]) + _BETWEEN * (np.exp(there[j]) - np.exp(z[j])))
    if not _level(path, np.array([*way, there]), ceiling):
        way = np.array([held_minimum(path.problem, near, point, held, ceiling)[0] for point in way])
        if not _level(path, np.array([*way, there]), ceiling):
            return None
    return there


def _level(path: PathEvaluator, points: FloatArray, ceiling: float) -> bool:
    return bool((path.problem.costs(points, path.last) <= ceiling).all())


def _in_order(problem: Problem, z: FloatArray, columns: list[IntArray], gone: tuple[int, ...]) -> FloatArray:
    """Return the same laws with the branches that are gone last, so that equal laws have equal numbers."""
    family, z = problem.model.family, z.copy()
    for own in columns:
        omitted = tuple(i for i in family.omissible if own[i] in gone)
        z[own] = np.log(family.without(np.exp(z[own]), omitted))
    return z
