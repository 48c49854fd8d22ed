"""Local searches: from a start down to the minimum that it leads to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares, minimize

from jackettwin.arrays import FloatArray
from jackettwin.updating.problem import Found, Problem

_EVALUATIONS = 200
_RIDGE = 1e-2
"""Weight of the pull towards the middle of the bounds, as a share of a negligible cost."""
_POINT = 0.02
"""A well-determined minimum moves by less than this in ln θ when the pull is taken away. In a flat valley of
the cost the point moves further, and the one with the pull is kept."""


@dataclass(frozen=True)
class End:
    """Where a local search ended.

    Attributes
    ----------
    z : (d,) ln θ
    cost : float
        Without the pull to the middle.
    settled : bool
        Whether it is a minimum: nothing lower nearby, and the same cost from a cold start.
    evaluations : int
        Number of evaluations of the model that the search took.
    """

    z: FloatArray
    cost: float
    settled: bool
    evaluations: int = 0


Trail = list[tuple[FloatArray, float]]
"""Points ln θ (d,) that a search came by and the cost at each, in their order."""


class Path:
    """Residuals and Jacobian along one search path: each prediction starts from the one before.

    Attributes
    ----------
    trail : list, optional
        Takes every point that is evaluated, and its cost.
    """

    def __init__(self, problem: Problem, trail: Trail | None = None) -> None:
        self.problem = problem
        self.trail = trail
        self.last: Found | None = None
        self.at: FloatArray | None = None
        self.answer: tuple[FloatArray, FloatArray] = (np.zeros(0), np.zeros(0))

    def __call__(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return residuals and Jacobian; the last ones are kept."""
        if self.at is None or not np.array_equal(z, self.at):
            r, J, self.last = self.problem.evaluate(z, self.last)
            self.answer, self.at = (r, J), z.copy()
            if self.trail is not None:
                self.trail.append((self.at, float(r @ r)))
        return self.answer

    def values(self, z: FloatArray) -> FloatArray:
        """Return the residuals."""
        return self(z)[0]

    def jacobian(self, z: FloatArray) -> FloatArray:
        """Return their Jacobian."""
        return self(z)[1]

    def total(self, z: FloatArray) -> float:
        """Return the sum of squares."""
        r = self.values(z)
        return float(r @ r)


def descend(
    problem: Problem, start: FloatArray, *, known: tuple[FloatArray, ...] = (), trail: Trail | None = None
) -> End:
    r"""Return the end of a least-squares descent.

    A weak pull towards the middle of the bounds leads off plateaus and gives a flat valley of the cost one
    lowest point. To keep away from known solutions, the residuals are first multiplied by
    :math:`\prod_i (1 + σ²/\|z - z_i\|²)` (deflation, Farrell et al. 2015); the last steps go without.
    """
    taken, path = 0, Path(problem, trail)
    if known:
        start, taken = _least_squares(path, start, *_deflated(path, known), tolerance=1e-3, evaluations=60)
    z = start
    for tolerance in (1e-3, 1e-8):
        here = path.total(z)
        z, n = _least_squares(path, z, *_pulled(path, here), tolerance=tolerance)
        taken += n
    free, n = _least_squares(path, z, path.values, path.jacobian, tolerance=1e-10)
    taken += n
    back = z
    if np.abs(free - z).max() >= _POINT:
        # in a flat valley the pull leads back; a minimum that the pulled search was too slow to reach stays
        back, n = _least_squares(path, free, *_pulled(path, path.total(free)), tolerance=1e-8)
        taken += n
    return replace(_judged(problem, free if np.abs(free - back).max() < _POINT else z), evaluations=taken)


def bottom(problem: Problem, start: FloatArray, near: Found) -> FloatArray:
    """Return the nearest minimum roughly, from a start whose modes are known."""
    path = Path(problem)
    path.last = near
    return _least_squares(path, start, path.values, path.jacobian, tolerance=1e-3, evaluations=30)[0]


def settle(problem: Problem, end: End) -> End:
    """Return the point of a flat valley nearest the middle of the bounds, or the minimum as it is."""
    _, J, _ = problem.evaluate(end.z, None)
    width = problem.prior.high - problem.prior.low
    weakest = float(np.linalg.svd(J * width, compute_uv=False)[-1]) if len(J) >= end.z.size else 0.0
    if weakest**2 > problem.negligible:
        return end
    path = Path(problem)
    z, _ = _least_squares(path, end.z, *_pulled(path, end.cost), tolerance=1e-12, evaluations=1000)
    return _judged(problem, z)


def descend_simplex(problem: Problem, start: FloatArray, *, trail: Trail | None = None) -> End:
    """Return the end of the thesis's simplex search (section 8.2): settled only where it is a minimum."""
    fit = minimize(
        Path(problem, trail).total,
        start,
        method="Nelder-Mead",
        bounds=list(zip(problem.prior.low, problem.prior.high, strict=True)),
        options={"xatol": 1e-5, "fatol": 1e-14, "maxfev": 600},
    )
    return replace(_judged(problem, np.asarray(fit.x)), evaluations=int(fit.nfev))


def constrained(problem: Problem, z: FloatArray, parameter: int, value: float) -> tuple[FloatArray, float]:
    """Return the point of least cost with one ln θ held, and its cost."""
    path, held = Path(problem), z.copy()
    held[parameter] = value
    free = np.flatnonzero(np.arange(z.size) != parameter)
    if free.size == 0:
        return held, path.total(held)

    def full(y: FloatArray) -> FloatArray:
        held[free] = y
        return held

    def values(y: FloatArray) -> FloatArray:
        return path.values(full(y))

    def jacobian(y: FloatArray) -> FloatArray:
        return path.jacobian(full(y))[:, free]

    low, high = problem.prior.low[free], problem.prior.high[free]
    fit = least_squares(
        values,
        np.clip(z[free], low, high),
        jac=jacobian,
        bounds=(low, high),
        method="dogbox",
        xtol=1e-6,
        ftol=1e-4,
        max_nfev=40,
    )
    return full(fit.x).copy(), float(2.0 * fit.cost)


Rows = Callable[[FloatArray], FloatArray]


def _least_squares(
    path: Path,
    start: FloatArray,
    values: Rows,
    jacobian: Rows,
    *,
    tolerance: float,
    evaluations: int = _EVALUATIONS,
) -> tuple[FloatArray, int]:
    """Return where least squares end, and how many evaluations that took."""
    prior = path.problem.prior
    fit = least_squares(
        values,
        start,
        jac=jacobian,
        bounds=(prior.low, prior.high),
        # a third of the steps of the default in the curved valleys of laws with several branches
        method="dogbox",
        xtol=tolerance,
        ftol=max(1e-2 * tolerance, 1e-14),
        gtol=1e-14,
        max_nfev=evaluations,
    )
    return np.asarray(fit.x), int(fit.nfev)


def _pulled(path: Path, cost: float) -> tuple[Rows, Rows]:
    """Return residuals and Jacobian with a pull to the middle of the bounds, weak beside a cost."""
    low, high = path.problem.prior.low, path.problem.prior.high
    weight = np.sqrt(_RIDGE * path.problem.allowance(cost)) / (high - low)
    middle = 0.5 * (low + high)
    return (
        lambda z: np.concatenate([path.values(z), weight * (z - middle)]),
        lambda z: np.concatenate([path.jacobian(z), np.diag(weight)]),
    )


def _deflated(path: Path, known: tuple[FloatArray, ...]) -> tuple[Rows, Rows]:
    """Return residuals and Jacobian multiplied by a factor m that grows without bound at known solutions."""
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

    def jacobian(z: FloatArray) -> FloatArray:
        m, slope = factor(z)
        return np.asarray(m * (path.jacobian(z) + np.outer(path.values(z), slope)))

    return lambda z: factor(z)[0] * path.values(z), jacobian


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
