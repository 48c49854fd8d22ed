"""Models of unexplained variation estimated from a baseline, with their uncertainty.

Time constants and shares of the Ornstein-Uhlenbeck processes come from a family of spectra, from a single
process of hours to 1/f noise from hours to a season. Since a single estimate would be overconfident, several
models are combined, weighted by how well they predicted the baseline and later data.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize
from scipy.special import chdtr

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.watching.design import RegressionPrior
from jackettwin.watching.hours import Hours
from jackettwin.watching.memory import Belief, Filtered, Memory, empty_bank, filtered, prior_belief

Spectrum = tuple[tuple[float, ...], tuple[float, ...]]
"""Time constants [days] and shares of the variance."""

SHORT_DAYS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
"""Time constants of a single short process."""
LONG_DAYS = (12.0, 90.0)
"""Time constants of the two parts of an additional long process: weeks, and a season,
of which a year's baseline contains few independent values."""
LONG_SHARES = (0.02, 0.003, 0.06, 0.2)
"""Shares of the long process in the variance; the first is tried with every short one."""
OCTAVES = (0.1, 0.4, 1.6, 6.4, 25.6, 100.0)
"""Time constants of the processes that form a power law [days]."""
SLOPES = (-0.35, 0.0, 0.35)
"""Exponents of the shares as a power of the time constant; 0 gives 1/f noise over these times."""
_SCALE_STD, _SLOW_STD = 0.5, 1.5
"""Prior spread in ln of the factor on stated standard deviations, and of the slow processes' size."""
_LEAST = 1e-3
"""Smallest standard deviation of a process, in standard deviations of the quantity."""
SLOW_DAYS = 1.0
"""Time constant [days] from which processes have a separate correlation if no conditions are given: they then
include the effect of weather, common to all modes, whereas variation within a day is independent."""
AGREEMENT = (1.0, 0.7)
"""Shares of the estimated correlation between quantities that are tried."""
CORRELATIONS = np.array([-0.8, -0.5, -0.2, 0.1, 0.35, 0.6, 0.75, 0.85, 0.93, 0.98])
"""Correlations between two quantities that are tried."""
SHARED = np.append(CORRELATIONS, 0.995)
"""Correlations tried for slow processes if all modes share unmeasured weather."""
_LEAST_OWN, _LEAST_OWN_SHARED = 0.02, 0.005
"""Smallest eigenvalue of a correlation matrix, and its value if modes share unmeasured weather."""
_MOST_OWN = 0.5
"""Largest value that the smallest eigenvalue is raised to where few values are known."""
MOST_SPECTRA, MOST_TRIED = 3, 10
_HANDICAP = 1.5
"""Reduction of the log likelihood of a model with the time constants of a better one, so that the selected
models differ in their predictions."""
LARGER = (1.0, 1.3, 1.7)
"""Factors on the standard deviations of all slow processes, which a baseline may underestimate."""
STORMY = (1.0, 1.7, 3.0)
"""The same factors if no conditions are given: storms are rare and exceed the usual variation by far."""
_LEAST_FREEDOM = 4.0
ONE_LARGER = (2.0, 0.1)
"""Number of standard deviations of ln size by which the slow processes of one quantity may be larger,
and its probability."""
_LEAST_APART = 0.25
"""Smallest such difference; a smaller one hardly changes the predictions."""
_MOST_APART = 4
"""Number of quantities with such a model, the most uncertain first."""
_USUAL_APART = 0.2
"""Assumed standard deviation of ln size between quantities; a larger one is estimated."""
_APART = 0.3
_LIKELY = 7.0
"""Log likelihood below that of the best spectrum beyond which spectra are dropped."""
_FIRST_STEPS, _MORE_STEPS = 40, 16


@dataclass(frozen=True)
class LearntModels:
    """Models, the most likely first, and the state of each at the end of the baseline.

    Attributes
    ----------
    log_weights : (n_models,)
    """

    memories: tuple[Memory, ...]
    beliefs: tuple[Belief, ...]
    log_weights: FloatArray


def _beside(short: float, share: float) -> Spectrum:
    """Return the spectrum of a short process plus a share of the long one."""
    return (short, *LONG_DAYS), (1.0 - share, share / 2.0, share / 2.0)


def _power_law(slope: float) -> Spectrum:
    weight = np.array(OCTAVES) ** slope
    return OCTAVES, tuple(weight / weight.sum())


def learn(
    hours: Hours, prior: RegressionPrior, *, told: tuple[Spectrum, ...] = (), hidden: bool = False
) -> LearntModels:
    """Return the most likely models of a baseline.

    Under every spectrum, which is common to all quantities, the noise scale and the size of the slow
    processes are estimated for each quantity separately. The models are then weighted by all quantities
    together.

    Parameters
    ----------
    prior : prior of the coefficients
    told : spectra to choose from, if they are known
    hidden : whether no conditions are given, so that their effects belong to the unexplained variation
    """
    m = len(prior.std)
    single = [hours.of([q]) for q in range(m)]
    fits: dict[Spectrum, list[_Fit]] = {}

    def fit(spectra: list[Spectrum]) -> None:
        for spectrum in spectra:
            before = next(reversed(fits.values()), [None] * m)
            fits[spectrum] = [_alone(own, prior.of([q]), spectrum, before[q]) for q, own in enumerate(single)]

    def scores() -> dict[Spectrum, float]:
        return {spectrum: sum(one.score for one in found) for spectrum, found in fits.items()}

    fit([*told] or [*(_beside(short, LONG_SHARES[0]) for short in SHORT_DAYS), *map(_power_law, SLOPES)])
    total = scores()
    likely = [] if told else [days[0] for days, _ in total if total[days, _] > max(total.values()) - _LIKELY]
    fit([_beside(short, share) for short in SHORT_DAYS if short in likely for share in LONG_SHARES[1:]])
    total = scores()
    bases = [
        Memory(
            np.array([one.scale for one in fits[spectrum]]), np.array([one.std for one in fits[spectrum]]),
            np.array(spectrum[0]), np.array(spectrum[1]), np.stack([np.eye(m)] * len(spectrum[0])),
        )
        for spectrum in sorted(total, key=lambda one: -total[one])
        if total[spectrum] > max(total.values()) - _LIKELY
    ]  # fmt: skip
    return _weighed(bases[:MOST_TRIED], hours, prior, hidden)


def _weighed(bases: list[Memory], hours: Hours, prior: RegressionPrior, hidden: bool) -> LearntModels:
    """Return models with the correlation between quantities, weighted by all quantities together."""
    m = len(prior.std)
    freedom = np.array([_freedom(hours, q, bases[0], prior) for q in range(m)])
    fast, slow = _correlations(hours, bases[0], prior, np.maximum(freedom, _LEAST_FREEDOM), hidden)
    scored: list[tuple[float, Memory]] = []
    for base in bases:
        correlation = np.where((base.days < SLOW_DAYS)[:, None, None], fast, slow)
        each = [
            replace(base, correlation=share * correlation + (1.0 - share) * np.eye(m))
            for share in (AGREEMENT if m > 1 else (1.0,))
        ]
        found = [_end(memory, prior, hours).log_likelihood for memory in each]
        scored.append((float(np.logaddexp.reduce(found)), each[int(np.argmax(found))]))
    kept = _different(scored)
    freedom = np.array([_freedom(hours, q, kept[0][1], prior) for q in range(m)])
    shift, spread = _pooled(np.log(kept[0][1].std), 0.5 / np.maximum(freedom, _LEAST_FREEDOM))
    memories = [replace(memory, std=memory.std * np.exp(shift)) for _, memory in kept]
    first = memories[0]
    known = _LEAST_FREEDOM if hidden else max(float(np.median(freedom)) - m + 1.0, _LEAST_FREEDOM)
    factors = STORMY if hidden else LARGER
    larger = _larger(known, factors)
    apart = np.argsort(-spread)[: _MOST_APART if m > 1 else 0]
    one = ONE_LARGER[1] * (1.0 - ONE_LARGER[1]) ** max(len(apart) - 1, 0)
    memories += [replace(first, std=g * first.std) for g in factors[1:]]
    memories += [_one_larger(first, q, spread[q]) for q in apart]
    weights = np.exp([score - kept[0][0] for score, _ in kept])
    weights = weights / weights.sum() * (1.0 - one * len(apart)) * larger[0]
    beliefs = tuple(_end(memory, prior, hours).belief for memory in memories)
    return LearntModels(
        tuple(memories), beliefs, np.log([*weights, *larger[1:], *[one * larger[0] for _ in apart]])
    )


def _pooled(log_std: FloatArray, variance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the shift of ln size of each quantity towards the common size, and its remaining uncertainty.

    Sizes are assumed to scatter about a common one, by moments (DerSimonian & Laird 1986),
    so that a quantity whose size the baseline hardly determines is given that of the others.
    """
    weight = 1.0 / variance
    middle = weight @ log_std / weight.sum()
    excess = float(weight @ (log_std - middle) ** 2) - (len(log_std) - 1)
    between = max(excess / max(float(weight.sum() - weight @ weight / weight.sum()), 1e-12), _USUAL_APART**2)
    if len(log_std) == 1:
        return np.zeros(1), np.sqrt(variance)
    common = (log_std / (variance + between)).sum() / (1.0 / (variance + between)).sum()
    return (common - log_std) * variance / (variance + between), np.sqrt(1.0 / (weight + 1.0 / between))


def _one_larger(memory: Memory, q: int, spread: float) -> Memory:
    """Return a model in which the slow processes of one quantity are larger."""
    std = memory.std.copy()
    std[q] *= np.exp(max(ONE_LARGER[0] * spread, _LEAST_APART))
    return replace(memory, std=std)


def _different(scored: list[tuple[float, Memory]]) -> list[tuple[float, Memory]]:
    """Return the most likely models; those with the time constants of a better one are penalised."""
    left = list(scored)
    kept: list[tuple[float, Memory]] = []
    while left and len(kept) < MOST_SPECTRA:
        times = [one.days[0] for _, one in kept]
        best = max(left, key=lambda one: one[0] - _HANDICAP * times.count(one[1].days[0]))
        left = [one for one in left if one is not best]
        kept.append(best)
    return sorted(kept, key=lambda one: -one[0])


def _larger(freedom: float, factors: tuple[float, ...]) -> FloatArray:
    """Return the probabilities that slow processes are larger than estimated by these factors.

    If the covariance of processes is estimated from ν independent values, their deviations follow Student's t
    distribution with ν degrees of freedom: a normal one whose covariance is multiplied by ν/χ²_ν.
    """
    between = np.sqrt(np.array(factors[1:]) * np.array(factors[:-1]))
    above = np.append(chdtr(freedom, freedom / between**2), 0.0)
    share = np.concatenate([[1.0 - above[0]], above[:-1] - above[1:]])
    return np.asarray(np.maximum(share, 1e-12))


def _freedom(hours: Hours, q: int, memory: Memory, prior: RegressionPrior) -> float:
    """Return the number of independent values of a quantity's slow processes in the baseline.

    It follows from the variance 1/(2ν) of the logarithm of a standard deviation estimated from ν values.
    """
    own, of = hours.of([q]), memory.of([q])
    at = [
        _end(replace(of, std=of.std * np.exp(x)), prior.of([q]), own).log_likelihood
        for x in (-_APART, 0.0, _APART)
    ]
    return float(0.5 * (2.0 * at[1] - at[0] - at[2]) / _APART**2)


def _end(memory: Memory, prior: RegressionPrior, hours: Hours) -> Filtered:
    """Return the state of a model after the baseline."""
    belief = prior_belief(memory, prior)
    return filtered(memory, belief, empty_bank(len(prior.std), belief.mean.size), hours, -np.inf)


@dataclass(frozen=True)
class _Fit:
    """Scale and size of one quantity under a spectrum, and its log posterior."""

    scale: float
    std: float
    score: float


def _alone(own: Hours, prior: RegressionPrior, spectrum: Spectrum, near: _Fit | None) -> _Fit:
    """Return the most likely scale and size of one quantity; the search starts from ``near``."""
    spread = float(np.std(own.values))
    typical = float(np.sqrt(np.median(own.noise)))
    usual = np.log([1.0, max(0.3 * spread, 0.1 * typical)])
    at = usual if near is None else np.log([near.scale, near.std])
    low, high = np.log([_LEAST * spread, 10.0 * spread])
    days, shares = map(np.array, spectrum)

    def loss(x: FloatArray) -> float:
        y = np.clip(x, [-3.0, low], [3.0, high])
        memory = Memory(np.exp(y[:1]), np.exp(y[1:]), days, shares, np.ones((days.size, 1, 1)))
        penalty = ((y - usual) / [_SCALE_STD, _SLOW_STD]) ** 2
        outside = np.sum((x - y) ** 2)
        return float(0.5 * penalty.sum() + outside - _end(memory, prior, own).log_likelihood)

    steps = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.3]])
    found = minimize(
        loss, at, method="Nelder-Mead",
        options={
            "maxfev": _FIRST_STEPS if near is None else _MORE_STEPS, "initial_simplex": at + steps,
            "xatol": 0.03, "fatol": 0.05,
        },
    )  # fmt: skip
    scale, std = np.exp(np.clip(found.x, [-3.0, low], [3.0, high]))
    return _Fit(float(scale), float(std), -float(found.fun))


def _correlations(
    hours: Hours, memory: Memory, prior: RegressionPrior, freedom: FloatArray, hidden: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the correlations of fast and of slow processes, equal unless ``hidden``.

    Each is the posterior mean of a pair, reduced by what is chance. Fast and slow correlations are estimated
    in turn, twice, with the others fixed.

    Parameters
    ----------
    freedom : (m,) numbers of independent values of the slow processes
    """
    m = len(memory.scale)
    slow = memory.days >= SLOW_DAYS
    result = np.stack([np.eye(m)] * 2)
    for i in range(m):
        for j in range(i):
            own, pair, two = hours.of([j, i]), memory.of([j, i]), prior.of([j, i])
            each = _pair_mean(own, pair, two, np.zeros(slow.size), slow | ~slow, CORRELATIONS)
            for _ in range(2 if hidden and slow.any() else 0):
                each = _pair_mean(own, pair, two, each, slow, SHARED)
                each = _pair_mean(own, pair, two, each, ~slow, CORRELATIONS)
            result[:, i, j] = result[:, j, i] = [each[np.argmin(memory.days)], each[np.argmax(memory.days)]]
    # few values of many quantities always seem to leave a combination that hardly moves
    floor = 0.0 if hidden else min((m + 1.0) / (float(np.median(freedom)) + m + 1.0), _MOST_OWN)
    least = max(floor, _LEAST_OWN), max(floor, _LEAST_OWN_SHARED if hidden else _LEAST_OWN)
    return _beyond_chance(result[0], freedom, least[0]), _beyond_chance(result[1], freedom, least[1])


def _beyond_chance(correlation: FloatArray, freedom: FloatArray, least: float) -> FloatArray:
    """Return correlations (m, m), each reduced by its variance (1 − ρ²)²/ν over its square, at most to 0.

    This is the positive-part rule of James & Stein for each. Chance alone makes correlations of twice
    1/√ν, each of which leaves a combination of modes that hardly seems to move, in which any drift is a
    change. No eigenvalue is below ``least``.
    """
    off = correlation - np.eye(len(correlation))
    chance = (1.0 - off**2) ** 2 / np.sqrt(np.outer(freedom, freedom))
    reduced = off * np.maximum(1.0 - chance / np.maximum(off**2, 1e-12), 0.0)
    return _positive(reduced + np.eye(len(off)), least)


def _pair_mean(
    own: Hours, pair: Memory, prior: RegressionPrior, correlation: FloatArray, chosen: BoolArray,
    tried: FloatArray,
) -> FloatArray:  # fmt: skip
    """Return the correlations of two quantities' processes, (k,), chosen ones replaced by posterior means.

    The prior falls with 1 − ρ² (Lewandowski, Kurowicka & Joe 2009):
    quantities dominated by noise are therefore nearly independent.
    """
    if not chosen.any():
        return correlation
    each = np.where(chosen, tried[:, None], correlation)
    crossed = each[:, :, None, None] * (1.0 - np.eye(2)) + np.eye(2)
    likelihood = np.array([
        _end(replace(pair, correlation=one), prior, own).log_likelihood for one in crossed
    ])  # fmt: skip
    weight = np.exp(likelihood - likelihood.max()) * np.gradient(tried) * (1.0 - tried**2)
    return np.where(chosen, weight @ tried / weight.sum(), correlation)


def _positive(correlation: FloatArray, least: float) -> FloatArray:
    """Return the nearest correlation matrix with no eigenvalue below ``least``."""
    values, vectors = np.linalg.eigh(correlation)
    mended = (vectors * np.maximum(values, least)) @ vectors.T
    size = np.sqrt(np.diag(mended))
    return np.asarray(mended / np.outer(size, size))
