"""Update with one law: search, posterior and results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.special import logsumexp

from jackettwin.arrays import FloatArray
from jackettwin.errors import NumericalError
from jackettwin.intervals import QUANTILES, interval_90
from jackettwin.processes import on_one_blas_thread
from jackettwin.progress import SILENT, Progress
from jackettwin.updating.budget import Budget, budget_of_draws, damping_budget
from jackettwin.updating.data.misfit import misfit
from jackettwin.updating.model import ExactModes, SupportModel
from jackettwin.updating.nuisance_parameters import DASHPOTS
from jackettwin.updating.posterior.identifiability import Verdict, identifiability
from jackettwin.updating.posterior.laplace import laplace_draws, log_covariance
from jackettwin.updating.posterior.nested_sampling import sample_nested
from jackettwin.updating.posterior.predictive import Missed, Predictive, predict_quantities
from jackettwin.updating.posterior.smc import Posterior, sample_posterior
from jackettwin.updating.problem import Problem
from jackettwin.updating.search.profile import Profile, profile
from jackettwin.updating.search.solutions import (
    LOCKED_DAMPER,
    MOST_EVALUATIONS,
    Search,
    SearchMethod,
    Solution,
    search,
)

Sampler = Literal["smc", "nested"]

_PREDICTED = (1, 2, 3, 4, 5)
"""Modes that are predicted, measured or not."""
_DRAWS = 400
"""Number of draws for predictions and damping budgets."""


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of the parameters, available if all targets have standard deviations.

    Attributes
    ----------
    posterior : Posterior or None
        None if it did not converge; then intervals are Laplace's.
    status : str
        ``"ok"``, or why there is no posterior.
    laplace_log_std : (d,) standard deviation of ln θ by Gauss–Newton
    log_theta : (n, d) draws from which all further attributes are computed
    """

    posterior: Posterior | None
    status: str
    laplace_log_std: FloatArray
    log_theta: FloatArray
    verdicts: tuple[Verdict, ...]
    predictive: Predictive
    profiles: tuple[Profile, ...]

    @property
    def log_std(self) -> FloatArray:
        """Standard deviation of ln θ, (d,)."""
        return np.asarray(self.log_theta.std(axis=0))

    @property
    def median(self) -> FloatArray:
        """Median of θ, (d,)."""
        return np.asarray(np.exp(np.median(self.log_theta, axis=0)))

    @property
    def interval_90(self) -> FloatArray:
        """Central 90 % interval of every θ, (d, 2)."""
        return np.asarray(np.exp(np.quantile(self.log_theta, QUANTILES[::2], axis=0)).T)


@dataclass(frozen=True)
class Fit:
    """Result of an update: the part that takes long to compute.

    Attributes
    ----------
    search : Search
        All solutions, best first, and the completeness of the list.
    modes : ExactModes
        Modes of the full model at the best solution, in the order of ``shown``.
    budget : Budget
        Sources of the damping of each of these modes.
    factors : (3, n_modes)
        Of the model's expected errors on these modes at the best solution, as of
        :meth:`jackettwin.updating.model_error.ErrorModel.factors`: by them, frequencies and damping ratios of
        ``modes`` become those of the asset.
    uncertainty : Uncertainty or None
        None if the targets have no standard deviations, or nothing was sampled.
    """

    search: Search
    modes: ExactModes
    budget: Budget
    factors: FloatArray
    uncertainty: Uncertainty | None = None


@dataclass(frozen=True, repr=False)
class Update:
    """A law fitted to targets.

    Attributes
    ----------
    problem : Problem
    model : SupportModel
        The updated model, with a band up to the highest mode in ``shown``.
    shown : mode numbers
        Mode numbers of ``modes`` and ``budget``: measured modes, fitted or not.
    fit : Fit
        The result.
    """

    problem: Problem
    model: SupportModel
    shown: tuple[int, ...]
    fit: Fit

    def __repr__(self) -> str:
        values = self.best.theta if self.uncertainty is None else self.uncertainty.median
        texts = (f"{p.name} {v:.3g}" for p, v in zip(self.problem.parameters, values, strict=True))
        kind = "best fit" if self.uncertainty is None else "median"
        return f"Update({self.law!r}, {kind}: {', '.join(texts)}; {len(self.search.solutions)} solutions)"

    @property
    def search(self) -> Search:
        """All solutions, best first, and the completeness of the list."""
        return self.fit.search

    @property
    def solutions(self) -> tuple[Solution, ...]:
        """All solutions, best first."""
        return self.search.solutions

    @property
    def best(self) -> Solution:
        """The solution of lowest cost near the data without a locked damper; else that of lowest cost."""
        return best_solution(self.search.solutions)

    @property
    def modes(self) -> ExactModes:
        """The shown modes of the full model at the best solution."""
        return self.fit.modes

    @property
    def central_hz(self) -> FloatArray:
        """Reported frequencies of the shown modes: medians of the posterior, else the best fit.

        Both are of the asset, with the errors of the model that the data ask for.
        """
        known = self.uncertainty
        return self._central(
            self.fit.factors[0] * self.modes.frequency_hz,
            None if known is None else known.predictive.frequency_hz,
        )

    @property
    def central_undamped_hz(self) -> FloatArray:
        """The same of the undamped asset."""
        known = self.uncertainty
        return self._central(
            self.fit.factors[0] * self.modes.undamped_hz,
            None if known is None else known.predictive.undamped_hz,
        )

    @property
    def central_damping(self) -> FloatArray:
        """Reported damping ratios of the shown modes, likewise: what the sources add up to."""
        whole = self.budget.damping_ratio.sum(axis=1)
        return np.asarray(np.where(np.isnan(whole), self.fit.factors[1] * self.modes.damping_ratio, whole))

    def _central(self, best: FloatArray, draws: FloatArray | None) -> FloatArray:
        out = np.array(best, dtype=np.float64)
        if draws is not None and self.uncertainty is not None:
            predicted = self.uncertainty.predictive.modes
            for i, mode in enumerate(self.shown):
                known = interval_90(draws[:, predicted.index(mode)]) if mode in predicted else None
                out[i] = out[i] if known is None else known[1]
        return out

    @property
    def budget(self) -> Budget:
        """Sources of the damping of each of these modes."""
        return self.fit.budget

    def open_dashpot(self, label: str) -> str:
        """Return the rotor's dashpot along a mode if no datum and no prior constrains it, else ``""``."""
        known = () if self.uncertainty is None else self.uncertainty.verdicts
        for p, verdict in zip(self.problem.parameters, known, strict=False):
            along = p.name in DASHPOTS and label.startswith(p.name.removeprefix("c_"))
            if along and p.median is None and verdict.verdict == "unidentified":
                return p.name
        return ""

    @property
    def uncertainty(self) -> Uncertainty | None:
        """Uncertainty of the parameters; None without standard deviations, or if not sampled."""
        return self.fit.uncertainty

    @property
    def law(self) -> str:
        """Name of the law."""
        return self.model.family.name


@on_one_blas_thread
def update(
    problem: Problem,
    *,
    modes: tuple[int, ...] | None = None,
    method: SearchMethod = "least-squares",
    starts: int | Sequence[Mapping[str, float]] = 32,
    particles: int = 150,
    sampler: Sampler = "smc",
    seed: int = 0,
    most_evaluations: int = MOST_EVALUATIONS,
    sampled: bool = True,
    progress: Progress = SILENT,
) -> Update:
    """Return all solutions of one law, the best one with the full model, and its uncertainty.

    Parameters
    ----------
    modes : mode numbers, optional
        Modes of the full model to report; default: those of the first operating state's data.
    starts : int or sequence of {parameter: value}
        Number of scattered starts of the search, or the starting points.
    particles : int
        Number of particles of each of the posterior's four islands, or of live points of each nested run;
        doubled once if they disagree.
    sampler : {"smc", "nested"}
        Tempered sequential Monte Carlo, or dynesty.
    most_evaluations : int
        Number of evaluations after which the search adds no further starts.
    sampled : bool
        Whether the posterior is sampled; otherwise there is no uncertainty.
    progress : Progress
        Receives the present step and its progress.

    Raises
    ------
    InputError
        If no start of the search ends in a minimum.
    """
    found = search(
        problem, method=method, starts=starts, seed=seed, most_evaluations=most_evaluations, progress=progress
    )
    shown = problem.states[0].residuals.modes if modes is None else modes
    model = problem.model.reaching(max(shown))
    theta = _first(problem, np.log(best_solution(found.solutions).theta)[None])[0]
    factors = _expected_factors(problem, model, shown, best_solution(found.solutions))
    budget = damping_budget(model, theta, shown, factors=factors)
    fit = Fit(found, model.exact_modes(theta, shown), budget, factors[:, 0])
    fitted = Update(problem, model, shown, fit)
    if not sampled:
        return fitted
    return with_posterior(fitted, particles=particles, sampler=sampler, seed=seed, progress=progress)


def with_posterior(
    fitted: Update,
    *,
    particles: int = 150,
    sampler: Sampler = "smc",
    seed: int = 0,
    progress: Progress = SILENT,
) -> Update:
    """Return a fitted law with its posterior and results from it; unchanged without standard deviations."""
    problem, model, shown = fitted.problem, fitted.model, fitted.shown
    if not problem.weighted:
        return fitted
    posterior, status = posterior_or_status(
        problem, sampler=sampler, particles=particles, seed=seed, progress=progress
    )
    progress.within("verdicts, profiles and predictions")
    uncertainty = _uncertainty(problem, model, shown, fitted.best, posterior, status, seed)
    predicted = uncertainty.predictive
    which = [predicted.modes.index(mode) for mode in shown]
    budget = budget_of_draws(shown, predicted.sources[:, which])
    return replace(fitted, fit=replace(fitted.fit, budget=budget, uncertainty=uncertainty))


def law_probability(updates: Sequence[Update]) -> dict[str, float] | None:
    """Return the probability of each law with equal priors; None unless the evidence of all is known."""
    found = [u.uncertainty.posterior for u in updates if u.uncertainty is not None]
    known = [posterior for posterior in found if posterior is not None and posterior.evidence_known]
    if len(known) < len(updates):
        return None
    log_z = np.array([posterior.log_evidence for posterior in known])
    probability = np.exp(log_z - logsumexp(log_z))
    return {u.law: float(p) for u, p in zip(updates, probability, strict=True)}


def best_solution(solutions: Sequence[Solution]) -> Solution:
    """Return the best solution without a locked damper, if its frequencies are near those of the lowest.

    A locked damper is implausible because the undamped structure then differs strongly from the measurements.
    If all solutions without one differ as strongly, the solution of lowest cost is returned.

    Parameters
    ----------
    solutions : solutions in order of cost
    """
    cheapest = solutions[0]
    for s in solutions:
        apart = abs(s.frequency_hz / cheapest.frequency_hz - 1.0)
        if not s.locked_damper and (apart <= LOCKED_DAMPER).all():
            return s
    return cheapest


def _first(problem: Problem, z: FloatArray) -> FloatArray:
    """Return the model's parameter vectors in the first operating state."""
    return problem.vectors(z, problem.states[0])


def _thinned(z: FloatArray) -> FloatArray:
    return z[:: max(1, len(z) // _DRAWS)][:_DRAWS]


def _uncertainty(
    problem: Problem,
    model: SupportModel,
    shown: tuple[int, ...],
    best: Solution,
    posterior: Posterior | None,
    status: str,
    seed: int,
) -> Uncertainty:
    z = laplace_draws(problem, best.theta, seed=seed) if posterior is None else posterior.log_theta
    some = _thinned(z)
    beyond = [m for m in shown if m not in _PREDICTED]
    known = tuple(m for m in _PREDICTED if m <= model.highest_mode)
    return Uncertainty(
        posterior=posterior,
        status=status,
        laplace_log_std=np.sqrt(np.diag(log_covariance(problem, best.theta))),
        log_theta=z,
        verdicts=identifiability(
            problem, z, seed=seed, converged=posterior is not None, misfit=misfit(problem, best.theta)
        ),
        predictive=predict_quantities(
            model,
            _first(problem, some),
            (*known, *beyond),
            problem.states[0].relaxations,
            _missed(problem, model, some, seed),
        ),
        profiles=tuple(profile(problem, best.theta, j) for j in range(len(problem.parameters))),
    )


def _expected_factors(
    problem: Problem, model: SupportModel, shown: tuple[int, ...], best: Solution
) -> FloatArray:
    """Return the factors (3, 1, n_modes) of the model's expected errors on modes at a solution.

    They are one without errors of the model, and where the model lacks a mode.
    """
    if problem.error_model is None or not problem.weighted:
        return np.ones((3, 1, len(shown)))
    z = np.log(best.theta)[None]
    found = model.predict_many(_first(problem, z), shown, slopes=False)
    errors, own = problem.expected_errors(z), problem.error_model.on(model.condensed)
    # remainders without data are expected to be zero: nothing is drawn
    factors = own.factors(found, errors, problem.error_data, np.random.default_rng(0))
    return np.where(np.isnan(factors), 1.0, factors)


def _missed(problem: Problem, model: SupportModel, z: FloatArray, seed: int) -> Missed | None:
    """Return the model errors as a function of draws (n, d), to convert the model's modes to the asset's."""
    if problem.error_model is None:
        return None
    rng = np.random.default_rng(seed)
    errors, own = problem.drawn_errors(z, rng), problem.error_model.on(model.condensed)
    return lambda found: own.factors(found, errors, problem.error_data, rng)


def posterior_or_status(
    problem: Problem,
    *,
    sampler: Sampler = "smc",
    particles: int = 150,
    seed: int = 0,
    progress: Progress = SILENT,
) -> tuple[Posterior | None, str]:
    """Return the posterior and ``"ok"``, or None and why it did not converge.

    If it has not converged or its evidence is not known, twice as many draws are tried.
    """
    found, status = None, "ok"
    for n in (particles, 2 * particles):
        try:
            if sampler == "nested":
                found = sample_nested(problem, live=n, seed=seed, progress=progress)
            else:
                found = sample_posterior(problem, particles=n, seed=seed, progress=progress)
        except NumericalError as error:
            status = str(error)
        if found is not None and found.evidence_known:
            break
    return found, "ok" if found is not None else status
