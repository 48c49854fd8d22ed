"""Posterior of one law by tempered sequential Monte Carlo, and its evidence.

Particles drawn from the prior pass through a sequence of tempered posteriors prior · Lᵝ, with β from 0 to 1.
At each stage they are reweighted and resampled (Del Moral, Doucet & Jasra 2006; Ching & Chen 2007), and new
ones are drawn from a mixture of normals, centred at the remaining particles and at the maxima of the
posterior. As the density of the mixture is known, the next weights are exact for any mixture (population
Monte Carlo, Cappé et al. 2004), and a sharp posterior from years of data needs no more stages than one from
some days. If the mixture fits badly, and at the last stage, Markov chains move the particles. Several
independent islands are run; the result is accepted as a posterior only if they agree. Their draws give the
evidence (:mod:`jackettwin.updating.posterior.evidence`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.linalg as la
from scipy.spatial import KDTree
from scipy.special import logsumexp

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from jackettwin.errors import InputError, NumericalError
from jackettwin.progress import SILENT, Progress
from jackettwin.updating.posterior.convergence import Convergence, convergence
from jackettwin.updating.posterior.evidence import Kernels, bridged_evidence, fitted, root_of
from jackettwin.updating.posterior.laplace import log_covariance
from jackettwin.updating.prior import Prior
from jackettwin.updating.problem import Found, Problem
from jackettwin.updating.search.descent import bottom

_ESS = 0.5
"""Share of effective particles after each stage."""
_REDRAWN = 0.65
"""New particles of a stage are used if at least this share is effective (``_ESS`` at the last stage);
otherwise Markov chains move the old ones. It exceeds ``_ESS`` so that the next step is long."""
_MOVES = 12
"""Number of moves of every particle at the last stage, and at stages without new particles."""
_KEPT = 3
"""Number of moves between draws at the last stage (waste-free, Dau & Chopin 2022)."""
_FRESH = 4
"""Ratio of the number of new points to that of particles."""
_CLIMBS = 12
"""Largest number of descents, which start from draws of the prior that are local maxima among the draws."""
_WIDER = (1.0, 1.5, 2.5)
"""Widths of the normals at a maximum, in Laplace deviations, as the posterior has heavier tails."""
_SCOUTS = 40
"""Number of particles of an island that are evaluated first; the others start from the modes of the nearest
one."""
_LARGEST_SPREAD = 0.5
"""Standard deviation of log Z between islands above which the evidence is not known."""


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
    names : names of the parameters
    runs : int
        Number of independent runs of equal length, whose draws are concatenated.
    convergence : Convergence
        Agreement of the islands.
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
class Swarm:
    """Particles with their modes and likelihoods."""

    z: FloatArray
    log_l: FloatArray
    log_p: FloatArray
    found: Found

    def take(self, index: IntArray) -> Swarm:
        """Return some of the particles."""
        return Swarm(
            self.z[index],
            self.log_l[index],
            self.log_p[index],
            tuple(modes.some(index) for modes in self.found),
        )

    def where(self, yes: BoolArray, other: Swarm) -> Swarm:
        """Return the swarm with the particles of another where ``yes``."""
        index = np.where(yes, np.arange(yes.size) + yes.size, np.arange(yes.size))
        return self.joined(other).take(index)

    def joined(self, other: Swarm) -> Swarm:
        """Return the particles of both."""
        return Swarm(
            np.concatenate([self.z, other.z]),
            np.concatenate([self.log_l, other.log_l]),
            np.concatenate([self.log_p, other.log_p]),
            tuple(a.joined(b) for a, b in zip(self.found, other.found, strict=True)),
        )


def sample_posterior(
    problem: Problem, *, particles: int = 300, islands: int = 4, seed: int = 0, progress: Progress = SILENT
) -> Posterior:
    """Return the posterior of a problem's parameters.

    Parameters
    ----------
    problem : Problem
        Problem whose residuals have standard deviations.
    particles, islands : int
        Number of particles of each island, and of independent islands.
    progress : Progress
        Receives a message after each stage of each island.

    Raises
    ------
    InputError
        If the residuals have no standard deviations, so that there is no likelihood.
    NumericalError
        If the islands disagree.
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
        If the runs disagree.
    """
    found, spread = convergence(z), float(log_z.std(ddof=1))
    if found.problem is not None or not np.isfinite(spread):
        worst = problem.parameters[int(np.argmax(found.rhat))].name
        raise NumericalError(
            f"the posterior did not converge: {found.problem or 'no evidence'} ({worst}), log evidence "
            f"scatters by {spread:.2f}; more particles may help"
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
    """Return the states of each particle in sequence, as a chain with its autocorrelation."""
    return np.asarray(np.stack(kept, axis=1).reshape(-1, *kept[0].shape[1:]))


def _island(
    problem: Problem, n: int, rng: np.random.Generator, place: str, progress: Progress
) -> list[Swarm]:
    """Return the last swarms of one island."""
    prior = problem.prior
    swarm = scouted(problem, prior.draw(n, rng))
    beta, log_q, tops = 0.0, swarm.log_p, None
    while True:
        scattered = swarm
        beta = _next_beta(swarm, log_q, beta, _ESS * n)
        weight = beta * swarm.log_l + swarm.log_p - log_q
        swarm = swarm.take(systematic(np.exp(weight - logsumexp(weight)), n, rng))
        tell = partial(progress.within, f"{place}: {beta:.0%}")
        tell()
        if beta == 1.0:
            return _walk(problem, prior, swarm, beta, rng, tell)
        tops = tops or _hilltops(problem, scattered)
        swarm, log_q = _renewed(problem, prior, swarm, beta, rng, tops, tell)


def scouted(problem: Problem, z: FloatArray) -> Swarm:
    """Return points (n, d) in random order with their modes: all start from the nearest of the first few."""
    prior, first, rest = problem.prior, z[:_SCOUTS], z[_SCOUTS:]
    swarm = _evaluate(problem, prior, first, problem.anchor(z.mean(axis=0)))
    return swarm.joined(_evaluate(problem, prior, rest, _nearest(prior, rest, swarm))) if len(rest) else swarm


def _renewed(
    problem: Problem,
    prior: Prior,
    swarm: Swarm,
    beta: float,
    rng: np.random.Generator,
    tops: Kernels,
    tell: Callable[[], None],
) -> tuple[Swarm, FloatArray]:
    """Return new particles of the same tempered posterior, and ln of the density from which they are drawn.

    Half of them are drawn around the maxima of the posterior. If these fit well, the next step is the last
    one, however sharp the posterior is; and narrow maxima with few particles are not lost.
    """
    n = swarm.log_l.size
    mixture = fitted(swarm.z, prior.std, rng).evenly_with(tops)
    z = mixture.draw(2 * _FRESH * n, rng)
    z = z[np.isfinite(prior.log_density(z))][: _FRESH * n]
    fresh, log_q = _evaluate(problem, prior, z, _nearest(prior, z, swarm)), mixture.log_density(z)
    here, at_last = (_effective(b * fresh.log_l + fresh.log_p - log_q) for b in (beta, 1.0))
    if here >= _REDRAWN * n or at_last >= _ESS * n:
        return fresh, log_q
    moved = _walk(problem, prior, swarm, beta, rng, tell)[-1]
    return moved, beta * moved.log_l + moved.log_p


def _hilltops(problem: Problem, scattered: Swarm) -> Kernels:
    """Return normals around the maxima of the posterior that are reached from draws of the prior."""
    centres: list[FloatArray] = []
    roots: list[FloatArray] = []
    for i in _tops(scattered):
        z = bottom(problem, scattered.z[i], tuple(modes.some(np.array([i])) for modes in scattered.found))
        root = root_of(log_covariance(problem, np.exp(z)))
        apart = [la.solve_triangular(root, z - centre, lower=True) for centre in centres]
        if all(x @ x > 1.0 for x in apart):
            centres += [z] * len(_WIDER)
            roots += [wider * root for wider in _WIDER]
    return Kernels(np.array(centres), np.array(roots))


def _tops(swarm: Swarm) -> IntArray:
    """Return the most likely few of the particles that are more likely than all their neighbours."""
    x = swarm.z / np.ptp(swarm.z, axis=0)
    _, near = KDTree(x).query(x, k=min(2 * x.shape[1] + 1, len(x)))
    top = np.flatnonzero(swarm.log_l >= swarm.log_l[near].max(axis=1))
    return np.asarray(top[np.argsort(-swarm.log_l[top])][:_CLIMBS])


def _walk(
    problem: Problem,
    prior: Prior,
    swarm: Swarm,
    beta: float,
    rng: np.random.Generator,
    tell: Callable[[], None],
) -> list[Swarm]:
    """Return the states of the swarm after every few moves."""
    kept = []
    for move in range(1, _MOVES + 1):
        swarm = _moved(problem, prior, swarm, beta, rng, wide=move % 4 == 0)
        tell()
        if move % _KEPT == 0:
            kept.append(swarm)
    return kept


def _moved(
    problem: Problem, prior: Prior, swarm: Swarm, beta: float, rng: np.random.Generator, *, wide: bool
) -> Swarm:
    """Return the swarm after one move of each half by differences of the other.

    The half that provides the differences is not moved, which leaves the joint distribution exactly
    invariant; if all particles move at once by their own differences, the result is a few per cent too
    narrow.
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


def _nearest(prior: Prior, z: FloatArray, known: Swarm) -> Found:
    """Return for each point the modes of the nearest particle (distance relative to the bounds) as start."""
    width = prior.high - prior.low
    _, nearest = KDTree(known.z / width).query(z / width)
    return tuple(modes.some(np.asarray(nearest)) for modes in known.found)


def _evaluate(problem: Problem, prior: Prior, z: FloatArray, near: Found | None) -> Swarm:
    log_l, found = problem.log_likelihood(z, near)
    return Swarm(z, log_l, prior.log_density(z), found)


def _next_beta(swarm: Swarm, log_q: FloatArray, beta: float, least: float) -> float:
    """Return the largest β up to 1 with at least a given share of effective particles, by bisection."""

    def enough(at: float) -> bool:
        return _effective(at * swarm.log_l + swarm.log_p - log_q) >= least

    if enough(1.0):
        return 1.0
    low, high = beta, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if enough(middle) else (low, middle)
    return high


def _effective(log_weight: FloatArray) -> float:
    """Return the effective number of particles of unequal weights."""
    w = np.exp(log_weight - log_weight.max())
    return float(w.sum() ** 2 / (w @ w))


def systematic(weight: FloatArray, n: int, rng: np.random.Generator) -> IntArray:
    """Return the indices of n draws with given probabilities by systematic resampling."""
    u = (rng.random() + np.arange(n)) / n
    return np.minimum(np.searchsorted(np.cumsum(weight), u), weight.size - 1)


def _proposal(z: FloatArray, others: FloatArray, rng: np.random.Generator, *, wide: bool) -> FloatArray:
    """Return differential-evolution steps (ter Braak 2006), which adapt to the shape of the swarm."""
    (n, d), m = z.shape, len(others)
    a = rng.integers(m, size=n)
    b = (a + rng.integers(1, m, n)) % m
    # occasional full steps jump between separate maxima
    gamma = 1.0 if wide else 2.38 / np.sqrt(2.0 * d) * rng.uniform(0.2, 1.0)
    jitter = 0.02 * others.std(axis=0) * rng.standard_normal(z.shape)
    return np.asarray(z + gamma * (others[a] - others[b]) + jitter)
