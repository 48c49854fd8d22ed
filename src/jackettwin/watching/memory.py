"""What no condition explains: noise and slow processes, learnt from the baseline with their uncertainty.

No single set of variances and time constants is believed. Several models, weighted by how well they predicted
the baseline and whatever came after, predict together; a plugged-in estimate would be too sure of itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import minimize

from jackettwin.arrays import FloatArray
from jackettwin.watching.hours import Hours
from jackettwin.watching.kernels import filter_rows

SHORT_DAYS = (0.3, 1.0, 3.0, 8.0)
"""Time constants of the short process that are tried [days]."""
LONG_DAYS = (8.0, 60.0)
"""Time constants of the two parts of the long process [days]: weeks, and a season, of which a baseline of
a year
holds few independent values."""
LONG_SHARES = (0.5, 0.15, 0.85)
"""Shares of the slower part in the variance of the long process that are tried; each quantity alone is
fitted with
the first."""
_LONG_PRIOR = (0.4, 0.8)
"""Median of the long process's standard deviation over the short one's, and its spread in ln."""
_SCALE_STD, _SHORT_STD = 0.5, 1.5
"""Prior spread in ln of the factor on stated standard deviations, and of the short process."""
_LEAST = 1e-3
"""The least standard deviation of a process, in those of the quantity."""
LONG_FACTORS = (0.6, 1.0, 1.8, 3.0)
"""Other standard deviations of the long process that are tried beside the most likely one."""
AGREEMENT = (1.0, 0.7)
"""Shares of the estimated correlation between quantities that are tried."""
CORRELATIONS = np.array([-0.8, -0.5, -0.2, 0.1, 0.35, 0.6, 0.75, 0.85, 0.93, 0.98])
"""Correlations between two quantities that are tried."""
MOST_MODELS = 4
GUARDS = ((1.8, 0.5, 0.05),)
"""Factor on the long process, share of its slower part, and weight of models that the future may want
although the
baseline does not: a year cannot show what a season does only now and then."""
_FEW_STEPS = 90


@dataclass(frozen=True)
class Memory:
    """One model of what is unexplained in m quantities.

    Attributes
    ----------
    scale : (m,) factors on stated standard deviations
    short_std, long_std : (m,) standard deviations of the short and the long process
    short_days : time constant of the short one
    slower : share of the slower part in the variance of the long one
    correlation : (m, m) of each process between quantities
    """

    scale: FloatArray
    short_std: FloatArray
    long_std: FloatArray
    short_days: float
    slower: float
    correlation: FloatArray

    @property
    def rates(self) -> FloatArray:
        """Inverse time constants [1/day], (3,)."""
        return 1.0 / np.array([self.short_days, *LONG_DAYS])

    @property
    def slow(self) -> FloatArray:
        """Covariances of the short process and of both parts of the long one, (3, m, m)."""
        parts = (
            self.short_std,
            self.long_std * np.sqrt(1.0 - self.slower),
            self.long_std * np.sqrt(self.slower),
        )
        return np.stack([np.outer(std, std) * self.correlation for std in parts])


@dataclass(frozen=True)
class Belief:
    """What a model knows after some rows: the state of :mod:`jackettwin.watching.kernels`."""

    mean: FloatArray
    cov: FloatArray


def prior_belief(memory: Memory, coefficient_std: FloatArray) -> Belief:
    """Return the state before the first row.

    Parameters
    ----------
    coefficient_std : (m, p)
    """
    m, p = coefficient_std.shape
    slow = memory.slow
    cov = np.zeros((m * (p + len(slow)), m * (p + len(slow))))
    cov[range(m * p), range(m * p)] = coefficient_std.ravel() ** 2
    for k, one in enumerate(slow):
        place = slice(m * (p + k), m * (p + k + 1))
        cov[place, place] = one
    return Belief(np.zeros(len(cov)), cov)


@dataclass(frozen=True)
class Bank:
    """Steps that may have begun: how the state follows each, and what the innovations say of them.

    Attributes
    ----------
    response : (n_begins, m, n)
    info, score : (n_begins, m, m), (n_begins, m) of :func:`jackettwin.watching.kernels.filter_rows`
    """

    response: FloatArray
    info: FloatArray
    score: FloatArray


def empty_bank(m: int, n: int, begins: int = 0) -> Bank:
    """Return a bank of steps nothing is known of."""
    return Bank(np.zeros((begins, m, n)), np.zeros((begins, m, m)), np.zeros((begins, m)))


@dataclass(frozen=True)
class Filtered:
    """What came of some rows.

    Attributes
    ----------
    innovation, spread : (n_rows, m) ν and its variance
    log_likelihood : of rows and of the scatter inside hours
    """

    belief: Belief
    bank: Bank
    innovation: FloatArray
    spread: FloatArray
    log_likelihood: float


def filtered(memory: Memory, belief: Belief, bank: Bank, hours: Hours, last_day: float) -> Filtered:
    """Return belief and bank after some hours; ``last_day`` is when the belief was reached."""
    mean, cov = belief.mean.copy(), belief.cov.copy()
    grown = Bank(bank.response.copy(), bank.info.copy(), bank.score.copy())
    innovation, spread = np.empty(hours.values.shape), np.empty(hours.values.shape)
    before = last_day if np.isfinite(last_day) else float(hours.days[0]) if hours.days.size else 0.0
    likelihood = filter_rows(
        mean, cov, grown.response, grown.info, grown.score,
        np.ascontiguousarray(hours.rows), np.ascontiguousarray(hours.values),
        np.ascontiguousarray(hours.noise * memory.scale**2), np.diff(hours.days, prepend=before),
        memory.rates, memory.slow, innovation, spread,
    )  # fmt: skip
    return Filtered(Belief(mean, cov), grown, innovation, spread, likelihood + _scatter(memory, hours))


def _scatter(memory: Memory, hours: Hours) -> float:
    """Return the log likelihood of the scatter inside hours, up to what no model changes."""
    chi2, freedom = hours.chi2.sum(axis=0), hours.freedom.sum(axis=0)
    return float(-0.5 * np.sum(chi2 / memory.scale**2 + freedom * np.log(memory.scale**2)))


@dataclass(frozen=True)
class Learnt:
    """Models and what each knows at the end of the baseline.

    Attributes
    ----------
    log_weights : (n_models,) ln of posterior probabilities
    """

    memories: tuple[Memory, ...]
    beliefs: tuple[Belief, ...]
    log_weights: FloatArray


def learn(hours: Hours, coefficient_std: FloatArray) -> Learnt:
    """Return the models that a baseline leaves, the most likely first.

    Each quantity alone gives its variances for each time constant of the short process; correlations come
    from what is left at common times; then all quantities together weigh the models.

    Parameters
    ----------
    coefficient_std : (m, p) prior standard deviations
    """
    m = coefficient_std.shape[0]
    extent = np.nanstd(hours.values, axis=0)
    alone = [[_alone(hours, q, coefficient_std[q], days, extent[q]) for days in SHORT_DAYS] for q in range(m)]
    total = np.array([[found[1] for found in row] for row in alone]).sum(axis=0)
    likely = np.flatnonzero(total > total.max() - 6.0)
    likely = likely[np.argsort(-total[likely])][:2]
    candidates, kinds = [], []
    for k in likely:
        parts = np.array([alone[q][k][0] for q in range(m)])
        long_std = _alike(parts[:, 2])
        base = Memory(parts[:, 0], parts[:, 1], long_std, SHORT_DAYS[k], LONG_SHARES[0], np.eye(m))
        correlation = _correlation(hours, base, coefficient_std)
        for agreement in AGREEMENT if m > 1 else (1.0,):
            shrunk = agreement * correlation + (1.0 - agreement) * np.eye(m)
            for kind in product(LONG_SHARES, LONG_FACTORS):
                kinds.append(kind)
                candidates.append(
                    replace(base, slower=kind[0], long_std=kind[1] * base.long_std, correlation=shrunk)
                )
    return _weighed(candidates, kinds, hours, coefficient_std)


def _alike(std: FloatArray) -> FloatArray:
    """Return standard deviations of the long process drawn half way to their geometric mean.

    A baseline of a year knows each to about a factor 1.5; quantities of one kind are of like size, and the
    mean of several is known better (shrinkage, Efron & Morris 1975).
    """
    return np.asarray(np.sqrt(std * np.exp(np.mean(np.log(std)))))


def _weighed(
    candidates: list[Memory], kinds: list[tuple[float, float]], hours: Hours, coefficient_std: FloatArray
) -> Learnt:
    after, score = [], []
    for memory in candidates:
        prior = prior_belief(memory, coefficient_std)
        end = filtered(memory, prior, empty_bank(len(coefficient_std), prior.mean.size), hours, -np.inf)
        after.append(end.belief)
        score.append(end.log_likelihood + _log_prior(memory))
    order, weights = _distinct(kinds, np.array(score))
    best = candidates[order[0]]
    guards = [replace(best, long_std=factor * best.long_std, slower=share) for factor, share, _ in GUARDS]
    for guard in guards:
        prior = prior_belief(guard, coefficient_std)
        bank = empty_bank(len(coefficient_std), prior.mean.size)
        after.append(filtered(guard, prior, bank, hours, -np.inf).belief)
    floor = np.array([weight for *_, weight in GUARDS])
    return Learnt(
        (*(candidates[i] for i in order), *guards),
        (*(after[i] for i in order), *after[-len(guards) :]),
        np.concatenate([weights + np.log1p(-floor.sum()), np.log(floor)]),
    )


def _distinct(kinds: list[tuple[float, float]], score: FloatArray) -> tuple[list[int], FloatArray]:
    """Return the models to keep, the likeliest first, and ln of their weights.

    Models that differ in the long process differ in what they expect of the future, however alike they fit
    the baseline: of each kind of it the best stands for all. Each share of the slower part keeps at least
    one.
    """
    members = {kind: [i for i, other in enumerate(kinds) if other == kind] for kind in dict.fromkeys(kinds)}
    mass = {kind: float(np.logaddexp.reduce(score[chosen])) for kind, chosen in members.items()}
    ranked = sorted(members, key=lambda kind: -mass[kind])
    kept = [next(kind for kind in ranked if kind[0] == share) for share in LONG_SHARES]
    kept += [kind for kind in ranked if kind not in kept][: MOST_MODELS - len(kept)]
    kept.sort(key=lambda kind: -mass[kind])
    weights = np.array([mass[kind] for kind in kept])
    best = [max(members[kind], key=lambda i: score[i]) for kind in kept]
    return best, weights - np.logaddexp.reduce(weights)


def _log_prior(memory: Memory) -> float:
    """Return ln of the prior of the long process given the short one: one draw for all quantities."""
    off = np.log(memory.long_std / (_LONG_PRIOR[0] * memory.short_std)) / _LONG_PRIOR[1]
    return float(-0.5 * np.mean(off**2))


def _alone(
    hours: Hours, q: int, coefficient_std: FloatArray, short_days: float, spread: float
) -> tuple[FloatArray, float]:
    """Return (scale, short, long standard deviations) of one quantity, and its log posterior."""
    seen = np.isfinite(hours.values[:, q])
    own = Hours(hours.days[seen], hours.rows[seen], *(
        a[seen, q : q + 1] for a in (hours.values, hours.noise, hours.chi2, hours.freedom)
    ))  # fmt: skip
    typical = float(np.sqrt(np.median(own.noise)))
    start = np.log([1.0, max(0.3 * spread, 0.1 * typical), 0.1 * max(spread, 0.3 * typical)])

    def loss(x: FloatArray) -> float:
        y = np.clip(x, [-3.0, np.log(_LEAST * spread), np.log(_LEAST * spread)], np.log(10.0 * spread + 10.0))
        scale, short, long = np.exp(y)
        stds = [np.array([v]) for v in (scale, short, long)]
        memory = Memory(stds[0], stds[1], stds[2], short_days, LONG_SHARES[0], np.eye(1))
        prior = prior_belief(memory, coefficient_std[None])
        end = filtered(memory, prior, empty_bank(1, prior.mean.size), own, -np.inf)
        penalty = (y[0] / _SCALE_STD) ** 2 + ((y[1] - start[1]) / _SHORT_STD) ** 2
        return float(0.5 * penalty + np.sum((x - y) ** 2) - end.log_likelihood - _log_prior(memory))

    simplex = start + np.vstack([np.zeros(3), 0.5 * np.eye(3)])
    found = minimize(
        loss, start, method="Nelder-Mead",
        options={"maxfev": _FEW_STEPS, "initial_simplex": simplex, "xatol": 0.03, "fatol": 0.05},
    )  # fmt: skip
    return np.exp(found.x), -float(found.fun)


def _correlation(hours: Hours, memory: Memory, coefficient_std: FloatArray) -> FloatArray:
    """Return the correlation of the slow processes between quantities: two by two, the posterior's mean."""
    m = len(memory.scale)
    result = np.eye(m)
    for i in range(m):
        for j in range(i):
            chosen = [j, i]
            own = Hours(hours.days, hours.rows, *(
                a[:, chosen] for a in (hours.values, hours.noise, hours.chi2, hours.freedom)
            ))  # fmt: skip
            pair = replace(
                memory, scale=memory.scale[chosen], short_std=memory.short_std[chosen],
                long_std=memory.long_std[chosen],
            )  # fmt: skip
            result[i, j] = result[j, i] = _correlation_of_two(own, pair, coefficient_std[chosen])
    return _positive(result)


def _correlation_of_two(hours: Hours, pair: Memory, coefficient_std: FloatArray) -> float:
    """Return the posterior's mean of the correlation between two quantities under a flat prior."""
    likelihood = np.empty(CORRELATIONS.size)
    for k, rho in enumerate(CORRELATIONS):
        memory = replace(pair, correlation=np.array([[1.0, rho], [rho, 1.0]]))
        prior = prior_belief(memory, coefficient_std)
        likelihood[k] = filtered(memory, prior, empty_bank(2, prior.mean.size), hours, -np.inf).log_likelihood
    weight = np.exp(likelihood - likelihood.max())
    return float(weight @ CORRELATIONS / weight.sum())


def _positive(correlation: FloatArray) -> FloatArray:
    """Return the nearest correlation with no eigenvalue below one in fifty."""
    values, vectors = np.linalg.eigh(correlation)
    mended = (vectors * np.maximum(values, 0.02)) @ vectors.T
    size = np.sqrt(np.diag(mended))
    return np.asarray(mended / np.outer(size, size))
