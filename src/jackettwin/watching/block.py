"""Monitoring state of one kind of quantity (ln f, ln ζ or directions of pairs), updated day by day."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.intervals import NORMAL_OF_MAD
from jackettwin.watching.design import Design, Slope
from jackettwin.watching.directions import Directions, log_bayes_factors
from jackettwin.watching.history import (
    History,
    Kind,
    NearestModes,
    deviations,
    middles,
    nearest_modes,
    std_power,
)
from jackettwin.watching.hours import ENOUGH, NEIGHBOURS, Hours, by_hour, outliers
from jackettwin.watching.learning import learn
from jackettwin.watching.memory import Bank, Belief, Filtered, Memory, empty_bank, filtered
from jackettwin.watching.scatter import log_outlier_ratios, log_ratios, steadiness

WINDOW_DAYS = 1.0 / 24.0
"""Length of the averaging window: one clock hour [days]."""
_LEAST_STD, _MOST_STD = 0.3, 5.0
"""Limits of stated standard deviations, as factors of their median."""
BROAD = {"frequency": 0.03, "damping": 0.5, "angle": 0.5}
"""Prior standard deviation of a change, given that there is one."""
_NEGLIGIBLE = -20.0
"""Logarithm of the weight below which a model is not evaluated."""
_NO_WEIGHT = -1e9
"""Logarithm of the weight assigned to a model to exclude it."""
_FEW_DAYS = 0.1
"""Share of the days with several records an hour up to which the scatter of a quantity is not known."""
_OUTLYING = 0.004
"""Share of values that are outliers, for states stored before it was learnt."""
_FEWEST, _STILL = 30, 1e-9
"""Fewest baseline values of a monitored quantity, and their smallest relative range: constants are
excluded."""


@dataclass(frozen=True)
class Block:
    """Monitoring state of one kind of quantity.

    Attributes
    ----------
    kind : kind of the quantities
    kept : (m,) indices of the monitored columns of the history
    typical : (m,) median values over the baseline
    std_power : (m,) power of the value to which stated standard deviations are proportional
    usual_std : (m,) relative standard deviation where none is stated
    spread : (m,) standard deviation over the baseline, by which priors of coefficients are scaled
    memories, beliefs, banks, log_weights : per model, its parameters, state, possible steps and log weight
    log_prior : (n_models,) log weights at the end of the baseline
    louder : (m,) factors on the noise, above 1 while a sensor is known to fail
    tail : (NEIGHBOURS, m) last residuals, that is, values minus the part explained by conditions
    steadiness : (m,) ν of :mod:`jackettwin.watching.scatter`
    reference : (m, p) coefficients at the end of the baseline
    directions : directions of steps that are tested
    outlying : (m,) share of the baseline's values that were rejected
    near : of directions, the other mode of each pair
    centre : (n_states, p) mean regressors of each operating state over the baseline, where its level is
        known best; None in states stored before it was kept
    level_variance : (n_states, m) variance of that level at the end of the baseline
    """

    kind: Kind
    kept: IntArray
    typical: FloatArray
    std_power: FloatArray
    usual_std: FloatArray
    spread: FloatArray
    memories: tuple[Memory, ...]
    beliefs: tuple[Belief, ...]
    banks: tuple[Bank, ...]
    log_weights: FloatArray
    log_prior: FloatArray
    louder: FloatArray
    tail: FloatArray
    steadiness: FloatArray
    reference: FloatArray
    directions: Directions
    outlying: FloatArray = field(default_factory=lambda: np.full(1, _OUTLYING))
    near: NearestModes | None = None
    centre: FloatArray | None = None
    level_variance: FloatArray | None = None


@dataclass(frozen=True)
class DayResult:
    """Result of one day for one kind of quantity.

    Attributes
    ----------
    rest : (m,) the day's mean minus the baseline's level and the effects of conditions as believed before it
    rest_std : (m,) its standard deviation if nothing has changed
    chi2, freedom : (m,) scatter in units of the noise's variance, and its degrees of freedom
    apart : (m,) number of values rejected by comparison with others of the day
    z : (n_hours, m) innovations of the most likely model over their standard deviations
    """

    rest: FloatArray
    rest_std: FloatArray
    chi2: FloatArray
    freedom: FloatArray
    apart: FloatArray
    z: FloatArray


def watched(baseline: History, kind: Kind) -> IntArray:
    """Return the indices of the columns that have enough values to be monitored and are not constant."""
    columns = [x[np.isfinite(x) & ((x > 0.0) | (kind == "angle"))] for x in baseline.seen(kind)[0].T]
    alive = [x.size >= _FEWEST and np.ptp(x) > _STILL * np.max(np.abs(x)) for x in columns]
    return np.flatnonzero(np.array(alive, dtype=np.bool_))


def begin(
    baseline: History,
    design: Design,
    rows: FloatArray,
    kind: Kind,
    directions: Directions,
    kept: IntArray,
    slopes: Sequence[Slope] = (),
) -> tuple[Block, Hours]:
    """Return the state learnt from a baseline, and its hourly averages.

    ``slopes`` are prior effects of conditions on the monitored columns.
    """
    middle = middles(baseline, kind, kept)
    # the noise of a frequency is too small for its dependence on the value to matter
    power = std_power(baseline, kind, kept) if kind == "damping" else np.ones(len(kept))
    near = nearest_modes(baseline, kept) if kind == "angle" else None
    y, relative = deviations(baseline, kind, kept, middle, power, near)
    y[~np.isfinite(rows).all(axis=1)] = np.nan
    x = np.nan_to_num(rows)
    usual_std, rest, alone = _usual_std(baseline.days, x, y, relative, design)
    variance = _variance(relative, usual_std)
    apart, doubt, tail = _set_apart(baseline, rest, variance)
    y[apart] = np.nan
    hours = by_hour(baseline.days, baseline.states, x, y, variance * doubt * alone, WINDOW_DAYS)
    day = np.floor(baseline.days)
    beside = sum(_rejected_by_others(apart[day == d], rest[day == d]) for d in np.unique(day))
    spread = np.maximum(np.nanstd(hours.values, axis=0), 0.1 * usual_std)
    learnt = learn(hours, design.coefficients(spread, slopes), hidden=design.hidden)
    m, p = len(kept), rows.shape[1]
    centre = _centre(hours.rows, len(design.states))
    _, cov = _first_coefficients(learnt.beliefs[0], m, p)
    block = Block(
        kind=kind,
        kept=kept,
        typical=middle,
        std_power=power,
        usual_std=usual_std,
        spread=spread,
        memories=learnt.memories,
        beliefs=learnt.beliefs,
        banks=no_begins(m, learnt.beliefs),
        log_weights=learnt.log_weights,
        log_prior=learnt.log_weights,
        louder=np.ones(m),
        tail=tail,
        steadiness=_steady(hours, learnt.memories[0]),
        reference=learnt.beliefs[0].mean[: m * p].reshape(m, p),
        directions=directions,
        outlying=(beside + 1.0) / (np.isfinite(rest).sum(axis=0) + 1.0),
        near=near,
        centre=centre,
        level_variance=_unsure(cov, centre),
    )
    return block, hours


def _centre(rows: FloatArray, states: int) -> FloatArray:
    """Return the mean regressors of each operating state, (n_states, p); its intercept if it has no rows."""
    of = rows[:, :states] > 0.0
    own = [rows[here].mean(axis=0) if here.any() else np.eye(states, rows.shape[1])[k]
           for k, here in enumerate(of.T)]  # fmt: skip
    return np.array(own)


def _steady(hours: Hours, memory: Memory) -> FloatArray:
    """Return the steadiness of the scatter of each quantity."""
    chi2, freedom = _by_day(hours, memory)
    return np.array([steadiness(chi2[:, q], freedom[:, q]) for q in range(chi2.shape[1])])


def _by_day(hours: Hours, memory: Memory) -> tuple[FloatArray, FloatArray]:
    day = np.unique(np.floor(hours.days), return_inverse=True)[1]
    out = np.zeros((2, day.max(initial=-1) + 1, hours.values.shape[1]))
    np.add.at(out[0], day, hours.chi2 / memory.scale**2)
    np.add.at(out[1], day, hours.freedom)
    return out[0], out[1]


def _usual_std(
    days: FloatArray, x: FloatArray, y: FloatArray, relative: FloatArray, design: Design
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the usual standard deviation (m,), stated or by differences, residuals, and variance factors.

    A value on which a slope rests by more than a half has a residual near zero, whatever it is, so that
    no other value tells whether it is an outlier. With the leverage h its variance is (h/(1 − h))² times as
    large: it leaves the slope as uncertain as before (bounded influence, Krasker & Welsch 1982).
    """
    m = y.shape[1]
    usual, rest, alone = np.empty(m), np.full(y.shape, np.nan), np.ones(y.shape)
    for q in range(m):
        seen = np.flatnonzero(np.isfinite(y[:, q]))
        weight = np.ones(seen.size)
        for _ in range(4):  # Huber weights limit the influence of outliers on the line
            prior = np.diag((design.priors * max(float(np.std(y[seen, q])), 1e-12)) ** -2.0)
            left = (x[seen].T * weight) @ x[seen] / _robust(y[seen, q]) ** 2
            right = (x[seen].T * weight) @ y[seen, q] / _robust(y[seen, q]) ** 2
            rest[seen, q] = y[seen, q] - x[seen] @ np.linalg.solve(left + prior, right)
            weight = np.minimum(1.0, 1.5 * _robust(rest[seen, q]) / np.maximum(np.abs(rest[seen, q]), 1e-12))
        pull = (
            np.einsum("ip,pq,iq->i", x[seen], np.linalg.inv(left + prior), x[seen]) / _robust(y[seen, q]) ** 2
        )
        h = np.clip(weight * pull, 0.5, _MOST_LEVERAGE)
        alone[seen, q] = (h / (1.0 - h)) ** 2
        near = np.diff(days[seen]) < 0.25
        pairs = np.diff(rest[seen, q])[near] if near.sum() > _FEWEST // 2 else np.diff(rest[seen, q])
        stated = relative[np.isfinite(relative[:, q]), q]
        usual[q] = (
            np.median(stated) if stated.size > _FEWEST // 2 else max(_robust(pairs) / np.sqrt(2.0), 1e-6)
        )
    return usual, rest, alone


_MOST_LEVERAGE = 0.99
"""Leverage from which a value counts as little as with it."""


def _robust(x: FloatArray) -> float:
    return max(float(NORMAL_OF_MAD * np.median(np.abs(x - np.median(x)))), 1e-9)


def _variance(relative: FloatArray, usual: FloatArray) -> FloatArray:
    filled = np.where(np.isfinite(relative), relative, usual)
    return np.asarray(np.clip(filled, _LEAST_STD * usual, _MOST_STD * usual) ** 2)


def _set_apart(
    baseline: History, rest: FloatArray, variance: FloatArray
) -> tuple[BoolArray, FloatArray, FloatArray]:
    """Return the outliers of a baseline, variance factors of the other values, and the last values."""
    m = rest.shape[1]
    scale = np.array([_robust(r[np.isfinite(r)] / np.sqrt(v[np.isfinite(r)]))
                      for r, v in zip(rest.T, variance.T, strict=True)])  # fmt: skip
    apart, doubt = np.zeros(rest.shape, dtype=np.bool_), np.ones(rest.shape)
    tail = np.full((NEIGHBOURS, m), np.nan)
    day = np.floor(baseline.days)
    for d in np.unique(day):
        today = day == d
        wide = variance[today] * np.maximum(scale, 1.0) ** 2
        apart[today], doubt[today], tail = outliers(rest[today], wide, tail)
    return apart, doubt, tail


def hours_of(
    block: Block, history: History, rows: FloatArray, lacking: FloatArray | None = None
) -> tuple[Hours, FloatArray, Block]:
    """Return a day's hourly averages, the number of rejected values (m,), and the updated block.

    ``lacking`` is the variance (n, m) of what missing conditions do.
    """
    y, rest, variance, moving = residuals(block, history, rows)
    apart, doubt, tail = outliers(rest, moving, block.tail)
    told = _rejected_by_others(apart, y)
    y[apart] = np.nan
    noise = variance * doubt + (0.0 if lacking is None else lacking)
    hours = by_hour(history.days, history.states, np.nan_to_num(rows), y, noise, WINDOW_DAYS)
    return hours, told, replace(block, tail=tail)


def residuals(
    block: Block, history: History, rows: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return values, residuals after conditions, noise variance, and variance within a day, (n, m) each.

    The variance within a day includes that of the noise.
    """
    y, relative = deviations(history, block.kind, block.kept, block.typical, block.std_power, block.near)
    y[~np.isfinite(rows).all(axis=1)] = np.nan
    x = np.nan_to_num(rows)
    variance = _variance(relative, block.usual_std) * block.louder**2
    memory = block.memories[0]
    mean, cov = coefficients(block)
    moving = variance * memory.scale**2 + memory.std**2 + _unsure(cov, x - x.mean(axis=0))
    return y, y - x @ mean.T, variance, moving


def coefficients(block: Block) -> tuple[FloatArray, FloatArray]:
    """Return the current coefficients (m, p) and their covariances (m, p, p)."""
    return _first_coefficients(block.beliefs[0], *block.reference.shape)


def _first_coefficients(belief: Belief, m: int, p: int) -> tuple[FloatArray, FloatArray]:
    """Return the coefficients (m, p) that a state holds and their covariances (m, p, p)."""
    own = np.stack([belief.cov[q * p : (q + 1) * p, q * p : (q + 1) * p] for q in range(m)])
    return belief.mean[: m * p].reshape(m, p), own


def _unsure(cov: FloatArray, x: FloatArray) -> FloatArray:
    """Return the variances of the part explained by conditions, (n, m), in excess of the baseline's."""
    return np.asarray(np.einsum("np,qpr,nr->nq", x, cov, x))


def _rejected_by_others(apart: BoolArray, values: FloatArray) -> FloatArray:
    """Return the number of values rejected by comparison with other values of the same day, (m,)."""
    enough = np.isfinite(values).sum(axis=0) >= ENOUGH
    return np.where(enough, apart.sum(axis=0), 0).astype(np.float64)


def with_hours(block: Block, hours: Hours, apart: FloatArray, last_day: float) -> tuple[Block, DayResult]:
    """Return the block after some hours, with one more possible onset, and their result."""
    beliefs, banks, likelihoods, spoken = [], [], [], None
    for memory, belief, bank in zip(block.memories, block.beliefs, block.banks, strict=True):
        done = filtered(memory, belief, bank.with_begin(), hours, last_day)
        beliefs.append(done.belief)
        banks.append(done.bank)
        likelihoods.append(done.log_likelihood)
        if spoken is None:
            spoken = _spoken(block, hours, apart, done)
    weights = block.log_weights + np.array(likelihoods)
    weights = weights - np.logaddexp.reduce(weights)
    if spoken is None:
        raise ValueError("a block without models")
    return replace(block, beliefs=tuple(beliefs), banks=tuple(banks), log_weights=weights), spoken


def _spoken(block: Block, hours: Hours, apart: FloatArray, done: Filtered) -> DayResult:
    memory = block.memories[0]
    expected, unsure = _expected(block, hours.rows)
    rest = hours.values - expected
    noise = hours.noise * memory.scale**2
    weight = np.where(np.isfinite(rest), 1.0 / noise, 0.0)
    total = weight.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(total > 0.0, np.nansum(weight * np.nan_to_num(rest), axis=0) / total, np.nan)
        std = np.sqrt(1.0 / total + memory.std**2 + unsure.mean(axis=0))
    z = done.innovation / np.sqrt(done.spread)
    # the scatter of hourly innovations about their daily mean also informs on the noise; the mean itself does
    # not, since a step is not scatter
    share = np.nan_to_num(noise / done.spread)
    pull, nu = share / np.nan_to_num(done.spread, nan=1.0), np.nan_to_num(done.innovation)
    shared = np.sum(pull * nu, axis=0) / np.maximum(pull.sum(axis=0), 1e-300)
    chi2 = hours.chi2.sum(axis=0) / memory.scale**2 + np.sum(pull * (nu - shared) ** 2, axis=0)
    total_share = np.maximum(share.sum(axis=0), 1e-300)
    freedom = hours.freedom.sum(axis=0) + total_share - np.sum(share**2, axis=0) / total_share
    return DayResult(mean, std, chi2, freedom, apart, z)


def _expected(block: Block, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    r"""Return what conditions make of the baseline's level, and its variance, (n, m) each.

    .. math:: \bar x^T β_0 + (x - \bar x)^T β

    with β_0 the coefficients at the end of the baseline, β today's, and x̄ the baseline's mean regressors:
    what an unusual condition does is learnt from the days that show it, while the level stays the baseline's,
    so that what remains is the change. The level at x̄ and the effects about it are estimated independently.
    """
    mean, cov = coefficients(block)
    if block.centre is None or block.level_variance is None:
        return rows @ block.reference.T, _unsure(cov, rows)
    state = rows[:, : len(block.centre)]
    centre = state @ block.centre
    about = rows - centre
    level = centre @ block.reference.T + about @ mean.T
    return level, _unsure(cov, about) + state @ block.level_variance


def with_weights_reset(block: Block, share: float) -> Block:
    """Return the block with part of the models' weights reset to those at the end of the baseline.

    The statistics of unexplained variation may change, so that a model of low weight may become likely again
    (fixed share, Herbster & Warmuth 1998).
    """
    weights = np.logaddexp(block.log_weights + np.log1p(-share), block.log_prior + np.log(share))
    return replace(block, log_weights=weights)


def log_evidence(block: Block) -> FloatArray:
    """Return ln of the Bayes factors of onsets and directions over all models, (n_begins, n_directions)."""
    live = [(w, bank) for w, bank in zip(block.log_weights, block.banks, strict=True) if w > _NEGLIGIBLE]
    info = np.concatenate([bank.info for _, bank in live])
    score = np.concatenate([bank.score for _, bank in live])
    each = log_bayes_factors(block.directions, info, score).reshape(len(live), len(info) // len(live), -1)
    return np.asarray(np.logaddexp.reduce(each + np.array([w for w, _ in live])[:, None, None], axis=0))


def log_scatter(block: Block, spoken: DayResult) -> FloatArray:
    """Return ln of the likelihood ratios of increased noise, (m, n_factors)."""
    rejected = spoken.apart[:, None] * log_outlier_ratios(block.outlying)
    return log_ratios(spoken.chi2, spoken.freedom, block.steadiness) + rejected


def scatter_freedom(block: Block, history: History, rows: FloatArray) -> FloatArray:
    """Return the median degrees of freedom of a day's scatter in hours, (m,); 0 if few days have any."""
    y, _, variance, _ = residuals(block, history, rows)
    hours = by_hour(history.days, history.states, np.nan_to_num(rows), y, variance, WINDOW_DAYS)
    days = _by_day(hours, block.memories[0])[1].T
    return np.array([np.median(n[n > 0.0]) if np.mean(n > 0.0) > _FEW_DAYS else 0.0 for n in days])


def thinned(block: Block, keep: BoolArray) -> Block:
    """Return the block with only some of the onsets."""
    return replace(block, banks=tuple(bank.thinned(keep) for bank in block.banks))


def with_change_accepted(block: Block, onset: int, size: FloatArray, states: int) -> Block:
    """Return the block with a change accepted, its size as uncertain as estimated, and without onsets.

    The filter assumed no change. If the values changed by δ, its state is in error by response·δ, and the
    intercepts of all operating states by δ. Later changes are measured relative to the changed structure.

    Parameters
    ----------
    onset : index of the onset
    size : (m,) non-zero for the quantities that changed
    states : number of intercepts
    """
    m, p = block.reference.shape
    beliefs, weights = [], []
    prior = np.where(size, BROAD[block.kind] ** -2.0, 1e12)
    for belief, bank in zip(block.beliefs, block.banks, strict=True):
        covariance = np.linalg.inv(bank.info[onset] + np.diag(prior))
        delta = covariance @ bank.score[onset]
        moves = -bank.response[onset].T.copy()
        for q in range(m):
            moves[q * p : q * p + states, q] += 1.0
        beliefs.append(Belief(belief.mean + moves @ delta, belief.cov + moves @ covariance @ moves.T))
        fit = bank.score[onset] @ delta
        weights.append(0.5 * (fit + np.linalg.slogdet(covariance)[1] + np.log(prior).sum()))
    log_weights = block.log_weights + np.array(weights)
    return replace(
        cleared(block),
        beliefs=tuple(beliefs),
        log_weights=log_weights - np.logaddexp.reduce(log_weights),
        tail=np.full(block.tail.shape, np.nan),
    )


def model_of_change(block: Block, log_stake: FloatArray) -> int:
    """Return the index of the model that is most likely if there was a step in any direction.

    The models that are most likely without a change explain a step as slow variation, increasingly with its
    duration.

    Parameters
    ----------
    log_stake : (n_begins,) ln of the prior weights of onsets
    """
    prior = np.full(len(block.kept), BROAD[block.kind] ** -2.0)
    found = []
    for weight, bank in zip(block.log_weights, block.banks, strict=True):
        info = bank.info + np.diag(prior)
        fit = np.einsum("ti,ti->t", bank.score, np.linalg.solve(info, bank.score[..., None])[..., 0])
        logs = 0.5 * (fit - np.linalg.slogdet(info)[1] + np.log(prior).sum())
        found.append(weight + np.logaddexp.reduce(logs + log_stake))
    return int(np.argmax(found))


def with_one_model(block: Block, model: int) -> Block:
    """Return the block with one model; the first is retained without weight for dating and scatter."""
    chosen = (0,) if model == 0 else (0, model)
    weights = np.where(np.array(chosen) == model, 0.0, _NO_WEIGHT)
    return replace(
        block,
        memories=tuple(block.memories[i] for i in chosen),
        beliefs=tuple(block.beliefs[i] for i in chosen),
        banks=tuple(block.banks[i] for i in chosen),
        log_weights=weights,
        log_prior=weights,
    )


def cleared(block: Block) -> Block:
    """Return the block without onsets."""
    return replace(block, banks=no_begins(len(block.kept), block.beliefs))


def no_begins(m: int, beliefs: Sequence[Belief]) -> tuple[Bank, ...]:
    """Return a bank for each model; ramps are evaluated by the first only."""
    return tuple(empty_bank(m, belief.mean.size, ramps=i == 0) for i, belief in enumerate(beliefs))
