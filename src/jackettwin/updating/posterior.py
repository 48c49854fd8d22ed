r"""Posterior and evidence of one law by tempered sequential Monte Carlo.

Particles drawn from the prior go through a ladder of tempered posteriors
prior · Lᵝ, β from 0 to 1; each rung reweights, resamples and moves them (Del Moral, Doucet & Jasra 2006;
Ching & Chen 2007). The mean weights multiply to the evidence,

.. math:: Z = \prod_t \frac{1}{n}\sum_i L(θ_i)^{β_{t+1}-β_t}.

Several independent islands run side by side: only if they agree is the result called a posterior.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import logsumexp

from jackettwin.errors import InputError, NumericalError
from jackettwin.response.numbered import NumberedModes
from jackettwin.updating.convergence import Convergence, convergence
from jackettwin.updating.prior import Prior
from jackettwin.updating.problem import Found, Problem

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]
BoolArray = npt.NDArray[np.bool_]

_ESS = 0.5
"""Each rung of the ladder keeps this share of the particles effective."""
_MOVES = 12
"""Moves of every particle on every rung."""
_LARGEST_SPREAD = 0.5
"""Standard deviation of log Z between islands beyond which it is not known."""


@dataclass(frozen=True)
class Posterior:
    """Draws from the posterior of one law.

    Attributes
    ----------
    log_theta : (n_draws, n_parameters) equally weighted
    poles : (n_draws, n_modes) of the target modes in the first state
    log_likelihood : (n_draws,)
    log_evidence, log_evidence_std : float
        Mean over the islands and its standard deviation.
    convergence : Convergence
        How well the islands agree.
    """

    log_theta: FloatArray
    poles: ComplexArray
    log_likelihood: FloatArray
    log_evidence: float
    log_evidence_std: float
    convergence: Convergence

    def interval(self, level: float = 0.9) -> FloatArray:
        """Return the central interval of every parameter, (n_parameters, 2)."""
        tail = 0.5 * (1.0 - level)
        return np.asarray(np.exp(np.quantile(self.log_theta, [tail, 1.0 - tail], axis=0)).T)


@dataclass
class _Swarm:
    """Particles of one island and what is known of them."""

    z: FloatArray
    log_l: FloatArray
    log_p: FloatArray
    found: Found

    def take(self, index: npt.NDArray[np.intp]) -> None:
        self.z, self.log_l, self.log_p = self.z[index], self.log_l[index], self.log_p[index]
        self.found = tuple(_pick(modes, index) for modes in self.found)

    def accept(self, yes: BoolArray, other: _Swarm) -> None:
        self.z = np.where(yes[:, None], other.z, self.z)
        self.log_l = np.where(yes, other.log_l, self.log_l)
        self.log_p = np.where(yes, other.log_p, self.log_p)
        self.found = tuple(_either(yes, *pair) for pair in zip(other.found, self.found, strict=True))


def sample_posterior(
    problem: Problem,
    *,
    prior: Prior | None = None,
    particles: int = 300,
    islands: int = 4,
    seed: int = 0,
    progress: Callable[[], None] | None = None,
) -> Posterior:
    """Return the posterior of a problem's parameters.

    Parameters
    ----------
    problem : Problem
        Its residuals weighted by standard deviations, not relative.
    prior : Prior, optional
        Instead of the problem's.
    particles, islands : int
        Particles on each of the independent islands.
    progress : callable, optional
        Called after each rung of each island's ladder.

    Raises
    ------
    InputError
        If the residuals carry no standard deviations: there is no likelihood.
    NumericalError
        If the islands do not agree: there are draws, but they are no posterior.
    """
    if not problem.weighted:
        raise InputError(
            "no standard deviations, no likelihood",
            field="targets",
            remedy="give every target frequency and damping ratio its standard deviation",
        )
    rng = np.random.default_rng(seed)
    runs = [
        _island(problem, prior or problem.prior, particles, child, progress) for child in rng.spawn(islands)
    ]
    return gathered(
        problem,
        z=np.array([swarm.z for swarm, _ in runs]),
        poles=np.array([swarm.found[0].poles for swarm, _ in runs]),
        log_l=np.array([swarm.log_l for swarm, _ in runs]),
        log_z=np.array([value for _, value in runs]),
    )


def gathered(
    problem: Problem, *, z: FloatArray, poles: ComplexArray, log_l: FloatArray, log_z: FloatArray
) -> Posterior:
    """Return the posterior of independent runs.

    Parameters
    ----------
    z : (n_runs, n_draws, n_parameters)
    poles : (n_runs, n_draws, n_modes)
    log_l : (n_runs, n_draws)
    log_z : (n_runs,)

    Raises
    ------
    NumericalError
        If the runs do not agree: there are draws, but they are no posterior.
    """
    found, spread = convergence(z), float(log_z.std(ddof=1))
    if found.problem is not None or not spread <= _LARGEST_SPREAD:
        worst = problem.parameters[int(np.argmax(found.rhat))].name
        why = found.problem or "runs apart"
        raise NumericalError(
            f"the posterior did not converge: {why} ({worst}), log evidence ±{spread:.2f}; "
            "more particles may help"
        )
    return Posterior(
        log_theta=z.reshape(-1, z.shape[2]),
        poles=poles.reshape(-1, poles.shape[2]),
        log_likelihood=log_l.ravel(),
        log_evidence=float(logsumexp(log_z) - np.log(log_z.size)),
        log_evidence_std=spread / np.sqrt(log_z.size),
        convergence=found,
    )


def _island(
    problem: Problem,
    prior: Prior,
    n: int,
    rng: np.random.Generator,
    progress: Callable[[], None] | None,
) -> tuple[_Swarm, float]:
    z = prior.draw(n, rng)
    swarm = _evaluate(problem, prior, z, problem.anchor(z.mean(axis=0)))
    beta, log_z = 0.0, 0.0
    while beta < 1.0:
        step = _next_step(swarm.log_l, 1.0 - beta)
        weight = step * swarm.log_l
        log_z += float(logsumexp(weight) - np.log(n))
        beta += step
        swarm.take(_systematic(np.exp(weight - logsumexp(weight)), rng))
        for move in range(_MOVES):
            z = _proposal(swarm.z, rng, wide=move % 4 == 3)
            inside: BoolArray = np.isfinite(prior.log_density(z))
            trial = _evaluate(problem, prior, np.where(inside[:, None], z, swarm.z), swarm.found)
            log_ratio = beta * (trial.log_l - swarm.log_l) + trial.log_p - swarm.log_p
            swarm.accept(inside & (np.log1p(-rng.random(n)) < log_ratio), trial)
        if progress is not None:
            progress()
    return swarm, log_z


def _evaluate(problem: Problem, prior: Prior, z: FloatArray, near: Found | None) -> _Swarm:
    log_l, found = problem.log_likelihood(z, near)
    return _Swarm(z, log_l, prior.log_density(z), found)


def _next_step(log_l: FloatArray, most: float) -> float:
    """Return the step of β that leaves the effective sample size at its share, by bisection."""

    def effective(step: float) -> float:
        w = step * log_l
        return float(np.exp(2.0 * logsumexp(w) - logsumexp(2.0 * w))) / log_l.size

    if effective(most) >= _ESS:
        return most
    low, high = 0.0, most
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if effective(middle) >= _ESS else (low, middle)
    return high


def _systematic(weight: FloatArray, rng: np.random.Generator) -> npt.NDArray[np.intp]:
    u = (rng.random() + np.arange(weight.size)) / weight.size
    return np.minimum(np.searchsorted(np.cumsum(weight), u), weight.size - 1)


def _proposal(z: FloatArray, rng: np.random.Generator, *, wide: bool) -> FloatArray:
    """Return differential-evolution steps (ter Braak 2006): they follow the shape of the swarm."""
    n, d = z.shape
    a = (np.arange(n) + rng.integers(1, n, n)) % n
    b = (a + rng.integers(1, n, n)) % n
    # full steps now and then jump between separate hills
    gamma = 1.0 if wide else 2.38 / np.sqrt(2.0 * d) * rng.uniform(0.2, 1.0)
    jitter = 0.02 * z.std(axis=0) * rng.standard_normal(z.shape)
    return np.asarray(z + gamma * (z[a] - z[b]) + jitter)


def _either(yes: BoolArray, new: NumberedModes, old: NumberedModes) -> NumberedModes:
    return NumberedModes(
        np.where(yes[:, None], new.poles, old.poles),
        np.where(yes[:, None, None], new.shapes, old.shapes),
        old.slopes,
        old.shape_slopes,
        np.where(yes, new.status, old.status),
    )


def _pick(found: NumberedModes, index: npt.NDArray[np.intp]) -> NumberedModes:
    return NumberedModes(
        found.poles[index], found.shapes[index], found.slopes[index], found.shape_slopes, found.status[index]
    )
