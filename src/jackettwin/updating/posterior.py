"""Posterior of one law by tempered sequential Monte Carlo, and its evidence.

Particles drawn from the prior go through a ladder of tempered posteriors
prior · Lᵝ, β from 0 to 1; each rung reweights, resamples and moves them (Del Moral, Doucet & Jasra 2006;
Ching & Chen 2007). Several independent islands run side by side: only if they agree is the result called a
posterior. Their draws give the evidence (:mod:`jackettwin.updating.evidence`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree
from scipy.special import logsumexp

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError, NumericalError
from jackettwin.progress import SILENT, Progress
from jackettwin.updating.convergence import Convergence, convergence
from jackettwin.updating.evidence import bridged_evidence
from jackettwin.updating.prior import Prior
from jackettwin.updating.problem import Found, Problem

_ESS = 0.5
"""Each rung of the ladder keeps this share of the particles effective."""
_MOVES = 12
"""Moves of every particle on every rung."""
_KEPT = 3
"""On the last rung, the swarm after every so many moves is kept (waste-free, Dau & Chopin 2022)."""
_SCOUTS = 40
"""So many particles of an island are evaluated first, for the others to start near one of them."""
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
    evidence_known : bool
        Whether the islands agree on it.
    names : of the parameters
    runs : int
        Independent ones, each as long, one after the other.
    convergence : Convergence
        How well the islands agree.
    """

    log_theta: FloatArray
    poles: ComplexArray
    log_likelihood: FloatArray
    log_evidence: float
    log_evidence_std: float
    convergence: Convergence
    evidence_known: bool = True
    names: tuple[str, ...] = ()
    runs: int = 1

    def __repr__(self) -> str:
        ends = zip(self.names, self.interval(), strict=False)
        known = ", ".join(f"{name} {low:.3g} to {high:.3g}" for name, (low, high) in ends)
        return f"Posterior({len(self.log_theta)} draws; 90 %: {known})"

    def interval(self, level: float = 0.9) -> FloatArray:
        """Return the central interval of every parameter, (n_parameters, 2)."""
        tail = 0.5 * (1.0 - level)
        return np.asarray(np.exp(np.quantile(self.log_theta, [tail, 1.0 - tail], axis=0)).T)


@dataclass(frozen=True)
class _Swarm:
    """Particles of one island and what is known of them."""

    z: FloatArray
    log_l: FloatArray
    log_p: FloatArray
    found: Found

    def take(self, index: IntArray) -> _Swarm:
        return _Swarm(
            self.z[index],
            self.log_l[index],
            self.log_p[index],
            tuple(modes.some(index) for modes in self.found),
        )

    def where(self, yes: BoolArray, other: _Swarm) -> _Swarm:
        """Return the swarm with the particles of another where ``yes``."""
        index = np.where(yes, np.arange(yes.size) + yes.size, np.arange(yes.size))
        return self.joined(other).take(index)

    def joined(self, other: _Swarm) -> _Swarm:
        return _Swarm(
            np.concatenate([self.z, other.z]),
            np.concatenate([self.log_l, other.log_l]),
            np.concatenate([self.log_p, other.log_p]),
            tuple(a.joined(b) for a, b in zip(self.found, other.found, strict=True)),
        )


def sample_posterior(
    problem: Problem,
    *,
    particles: int = 300,
    islands: int = 4,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Posterior:
    """Return the posterior of a problem's parameters.

    Parameters
    ----------
    problem : Problem
        Its residuals weighted by standard deviations, not relative.
    particles, islands : int
        Particles on each of the independent islands.
    progress : Progress
        Told within the present step after each rung of each island's ladder.

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
    *streams, last = np.random.default_rng(seed).spawn(islands + 1)
    runs = []
    for i, stream in enumerate(streams, start=1):
        place = f"posterior, {particles} draws on island {i} of {islands}"
        runs.append(_island(problem, particles, stream, place, progress))
    z = np.array([_by_particle([swarm.z for swarm in kept]) for kept in runs])
    log_l = np.array([_by_particle([swarm.log_l for swarm in kept]) for kept in runs])
    near = problem.anchor(z.mean(axis=(0, 1)))
    log_z = bridged_evidence(lambda at: problem.log_likelihood(at, near)[0], problem.prior, z, log_l, last)
    poles = np.array([_by_particle([swarm.found[0].poles for swarm in kept]) for kept in runs])
    return gathered(problem, z=z, poles=poles, log_l=log_l, log_z=log_z)


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
    if found.problem is not None or not np.isfinite(spread):
        worst = problem.parameters[int(np.argmax(found.rhat))].name
        raise NumericalError(
            f"the posterior did not converge: {found.problem or 'no evidence'} ({worst}), log evidence "
            f"±{spread:.2f}; more particles may help"
        )
    return Posterior(
        log_theta=z.reshape(-1, z.shape[2]),
        poles=poles.reshape(-1, poles.shape[2]),
        log_likelihood=log_l.ravel(),
        log_evidence=float(logsumexp(log_z) - np.log(log_z.size)),
        log_evidence_std=spread / np.sqrt(log_z.size),
        convergence=found,
        evidence_known=spread <= _LARGEST_SPREAD,
        names=tuple(p.name for p in problem.parameters),
        runs=len(z),
    )


def _by_particle(kept: list[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """Return what was kept of each particle one after the other, as a chain that shows its correlation."""
    return np.asarray(np.stack(kept, axis=1).reshape(-1, *kept[0].shape[1:]))


def _island(
    problem: Problem, n: int, rng: np.random.Generator, place: str, progress: Progress
) -> list[_Swarm]:
    """Return the last swarms of one island."""
    prior = problem.prior
    z = prior.draw(n, rng)
    swarm = _evaluate(problem, prior, z[:_SCOUTS], problem.anchor(z.mean(axis=0)))
    if n > _SCOUTS:
        rest = z[_SCOUTS:]
        swarm = swarm.joined(_evaluate(problem, prior, rest, _nearest(prior, rest, swarm)))
    beta, kept = 0.0, [swarm]
    while beta < 1.0:
        step = _next_step(swarm.log_l, 1.0 - beta)
        weight = step * swarm.log_l
        beta += step
        swarm = swarm.take(_systematic(np.exp(weight - logsumexp(weight)), rng))
        kept = []
        for move in range(1, _MOVES + 1):
            swarm = _moved(problem, prior, swarm, beta, rng, wide=move % 4 == 0)
            if move % _KEPT == 0:
                kept.append(swarm)
            progress.within(f"{place}: {beta - step + step * move / _MOVES:.0%}")
    return kept


def _moved(
    problem: Problem, prior: Prior, swarm: _Swarm, beta: float, rng: np.random.Generator, *, wide: bool
) -> _Swarm:
    """Return the swarm after one move of each half by differences of the other.

    The half that lends the differences stands still, which leaves the joint distribution exactly invariant; a
    swarm that moves at once by its own differences ends a few per cent too narrow.
    """
    order = rng.permutation(swarm.log_l.size)
    still, moving = (swarm.take(half) for half in np.array_split(order, 2))
    for _ in range(2):
        z = _proposal(moving.z, still.z, rng, wide=wide)
        inside: BoolArray = np.isfinite(prior.log_density(z))
        z = np.where(inside[:, None], z, moving.z)
        trial = _evaluate(problem, prior, z, _nearest(prior, z, moving.joined(still)))
        log_ratio = beta * (trial.log_l - moving.log_l) + trial.log_p - moving.log_p
        moving = moving.where(inside & (np.log1p(-rng.random(len(z))) < log_ratio), trial)
        still, moving = moving, still
    return still.joined(moving).take(np.argsort(order))


def _nearest(prior: Prior, z: FloatArray, known: _Swarm) -> Found:
    """Return for each point the modes of the nearest particle, in shares of the bounds, to start from."""
    width = prior.high - prior.low
    _, nearest = KDTree(known.z / width).query(z / width)
    return tuple(modes.some(np.asarray(nearest)) for modes in known.found)


def _evaluate(problem: Problem, prior: Prior, z: FloatArray, near: Found | None) -> _Swarm:
    log_l, found = problem.log_likelihood(z, near)
    return _Swarm(z, log_l, prior.log_density(z), found)


def _next_step(log_l: FloatArray, most: float) -> float:
    """Return the step of β that leaves the effective sample size at its share, by bisection."""
    below = log_l - log_l.max()

    def effective(step: float) -> float:
        w = np.exp(step * below)
        return float(w.sum() ** 2 / (w @ w) / w.size)

    if effective(most) >= _ESS:
        return most
    low, high = 0.0, most
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if effective(middle) >= _ESS else (low, middle)
    return high


def _systematic(weight: FloatArray, rng: np.random.Generator) -> IntArray:
    u = (rng.random() + np.arange(weight.size)) / weight.size
    return np.minimum(np.searchsorted(np.cumsum(weight), u), weight.size - 1)


def _proposal(z: FloatArray, others: FloatArray, rng: np.random.Generator, *, wide: bool) -> FloatArray:
    """Return differential-evolution steps (ter Braak 2006): they follow the shape of the swarm."""
    (n, d), m = z.shape, len(others)
    a = rng.integers(m, size=n)
    b = (a + rng.integers(1, m, n)) % m
    # full steps now and then jump between separate hills
    gamma = 1.0 if wide else 2.38 / np.sqrt(2.0 * d) * rng.uniform(0.2, 1.0)
    jitter = 0.02 * others.std(axis=0) * rng.standard_normal(z.shape)
    return np.asarray(z + gamma * (others[a] - others[b]) + jitter)
