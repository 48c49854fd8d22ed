"""Evaluation along the path of a search, and descent to the nearest minimum.

There are two descents. Far from the data the full model is evaluated at every step (``creep``). Near the data
the poles are nearly linear in the supports' stiffness, and each round finds the minimum of a surrogate
(``minimum``), with three or four evaluations of the full model instead of two hundred in a curved valley.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Found, Problem
from jackettwin.updating.search.levenberg_marquardt import Rows, damped_least_squares
from jackettwin.updating.search.surrogate import Surrogate

_RIDGE = 1e-2
"""Weight of the regularisation towards the middle of the bounds, as a share of a negligible cost."""
_ROUNDS = 8
"""Largest number of surrogates for one minimum."""
_STILL = 1e-7
"""The search has converged if a round changes every ln θ by less than this."""
_NEAR = 0.01
"""The search has also converged if a round changes every ln θ by less than this at unchanged cost."""
_ROUGH = 1e-3
"""Relative accuracy of the cost with one parameter fixed."""
_FAR = 100.0
"""Ratio of a surrogate's cost to the one sought above which the model cannot be as low either."""
_HONEST = 0.25
"""Smallest ratio of the actual to the predicted decrease of the cost for a surrogate to be used further."""
_STEPS = 200

Trail = list[tuple[FloatArray, float]]
"""Points ln θ (d,) of a search and the cost at each, in order of evaluation."""


class PathEvaluator:
    """Residuals and Jacobian along one search path; each prediction starts from the previous one.

    Attributes
    ----------
    last : Found or None
        Modes at the last evaluated point; None if one was lost.
    evaluations : int
        Number of evaluations of the model so far.
    trail : list, optional
        Receives every evaluated point and its cost.
    """

    def __init__(self, problem: Problem, trail: Trail | None = None) -> None:
        self.problem = problem
        self.trail = trail
        self.last: Found | None = None
        self.evaluations = 0
        self.at: FloatArray | None = None
        self.answer: tuple[FloatArray, FloatArray] = (np.zeros(0), np.zeros(0))

    def __call__(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return residuals and Jacobian; the last ones are stored."""
        if self.at is None or not np.array_equal(z, self.at):
            r, J, self.last = self.problem.evaluate(z, self.last)
            self.answer, self.at = (r, J), z.copy()
            self.evaluations += 1
            if self.trail is not None:
                self.trail.append((self.at, float(r @ r)))
        return self.answer

    def surrogate(self, z: FloatArray) -> Rows | None:
        """Return the surrogate at a point; None if a mode is lost there."""
        rows = self(z)
        return None if self.last is None else Surrogate(self.problem, z, rows, self.last)

    def total(self, z: FloatArray) -> float:
        """Return the sum of squares."""
        return squares(self(z)[0])

    def pull(self, cost: float) -> Callable[[Rows], Rows]:
        """Return a function that adds a weak regularisation towards the middle of the bounds.

        It leads away from plateaus and makes the minimum of a flat valley unique.
        """
        low, high = self.problem.prior.low, self.problem.prior.high
        weight = np.sqrt(_RIDGE * self.problem.allowance(cost)) / (high - low)
        middle, slopes = 0.5 * (low + high), np.diag(weight)

        def pulled(rows: Rows) -> Rows:
            def both(z: FloatArray) -> tuple[FloatArray, FloatArray]:
                r, J = rows(z)
                return np.concatenate([r, weight * (z - middle)]), np.concatenate([J, slopes])

            return both

        return pulled


def squares(r: FloatArray) -> float:
    """Return the sum of squares."""
    return float(r @ r)


def unchanged(rows: Rows) -> Rows:
    """Return residuals without regularisation."""
    return rows


def creep(
    path: PathEvaluator,
    start: FloatArray,
    rows: Rows,
    *,
    tolerance: float,
    most: int = _STEPS,
    held: tuple[int, ...] = (),
) -> FloatArray:
    """Return the end of least squares with the full model in every step, some coordinates fixed or none."""
    prior, z = path.problem.prior, start.copy()
    free = np.setdiff1d(np.arange(z.size), held)

    def full(y: FloatArray) -> FloatArray:
        z[free] = y
        return z

    def values(y: FloatArray) -> FloatArray:
        return rows(full(y))[0]

    def jacobian(y: FloatArray) -> FloatArray:
        return rows(full(y))[1][:, free]

    fit = least_squares(
        values,
        np.clip(start, prior.low, prior.high)[free],
        jac=jacobian,
        bounds=(prior.low[free], prior.high[free]),
        # needs a third of the default's steps in the curved valleys of laws with several branches
        method="dogbox",
        xtol=tolerance,
        ftol=max(1e-2 * tolerance, 1e-14),
        gtol=1e-14,
        max_nfev=most,
    )
    return full(fit.x).copy()


def minimum(
    path: PathEvaluator,
    start: FloatArray,
    pulled: Callable[[Rows], Rows] = unchanged,
    *,
    held: tuple[int, ...] = (),
    tolerance: float = 1e-8,
    within: float = np.inf,
    enough: float = 0.0,
) -> tuple[FloatArray, bool]:
    """Return the minimum near a point by surrogates or the full model, and whether it has converged.

    Parameters
    ----------
    pulled : function that adds the regularisation to the residuals
    held : tuple of int
        Fixed coordinates.
    tolerance : float
        The search ends if a round lowers the cost by less than this share.
    within : float
        The search also ends if a ln θ is farther than this from the start.
    enough : float
        The search also ends if the cost, with the regularisation, is not higher than this.
    """
    rows, z = pulled(path), start
    cost = squares(rows(z)[0])
    low, high = path.problem.prior.low, path.problem.prior.high
    for _ in range(_ROUNDS):
        if cost <= enough:
            return z, True
        surrogate = path.surrogate(z)
        if surrogate is None:
            break
        near = pulled(surrogate)
        there = damped_least_squares(
            near, z, low, high, held=held, tolerance=0.1 * tolerance, enough=_HONEST * enough
        )
        promised, gained = cost - squares(near(there)[0]), cost - squares(rows(there)[0])
        moved = np.abs(there - z).max()
        arrived = moved < _STILL or (moved < _NEAR and abs(gained) < tolerance * cost)
        believed = gained > _HONEST * promised
        if gained > 0.0 and (arrived or believed):
            z, cost = there, cost - gained
        if arrived or (believed and np.abs(z - start).max() >= within):
            return z, True
        if not believed:
            break
    before = path.evaluations
    z = creep(path, z, rows, tolerance=tolerance, held=held)
    return z, path.evaluations - before < _STEPS


def constrained(
    path: PathEvaluator,
    z: FloatArray,
    parameter: int,
    value: float,
    *,
    near: Rows | None = None,
    enough: float = 0.0,
) -> tuple[FloatArray, float]:
    """Return the point of smallest cost with one ln θ fixed, and its cost.

    Parameters
    ----------
    near : optional
        A surrogate to try first. If even its cost is far above ``enough``, the search ends there.
    enough : float
        Cost at which the search may stop.
    """
    start, held = z.copy(), (parameter,)
    start[parameter] = value
    if near is not None:
        there, promised = held_minimum(path.problem, near, start, held, enough)
        if promised > _FAR * enough:
            return there, promised
        if path.total(there) <= enough:
            return there, path.total(there)
        if path.total(there) < squares(near(start)[0]):
            start = there
    there = minimum(path, start, held=held, tolerance=_ROUGH)[0] if z.size > 1 else start
    return there, path.total(there)


def held_minimum(
    problem: Problem, near: Rows, start: FloatArray, held: tuple[int, ...], enough: float = 0.0
) -> tuple[FloatArray, float]:
    """Return the least point of a surrogate with some ln θ held, or one that is low enough, and its cost."""
    prior = problem.prior
    there = damped_least_squares(
        near, start, prior.low, prior.high, held=held, tolerance=_ROUGH, enough=enough
    )
    return there, squares(near(there)[0])
