"""Search for every solution: many starts, one list of distinct end points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares, minimize
from scipy.stats import qmc

from jackettwin.errors import InputError, NumericalError
from jackettwin.updating.problem import Found, Problem

FloatArray = npt.NDArray[np.float64]
Method = Literal["least-squares", "nelder-mead"]
METHODS = ("least-squares", "nelder-mead")

LOCKED_DAMPER = 0.05
"""Undamped frequencies further than this from the damped ones: the damper carries what the spring should."""


@dataclass(frozen=True)
class Solution:
    """An end point of the search.

    Attributes
    ----------
    theta : (n_parameters,)
    cost : float
        Sum of squared residuals.
    frequency_hz, undamped_hz, damping_ratio : (n_targets,)
    locked_damper : bool
        An undamped frequency is more than 5 % from the damped one.
    at_bound : tuple of str
        Parameters that ended on a bound.
    found : int
        How many starts ended here.
    """

    theta: FloatArray
    cost: float
    frequency_hz: FloatArray
    undamped_hz: FloatArray
    damping_ratio: FloatArray
    locked_damper: bool
    at_bound: tuple[str, ...]
    found: int = 1


def search(
    problem: Problem,
    *,
    method: Method = "least-squares",
    starts: int = 16,
    seed: int = 0,
    progress: Callable[[], None] | None = None,
) -> tuple[Solution, ...]:
    """Return the distinct solutions from ``starts`` scattered starting points, best first.

    Parameters
    ----------
    method : {"least-squares", "nelder-mead"}
        Gradient least squares, or the thesis's simplex (section 8.2).
    starts : int
        Scrambled Sobol points in the logarithms between the bounds.
    progress : callable, optional
        Called after each start.

    Raises
    ------
    InputError
        If the method is unknown or there is no start.
    NumericalError
        If no start ends anywhere.
    """
    if method not in METHODS:
        raise InputError("unknown method", field="update.method", value=method, allowed=", ".join(METHODS))
    if starts < 1:
        raise InputError("at least one start", field="update.starts", value=starts, allowed="≥ 1")
    low, high = problem.prior.low, problem.prior.high
    run = _least_squares if method == "least-squares" else _nelder_mead
    ends = []
    for point in _scatter(low, high, starts, seed):
        ends.append(run(problem, point))
        if progress is not None:
            progress()
    ends = [end for end in ends if np.isfinite(end[1])]
    if not ends:
        raise NumericalError("no start of the search could follow the target modes")
    return tuple(_distinct([_solution(problem, z, cost) for z, cost in ends]))


def cost(problem: Problem, theta: FloatArray) -> float:
    """Return the cost, (8.4) or χ², at a parameter vector."""
    r, _, _ = problem.evaluate(np.log(theta), None)
    return float(r @ r)


def _scatter(low: FloatArray, high: FloatArray, n: int, seed: int) -> FloatArray:
    sampler = qmc.Sobol(low.size, scramble=True, rng=np.random.default_rng(seed))
    power = int(np.ceil(np.log2(max(n, 2))))
    return np.asarray(low + (high - low) * sampler.random_base2(power)[:n])


class Path:
    """Residuals and Jacobian along one search path: each prediction starts from the one before."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.last: Found | None = None
        self.at: FloatArray | None = None
        self.answer: tuple[FloatArray, FloatArray] = (np.zeros(0), np.zeros(0))

    def __call__(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return residuals and Jacobian; the last answer is remembered."""
        if self.at is None or not np.array_equal(z, self.at):
            r, J, self.last = self.problem.evaluate(z, self.last)
            self.answer, self.at = (r, J), z.copy()
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


def _least_squares(problem: Problem, start: FloatArray) -> tuple[FloatArray, float]:
    evaluate = Path(problem)
    fit = least_squares(
        evaluate.values,
        start,
        jac=evaluate.jacobian,
        bounds=(problem.prior.low, problem.prior.high),
        x_scale="jac",
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=120,
    )
    return np.asarray(fit.x), float(2.0 * fit.cost)


def _nelder_mead(problem: Problem, start: FloatArray) -> tuple[FloatArray, float]:
    fit = minimize(
        Path(problem).total,
        start,
        method="Nelder-Mead",
        bounds=list(zip(problem.prior.low, problem.prior.high, strict=True)),
        options={"xatol": 1e-5, "fatol": 1e-14, "maxfev": 600},
    )
    return np.asarray(fit.x), float(fit.fun)


def _solution(problem: Problem, z: FloatArray, value: float) -> Solution:
    first = problem.states[0]
    theta, modes = problem.vectors(z[None], first)[0], first.residuals.modes
    poles = problem.model.predict(theta, modes).poles
    damped, undamped = np.abs(poles) / (2.0 * np.pi), problem.model.undamped_hz(theta, modes)
    apart = np.abs(undamped / damped - 1.0)
    on_bound = (z - problem.prior.low < 1e-3) | (problem.prior.high - z < 1e-3)
    return Solution(
        theta=np.exp(z),
        cost=value,
        frequency_hz=damped,
        undamped_hz=undamped,
        damping_ratio=np.asarray(-poles.real / np.abs(poles)),
        locked_damper=bool(np.isnan(apart).any() or (apart > LOCKED_DAMPER).any()),
        at_bound=tuple(p.name for p, flag in zip(problem.parameters, on_bound, strict=True) if flag),
    )


def _distinct(solutions: list[Solution]) -> list[Solution]:
    """Return solutions by cost, merging end points within 2 % in every parameter."""
    kept: list[Solution] = []
    for candidate in sorted(solutions, key=lambda s: s.cost):
        for i, other in enumerate(kept):
            if np.abs(np.log(candidate.theta / other.theta)).max() < 0.02:
                kept[i] = Solution(**{**vars(other), "found": other.found + 1})
                break
        else:
            kept.append(candidate)
    return kept
