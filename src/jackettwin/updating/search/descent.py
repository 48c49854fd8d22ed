"""Local searches from a start to the minimum that it leads to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Found, Problem
from jackettwin.updating.search.levenberg_marquardt import Rows
from jackettwin.updating.search.path import PathEvaluator, Trail, creep, minimum

_POINT = 0.02
"""Change of ln θ below which a minimum is well determined when the regularisation is removed. In a flat
valley of the cost the point moves further, and the regularised one is returned."""
_ROUGH = 1e-6
"""Relative accuracy of the cost of a point in a valley of a law's branches."""
_LEVEL = 0.1
"""Share of a negligible cost, with the regularisation, below which a point in such a valley is its bottom."""
_EXACT = 1e-8
"""Relative error of the poles of the condensed model."""


@dataclass(frozen=True)
class End:
    """End of a local search.

    Attributes
    ----------
    z : (d,) ln θ
    cost : float
        Cost without the regularisation.
    settled : bool
        Whether it is a minimum: the cost is not lower nearby, and equal after a cold start.
    evaluations : int
        Number of evaluations of the model that the search took.
    """

    z: FloatArray
    cost: float
    settled: bool
    evaluations: int = 0


def descend(
    problem: Problem, start: FloatArray, *, known: tuple[FloatArray, ...] = (), trail: Trail | None = None
) -> End:
    r"""Return the end of a least-squares descent.

    A weak regularisation towards the middle of the bounds leads away from plateaus and makes the minimum of a
    flat valley unique. To avoid known solutions, the residuals are first multiplied by
    :math:`\prod_i (1 + σ²/\|z - z_i\|²)` (deflation, Farrell et al. 2015); the last steps are without this
    factor.
    """
    path = PathEvaluator(problem, trail)
    if known:
        start = creep(path, start, _deflated(path, known), tolerance=1e-3, most=60)
    z = start
    for tolerance in (1e-3, 1e-8):
        z = creep(path, z, path.pull(path.total(z))(path), tolerance=tolerance)
        if path.total(z) <= problem.hopeless:
            break
    else:
        z = creep(path, z, path, tolerance=1e-10)  # away from a plateau
    # in a valley of redundant branches the position hardly matters, as they are omitted to compare end points
    valley = bool(problem.model.family.omissible)
    tolerance, enough = (_ROUGH, _LEVEL * problem.negligible) if valley else (1e-8, 0.0)
    z, arrived = minimum(path, z, path.pull(path.total(z)), tolerance=tolerance, enough=enough)
    if arrived and _flat(path, z):
        return replace(_judged(problem, z), evaluations=path.evaluations)
    free, _ = minimum(path, z)
    if not arrived and np.abs(free - z).max() >= _POINT:
        # a minimum that the regularised search was too slow to reach is retained
        z, _ = minimum(path, free, path.pull(path.total(free)))
    moved = np.abs(free - z).max() >= _POINT
    return replace(_judged(problem, z if moved else free), evaluations=path.evaluations)


def bottom(problem: Problem, start: FloatArray, near: Found) -> FloatArray:
    """Return the approximate nearest minimum, from a start with known modes."""
    path = PathEvaluator(problem)
    path.last = near
    return creep(path, start, path, tolerance=1e-3, most=30)


def settle(problem: Problem, end: End) -> End:
    """Return the minimum, or the point of a flat valley nearest the middle of the bounds.

    Data without standard deviations are assumed accurate to 1e-4. If they are fitted far better and determine
    all parameters, the point is not regularised.
    """
    path = PathEvaluator(problem)
    if not _flat(path, end.z):
        return end
    z, _ = minimum(path, end.z, path.pull(end.cost))
    free, _ = minimum(path, z)
    return _judged(problem, free if _resolved(path, free) else z)


def _flat(path: PathEvaluator, z: FloatArray) -> bool:
    """Return whether the cost hardly changes in some direction from bound to bound."""
    J, prior = path(z)[1], path.problem.prior
    if len(J) < z.size:
        return True
    weakest = float(np.linalg.svd(J * (prior.high - prior.low), compute_uv=False)[-1])
    return weakest**2 <= path.problem.negligible


def _resolved(path: PathEvaluator, z: FloatArray) -> bool:
    """Return whether the data determine all parameters, by Fisher's information at the fit's accuracy."""
    (r, J), prior = path(z), path.problem.prior
    inside = ((z - prior.low > _POINT) & (prior.high - z > _POINT)).all()
    if not inside or len(r) <= z.size:
        return False
    noise = max(float(np.sqrt(r @ r / (len(r) - z.size))), _EXACT)
    _, s, Vt = np.linalg.svd(J, full_matrices=False)
    with np.errstate(divide="ignore"):
        std = noise * np.sqrt(((Vt / s[:, None]) ** 2).sum(axis=0))
    return bool((std < _POINT).all())


def descend_simplex(problem: Problem, start: FloatArray, *, trail: Trail | None = None) -> End:
    """Return the end of the thesis's simplex search (section 8.2), settled only if it is a minimum."""
    fit = minimize(
        PathEvaluator(problem, trail).total,
        start,
        method="Nelder-Mead",
        bounds=list(zip(problem.prior.low, problem.prior.high, strict=True)),
        options={"xatol": 1e-5, "fatol": 1e-14, "maxfev": 600},
    )
    return replace(_judged(problem, np.asarray(fit.x)), evaluations=int(fit.nfev))


def _deflated(path: PathEvaluator, known: tuple[FloatArray, ...]) -> Rows:
    """Return residuals and Jacobian multiplied by a factor m that is infinite at known solutions."""
    width = 0.1 * (path.problem.prior.high - path.problem.prior.low)

    def factor(z: FloatArray) -> tuple[float, FloatArray]:
        """Return m(z) and ∇ ln m."""
        log_m, slope = 0.0, np.zeros(z.size)
        for centre in known:
            u = (z - centre) / width
            square = float(u @ u) + 1e-12
            log_m += float(np.log1p(1.0 / square))
            slope -= 2.0 * u / width / (square * (1.0 + square))
        return float(np.exp(log_m)), slope

    def rows(z: FloatArray) -> tuple[FloatArray, FloatArray]:
        (m, slope), (r, J) = factor(z), path(z)
        return m * r, np.asarray(m * (J + np.outer(r, slope)))

    return rows


def _judged(problem: Problem, z: FloatArray) -> End:
    """Return the end: a minimum if no Gauss–Newton step inside the bounds lowers the cost noticeably."""
    r, J, found = problem.evaluate(z, None)
    cost = float(r @ r)
    if found is None:
        return End(z, cost, False)
    gradient = J.T @ r
    inside = ~(
        ((z - problem.prior.low < 1e-6) & (gradient > 0.0))
        | ((problem.prior.high - z < 1e-6) & (gradient < 0.0))
    )
    promise = 0.0
    if inside.any():
        step = np.linalg.lstsq(J[:, inside], -r, rcond=1e-8)[0]
        promise = -float(gradient[inside] @ np.clip(step, -1.0, 1.0))
    return End(z, cost, promise <= problem.allowance(cost))
