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
from jackettwin.updating.model import Prediction, SupportModel
from jackettwin.updating.targets import Residuals

FloatArray = npt.NDArray[np.float64]
Method = Literal["least-squares", "nelder-mead"]
METHODS = ("least-squares", "nelder-mead")

LOCKED_DAMPER = 0.05
"""Undamped frequencies further than this from the damped ones: the damper carries what the spring should."""
_LOST = 10.0
"""Residual of a mode that cannot be followed: worse than any that can."""


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
    model: SupportModel,
    residuals: Residuals,
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
    low, high = _log_bounds(model)
    run = _least_squares if method == "least-squares" else _nelder_mead
    ends = []
    for point in _scatter(low, high, starts, seed):
        ends.append(run(model, residuals, point, low, high))
        if progress is not None:
            progress()
    ends = [end for end in ends if np.isfinite(end[1])]
    if not ends:
        raise NumericalError("no start of the search could follow the target modes")
    return tuple(_distinct([_solution(model, residuals, z, cost, low, high) for z, cost in ends]))


def cost(model: SupportModel, residuals: Residuals, theta: FloatArray) -> float:
    """Return the cost (8.4) at a parameter vector."""
    r, _ = _Evaluator(model, residuals)(np.log(theta))
    return float(r @ r)


def _log_bounds(model: SupportModel) -> tuple[FloatArray, FloatArray]:
    return np.log([p.low for p in model.parameters]), np.log([p.high for p in model.parameters])


def _scatter(low: FloatArray, high: FloatArray, n: int, seed: int) -> FloatArray:
    sampler = qmc.Sobol(low.size, scramble=True, rng=np.random.default_rng(seed))
    power = int(np.ceil(np.log2(max(n, 2))))
    return np.asarray(low + (high - low) * sampler.random_base2(power)[:n])


class _Evaluator:
    """Residuals and Jacobian along one search path: each prediction starts from the one before."""

    def __init__(self, model: SupportModel, residuals: Residuals) -> None:
        self.model, self.residuals = model, residuals
        self.last: Prediction | None = None
        self.at: FloatArray | None = None
        self.values: tuple[FloatArray, FloatArray] = (np.zeros(0), np.zeros(0))

    def __call__(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return residuals and Jacobian; the last answer is remembered."""
        if self.at is None or not np.array_equal(z, self.at):
            self.values, self.at = self._evaluate(z), z.copy()
        return self.values

    def _evaluate(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        prediction = self.model.predict(np.exp(z), self.residuals.modes, near=self.last)
        if np.isnan(prediction.poles).any():
            self.last = None
            return np.full(self.residuals.count, _LOST), np.zeros((self.residuals.count, z.size))
        self.last = prediction
        return self.residuals.evaluate(prediction.poles, prediction.slopes)


def _least_squares(
    model: SupportModel, residuals: Residuals, start: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, float]:
    evaluate = _Evaluator(model, residuals)

    def values(z: FloatArray) -> FloatArray:
        return evaluate(z)[0]

    def jacobian(z: FloatArray) -> FloatArray:
        return evaluate(z)[1]

    fit = least_squares(
        values,
        start,
        jac=jacobian,
        bounds=(low, high),
        x_scale="jac",
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=120,
    )
    return np.asarray(fit.x), float(2.0 * fit.cost)


def _nelder_mead(
    model: SupportModel, residuals: Residuals, start: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, float]:
    evaluate = _Evaluator(model, residuals)

    def total(z: FloatArray) -> float:
        r, _ = evaluate(z)
        return float(r @ r)

    fit = minimize(
        total,
        start,
        method="Nelder-Mead",
        bounds=list(zip(low, high, strict=True)),
        options={"xatol": 1e-5, "fatol": 1e-14, "maxfev": 600},
    )
    return np.asarray(fit.x), float(fit.fun)


def _solution(
    model: SupportModel, residuals: Residuals, z: FloatArray, value: float, low: FloatArray, high: FloatArray
) -> Solution:
    theta = np.exp(z)
    poles = model.predict(theta, residuals.modes).poles
    damped, undamped = np.abs(poles) / (2.0 * np.pi), model.undamped_hz(theta, residuals.modes)
    apart = np.abs(undamped / damped - 1.0)
    on_bound = (z - low < 1e-3) | (high - z < 1e-3)
    return Solution(
        theta=theta,
        cost=value,
        frequency_hz=damped,
        undamped_hz=undamped,
        damping_ratio=np.asarray(-poles.real / np.abs(poles)),
        locked_damper=bool(np.isnan(apart).any() or (apart > LOCKED_DAMPER).any()),
        at_bound=tuple(p.name for p, flag in zip(model.parameters, on_bound, strict=True) if flag),
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
