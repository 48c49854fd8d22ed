"""Omission of redundant branches: two fits are the same solution if both reduce to the same shorter law.

If the data need fewer branches than a law has, the cost has a valley with many arms, since a redundant branch
may have any relaxation time. Walks along single parameters do not lead from one arm into the next. All arms
meet where the branch has no stiffness. Hence each end point is moved there, weakest branch first, while the
cost does not rise, and the remaining parameters are compared.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.soil import BRANCHES, K0
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.descent import End
from jackettwin.updating.search.path import Path, held_minimum, minimum

_NOTHING = -23.0
"""Logarithm of a negligible relative stiffness: 1e-10, a hundredth of the relative error of poles."""
_LAST = 1e-6
"""Share of the cost to which the others are refitted: weak branches are known poorly, and are compared."""
_FAR = 100.0
"""Ratio to the allowed cost above which a surrogate's prediction rejects an omission."""
_BETWEEN = np.linspace(0.0, 1.0, 10)[1:-1]
"""Points at which the cost is computed on the way to a vanishing branch."""


class ShorterLaws:
    """The shorter law of each end point, computed once.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._known: dict[int, tuple[End, FloatArray | None]] = {}

    def __call__(self, end: End) -> FloatArray | None:
        """Return the parameters of the shorter law, or None if the data need every branch."""
        if id(end) not in self._known:
            self._known[id(end)] = (end, shorter_law(self._problem, end))
        return self._known[id(end)][1]


def shorter_law(problem: Problem, end: End) -> FloatArray | None:
    """Return the shorter law of an end point, without its redundant branches.

    Returns
    -------
    (n,) logarithms: of each law's static stiffness, then stiffnesses and times of its branches from the
    slowest on, then the other parameters. None if no branch can go.
    """
    omissible = problem.model.family.omissible
    if not omissible or problem.model.tie_groups.one_loss:
        return None  # the law shares parameters between several stiffnesses
    path, z = Path(problem), end.z
    gone: tuple[int, ...] = ()
    ceiling = end.cost + problem.allowance(end.cost)
    columns = _columns(problem)
    for own in columns:
        branches = [int(j) for j in own[list(omissible)]]
        for _ in branches:
            for j in sorted(set(branches) - set(gone), key=z.__getitem__):
                without = _without(path, z, j, gone, ceiling)
                if without is not None:
                    z, gone = without, (*gone, j)
                    break
            else:
                break
    return _numbers(problem, z, columns) if gone else None


def _columns(problem: Problem) -> list[IntArray]:
    """Return the coordinates of each law's parameters in the first state, (n_parameters,) each."""
    of_laws = problem.states[0].weights[: problem.model.n_of_law]
    n = len(problem.model.family.parameters)
    return list((of_laws == 1.0).argmax(axis=1).reshape(-1, n))


def _without(path: Path, z: FloatArray, j: int, gone: tuple[int, ...], ceiling: float) -> FloatArray | None:
    """Return the point without one more branch, the others refitted; None if the cost rises on the way."""
    near, start, held = path.surrogate(z), z.copy(), (j, *gone)
    start[j] = _NOTHING
    if near is None:
        return None
    # poles, and so the laws' stiffness there, hardly change: if the surrogate cannot fit, the model cannot
    there, promised = held_minimum(path.problem, near, start, held, ceiling)
    if promised > _FAR * ceiling:
        return None
    there, _ = minimum(path, there, held=held, tolerance=_LAST)
    if path.total(there) > ceiling:
        return None
    way = z + _BETWEEN[:, None] * (there - z)
    # a branch counts by its stiffness, not by the logarithm of it
    way[:, j] = np.log(np.exp(z[j]) + _BETWEEN * (np.exp(there[j]) - np.exp(z[j])))
    if not _level(path, way, ceiling):
        refitted = [held_minimum(path.problem, near, point, held, ceiling)[0] for point in way]
        if not _level(path, np.array(refitted), ceiling):
            return None
    return there


def _level(path: Path, points: FloatArray, ceiling: float) -> bool:
    return bool((path.problem.costs(points, path.last) <= ceiling).all())


def _numbers(problem: Problem, z: FloatArray, columns: list[IntArray]) -> FloatArray:
    rows, _ = problem.model.family.rows(np.exp(z[np.array(columns)]), problem.model.reference_hz)
    numbers = []
    for row in rows:
        k, tau = row[BRANCHES::2], row[BRANCHES + 1 :: 2]
        there = np.log(k / row[K0]) > 0.5 * _NOTHING
        numbers += [row[K0], *np.stack([k[there], tau[there]], axis=1).ravel()]
    return np.concatenate([np.log(numbers), np.delete(z, np.concatenate(columns))])
