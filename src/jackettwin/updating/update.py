"""Fit one law and say what came of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jackettwin.updating.model import ExactModes, SupportModel
from jackettwin.updating.solutions import Method, Solution, search
from jackettwin.updating.targets import Residuals

FloatArray = npt.NDArray[np.float64]

_Z90 = 1.6448536269514722
IDENTIFIED, WEAK = 0.3, 0.8
"""Posterior over prior standard deviation of ln θ below which a parameter is identified, or weakly so."""


@dataclass(frozen=True)
class Update:
    """A law fitted to targets.

    Attributes
    ----------
    model : SupportModel
    residuals : Residuals
    solutions : tuple of Solution
        Every distinct end point, best first.
    best : Solution
        The cheapest one without a locked damper; the cheapest of all if every one is locked.
    modes : ExactModes
        Of the full model at the best solution, in the order of ``residuals.modes``.
    log_std : (n_parameters,) standard deviation of ln θ, or None if the targets carry no covariance
    """

    model: SupportModel
    residuals: Residuals
    solutions: tuple[Solution, ...]
    best: Solution
    modes: ExactModes
    log_std: FloatArray | None

    @property
    def law(self) -> str:
        """Name of the law."""
        return self.model.family.name

    def interval_90(self) -> list[tuple[float, float] | None]:
        """Return the 90 % interval of each parameter, clipped to its bounds."""
        if self.log_std is None:
            return [None] * len(self.model.parameters)
        return [
            (max(p.low, value * float(np.exp(-_Z90 * s))), min(p.high, value * float(np.exp(_Z90 * s))))
            for p, value, s in zip(self.model.parameters, self.best.theta, self.log_std, strict=True)
        ]

    def identifiability(self) -> list[str | None]:
        """Return per parameter ``identified``, ``weak`` or ``unidentified``, against a flat prior of ln θ."""
        if self.log_std is None:
            return [None] * len(self.model.parameters)
        prior = np.log([p.high / p.low for p in self.model.parameters]) / np.sqrt(12.0)
        verdicts: list[str | None] = []
        for ratio in self.log_std / prior:
            verdicts.append(
                "identified" if ratio < IDENTIFIED else "weak" if ratio < WEAK else "unidentified"
            )
        return verdicts


def update(
    model: SupportModel,
    residuals: Residuals,
    *,
    method: Method = "least-squares",
    starts: int = 16,
    seed: int = 0,
    progress: Callable[[], None] | None = None,
) -> Update:
    """Return every solution of one law, the best one recomputed on the full model.

    Raises
    ------
    NumericalError
        If no start can follow the target modes.
    """
    solutions = search(model, residuals, method=method, starts=starts, seed=seed, progress=progress)
    best = next((s for s in solutions if not s.locked_damper), solutions[0])
    return Update(
        model=model,
        residuals=residuals,
        solutions=solutions,
        best=best,
        modes=model.exact_modes(best.theta, residuals.modes),
        log_std=None if residuals.relative else _log_std(model, residuals, best.theta),
    )


def log_covariance(model: SupportModel, residuals: Residuals, theta: FloatArray) -> FloatArray:
    """Return the covariance of ln θ: Gauss–Newton Hessian and a flat prior between the bounds."""
    prediction = model.predict(theta, residuals.modes)
    _, J = residuals.evaluate(prediction.poles, prediction.slopes)
    prior = np.log([p.high / p.low for p in model.parameters]) / np.sqrt(12.0)
    return np.asarray(np.linalg.inv(J.T @ J + np.diag(prior**-2.0)))


def _log_std(model: SupportModel, residuals: Residuals, theta: FloatArray) -> FloatArray:
    """Return the standard deviation of ln θ."""
    return np.asarray(np.sqrt(np.diag(log_covariance(model, residuals, theta))))
