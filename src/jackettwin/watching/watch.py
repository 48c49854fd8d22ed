r"""The watch: a state that each day with records carries on, and what the day says.

The statistic is that of Shiryaev and Roberts as an e-detector (Shin, Ramdas & Rinaldo 2024),

.. math:: R_t = \sum_{τ \le t} w_τ \, BF(τ, t)

with w_τ the days since the last begin, so that R_t − t is a martingale while nothing changes, and the mean
time to R_t ≥ A is at least A days, whatever is bet on and however often one looks. BF is the mean over
models, directions and sizes. Old begins are merged: what one was worth is staked on its neighbour, and R
stays what it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.watching.block import (
    BROAD,
    Block,
    Spoken,
    adopted,
    begin,
    cleared,
    hours_of,
    log_evidence,
    log_scatter,
    reconsidered,
    taken,
    thinned,
    watched,
)
from jackettwin.watching.design import WHOLE_YEAR_DAYS, Design, Lagged, Slope, design_of, fresh, regressors
from jackettwin.watching.directions import SHARES, Pattern, directions_of
from jackettwin.watching.history import History, Kind, typical
from jackettwin.watching.ramps import log_ramps
from jackettwin.watching.scatter import STRONGER

YEAR_DAYS = 365.25
MOST_BEGINS = 26
"""Begins that are kept; the day's cost grows with them."""
_RECENT = 8
"""The last begins, which are never merged."""
RECONSIDERED_DAYS, STEADY_DAYS = 10.0, 90.0
"""How often the models' weights are reconsidered, and for how long what is unexplained stays as it is."""
FEWEST_DAYS = 7
"""Days with records that a baseline needs."""
_LOOSE = 1.0
"""Precision of what other quantities do while some are judged: they may change by anything."""
PATIENCE, MOST_PATIENCE_DAYS = 1.0 / 36.0, 10.0
"""Share of the baseline that a change has to last where no conditions are given, and the most of it: what is
shorter may be storms that follow each other. Leaving later begins out can only lower R, so that the promise
is kept."""
GUARDED = 0.8
"""Power to which evidence counts where no conditions are given and a baseline of a year makes models sure of
what weather does, which has a longer tail than any normal process. The mean of no Bayes factor rises by that
(Jensen), so that the promise is kept. After a shorter baseline models are unsure enough by themselves."""
KINDS: tuple[Kind, ...] = ("frequency", "damping", "angle")


@dataclass(frozen=True)
class Begins:
    """When a change may have begun.

    Attributes
    ----------
    days : (n,) first day with records after the change
    since : (n,) last day with records before it
    log_stake : (n,) ln of what is staked on each
    log_scatter : (n, m_all, n_factors) ln of the likelihood ratios of louder noise since then
    """

    days: FloatArray
    since: FloatArray
    log_stake: FloatArray
    log_scatter: FloatArray


@dataclass(frozen=True)
class Watch:
    """All that has to be kept from one day to the next; it does not grow.

    Attributes
    ----------
    labels : of the modes
    design, lagged : regressors and what late ones remember
    blocks : of frequencies, and of damping if there is any
    begins : of changes that are bet on
    last_day : of the last records
    accounted : day up to which begins are staked
    considered : day on which the models' weights were reconsidered
    arl_years : mean time between false alarms that is promised, at least
    patience_days : for how long a change has to last
    power : to which evidence counts
    """

    labels: tuple[str, ...]
    design: Design
    lagged: Lagged
    blocks: tuple[Block, ...]
    begins: Begins
    last_day: float
    accounted: float
    considered: float
    arl_years: float
    patience_days: float = 0.0
    power: float = 1.0

    @property
    def log_threshold(self) -> float:
        """Ln of A, the days between false alarms."""
        return float(np.log(self.arl_years * YEAR_DAYS))

    @property
    def quantities(self) -> tuple[tuple[Kind, int], ...]:
        """Kind and mode of each watched quantity."""
        return tuple((block.kind, int(q)) for block in self.blocks for q in block.kept)


@dataclass(frozen=True)
class Change:
    """A change that the evidence is sufficient for.

    Attributes
    ----------
    day : of the alarm
    kind : "frequency", "damping" or "scatter"
    direction : its name
    began, began_interval_90 : days
    members : (m_all,) which quantities move
    size, size_std : (m_all,) change of the logarithms and its standard deviation; of the noise's if scatter
    info, score, log_stake : (n, m_all, m_all), (n, m_all), (n,) what each begin says of steps of all
        quantities: that causes are judged by
    log_scatter : (n, m_all, n_factors)
    log_r : ln of the statistic
    by_mode : (m_all,) squared distance of each quantity from no change, over its variance
    """

    day: float
    kind: str
    direction: str
    began: float
    began_interval_90: tuple[float, float]
    members: BoolArray
    size: FloatArray
    size_std: FloatArray
    info: FloatArray
    score: FloatArray
    log_stake: FloatArray
    log_scatter: FloatArray
    log_r: float
    by_mode: FloatArray

    def restricted(self, chosen: BoolArray) -> Change:
        """Return what is known of some quantities whatever the others do."""
        if chosen.all():
            return self
        other = ~chosen
        inner = self.info[:, other][:, :, other] + _LOOSE * np.eye(int(other.sum()))
        cross = self.info[:, chosen][:, :, other]
        weight = np.swapaxes(np.linalg.solve(inner, np.swapaxes(cross, 1, 2)), 1, 2)
        return replace(
            self,
            members=self.members[chosen],
            size=self.size[chosen],
            size_std=self.size_std[chosen],
            info=self.info[:, chosen][:, :, chosen] - weight @ np.swapaxes(cross, 1, 2),
            score=self.score[:, chosen] - np.einsum("tij,tj->ti", weight, self.score[:, other]),
            log_scatter=self.log_scatter[:, chosen],
            by_mode=self.by_mode[chosen],
        )


@dataclass(frozen=True)
class Look:
    """What one day says.

    Attributes
    ----------
    day : its last record
    rest, rest_std : (m_all,) means less what conditions explain, and their standard deviation if nothing has
        changed
    log_r : ln of the statistic
    change : Change or None
    """

    day: float
    rest: FloatArray
    rest_std: FloatArray
    log_r: float
    change: Change | None = None
    spoken: tuple[Spoken, ...] = field(default=(), repr=False)


def columns_to_watch(baseline: History) -> dict[Kind, IntArray]:
    """Return the columns of each kind of quantity that the baseline tells enough of to watch.

    Raises
    ------
    InputError
        If the baseline is too short to learn from.
    """
    n_days = len(np.unique(np.floor(baseline.days)))
    kept = {kind: watched(baseline, kind) for kind in KINDS}
    if n_days < FEWEST_DAYS or not any(len(k) for k in kept.values()):
        raise InputError(
            "the baseline is too short to learn from",
            field="baseline",
            value=f"{n_days} days with records, {baseline.days.size} rows",
            allowed=f"at least {FEWEST_DAYS} days with records and 30 values of a mode",
            remedy="watch for longer, or set --baseline-days so that it covers the healthy time",
        )
    return kept


def start(
    baseline: History,
    *,
    arl_years: float = 10.0,
    patterns: Sequence[Pattern] = (),
    slopes: Sequence[Slope] = (),
) -> Watch:
    """Return the watch at the end of a baseline.

    Parameters
    ----------
    patterns : by which a model's causes would show in the frequencies; they are bet on beside the others
    slopes : of the frequencies with conditions, as far as a model knows them

    Raises
    ------
    InputError
        If the baseline is too short to learn from.
    """
    kept = columns_to_watch(baseline)
    design = design_of(baseline)
    rows, lagged = regressors(design, baseline, fresh(design))
    frequency = typical(baseline.frequency)
    blocks = []
    for kind, columns in kept.items():
        if not len(columns):
            continue
        labels = tuple(baseline.labels[q] for q in columns)
        shown = [replace(p, change=p.change[columns]) for p in patterns if p.change[columns].any()]
        given = shown if kind == "frequency" else ()
        directions = directions_of(kind, labels, frequency[columns], given)
        known = [Slope(s.condition, s.per_unit[columns], s.std[columns]) for s in slopes]
        known = known if kind == "frequency" else []
        blocks.append(begin(baseline, design, rows, kind, directions, columns, known)[0])
    total = sum(len(block.kept) for block in blocks)
    last = float(baseline.days[-1])
    span = last - float(baseline.days[0])
    return Watch(
        baseline.labels,
        design,
        lagged,
        tuple(blocks),
        _no_begins(total),
        last,
        float(np.floor(last)),
        last,
        arl_years,
        min(PATIENCE * span, MOST_PATIENCE_DAYS) if design.hidden else 0.0,
        GUARDED if design.hidden and span > WHOLE_YEAR_DAYS else 1.0,
    )


def _no_begins(m: int) -> Begins:
    return Begins(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((0, m, len(STRONGER))))


def step(watch: Watch, day: History) -> tuple[Watch, Look]:
    """Return the watch after one day's records, and what the day says.

    Raises
    ------
    InputError
        If the day lies before the last one.
    """
    if not day.days.size or day.days[0] < watch.last_day:
        raise InputError("a day that is over already, or without records", field="days", value=watch.last_day)
    rows, lagged = regressors(watch.design, day, watch.lagged)
    blocks, spoken = [], []
    for block in watch.blocks:
        hours, apart, block = hours_of(block, day, rows)
        block, said = taken(block, hours, apart, watch.last_day)
        blocks.append(block)
        spoken.append(said)
    scatter = np.concatenate([log_scatter(b, s) for b, s in zip(blocks, spoken, strict=True)])
    today = float(np.floor(day.days[0]))
    after = replace(
        watch, lagged=lagged, blocks=tuple(blocks), begins=_with_today(watch, today, scatter),
        last_day=float(day.days[-1]), accounted=max(today, watch.accounted),
    )  # fmt: skip
    worth = _worth(after)
    old = after.begins.days <= after.last_day - after.patience_days
    log_r = float(
        np.logaddexp.reduce((after.begins.log_stake[:, None] + worth)[old].ravel(), initial=-np.inf)
    )
    change = None
    if log_r >= after.log_threshold:
        change, begun = _change(after, worth, log_r)
        after = _without(after, change, begun)
    else:
        after = _reconsidered(_merged(after, worth))
    rest, std = (np.concatenate([getattr(s, name) for s in spoken]) for name in ("rest", "rest_std"))
    return after, Look(float(day.days[-1]), rest, std, log_r, change, tuple(spoken))


def _with_today(watch: Watch, today: float, scatter: FloatArray) -> Begins:
    old = watch.begins
    elapsed = max(today - watch.accounted, 1e-9)
    return Begins(
        np.append(old.days, today),
        np.append(old.since, watch.last_day),
        np.append(old.log_stake, np.log(elapsed)),
        np.concatenate([old.log_scatter, np.zeros((1, *scatter.shape))]) + scatter,
    )


def _worth(watch: Watch) -> FloatArray:
    """Return ln of what a unit stake on each begin has become, by bet, (n_begins, n_bets).

    The bets are the directions of each block, then the scatter of each quantity by its factor.
    """
    scatter = watch.begins.log_scatter
    n, m, g = scatter.shape
    share = np.log(SHARES["scatter"] / (m * g))
    parts = [watch.power * log_evidence(block) + block.directions.log_weights for block in watch.blocks]
    total = np.concatenate([*parts, watch.power * scatter.reshape(n, m * g) + share], axis=1)
    staked = SHARES["scatter"] + sum(SHARES[block.kind] for block in watch.blocks)
    return np.asarray(total - np.log(staked))


def _merged(watch: Watch, worth: FloatArray) -> Watch:
    """Return the watch with at most so many begins: the one closest to its neighbours for its age goes."""
    begins = watch.begins
    if begins.days.size <= MOST_BEGINS:
        return watch
    inner = np.arange(1, begins.days.size - _RECENT)
    age = watch.last_day - begins.days[inner] + 1.0
    gone = int(inner[np.argmin((begins.days[inner + 1] - begins.days[inner - 1]) / age)])
    value = np.logaddexp.reduce(worth, axis=1)
    stake = begins.log_stake.copy()
    wealth = np.logaddexp(stake[gone] + value[gone], stake[gone - 1] + value[gone - 1])
    stake[gone - 1] = wealth - value[gone - 1]
    keep = np.arange(begins.days.size) != gone
    kept = Begins(begins.days[keep], begins.since[keep], stake[keep], begins.log_scatter[keep])
    return replace(watch, begins=kept, blocks=tuple(thinned(block, keep) for block in watch.blocks))


def _reconsidered(watch: Watch) -> Watch:
    """Return the watch with its models' weights reconsidered now and then; what begins are worth stays."""
    elapsed = watch.last_day - watch.considered
    if elapsed < RECONSIDERED_DAYS:
        return watch
    share = -np.expm1(-elapsed / STEADY_DAYS)
    after = replace(
        watch,
        blocks=tuple(reconsidered(block, float(share)) for block in watch.blocks),
        considered=watch.last_day,
    )
    before, now = (np.logaddexp.reduce(_worth(one), axis=1) for one in (watch, after))
    begins = replace(watch.begins, log_stake=watch.begins.log_stake + before - now)
    return replace(after, begins=begins)


def _change(watch: Watch, worth: FloatArray, log_r: float) -> tuple[Change, int]:
    """Return the change that there is, and the begin that it has if it is a step."""
    begins = watch.begins
    posterior = np.exp(begins.log_stake[:, None] + worth - log_r)
    bet = int(np.argmax(posterior.sum(axis=0)))
    kind, direction, members = _bet(watch, bet)
    # when it began: by all bets that agree with the likeliest on its kind
    same = [b for b in range(worth.shape[1]) if _bet(watch, b)[0] == kind]
    by_begin = posterior[:, same].sum(axis=1)
    low, mid, high = _quantiles(_gradual(watch, kind, direction, by_begin))
    until = np.append(begins.since[1:], watch.last_day)  # a begin stands for those merged with it
    info, score = _all_info(watch)
    size, std = (
        _louder(watch, by_begin)
        if kind == "scatter"
        else _sizes(info, score, by_begin, _prior_precision(watch))
    )
    change = Change(
        watch.last_day, kind, direction,
        float(0.5 * (begins.since[mid] + until[mid])), (float(begins.since[low]), float(until[high])),
        members, size, std, info, score, begins.log_stake, begins.log_scatter, log_r,
        (size / np.where(std > 0.0, std, np.inf)) ** 2,
    )  # fmt: skip
    return change, _quantiles(by_begin)[1]


def _quantiles(by_begin: FloatArray) -> tuple[int, ...]:
    cumulative = np.cumsum(by_begin) / by_begin.sum()
    return tuple(int(np.searchsorted(cumulative, p).clip(0, by_begin.size - 1)) for p in (0.05, 0.5, 0.95))


def _gradual(watch: Watch, kind: str, direction: str, by_begin: FloatArray) -> FloatArray:
    """Return the weights of begins if the change was a step or, as likely, a ramp that goes on."""
    block = next((b for b in watch.blocks if b.kind == kind), None)
    if block is None or block.banks[0].cross is None:  # a bank kept by an earlier version has none
        return by_begin
    u, begins = _along(block, direction, int(np.argmax(by_begin))), watch.begins
    logs = log_ramps(block.directions, u, block.banks[0], begins.days, watch.last_day) + begins.log_stake
    ramp, step = np.logaddexp.reduce(logs, axis=1)
    share = 1.0 / (1.0 + np.exp(np.clip(step - ramp, -500.0, 500.0)))
    return np.asarray((1.0 - share) * by_begin / by_begin.sum() + share * np.exp(logs[0] - ramp))


def _along(block: Block, direction: str, begun: int) -> FloatArray:
    """Return the vector of a direction; of "any", that of the step that was seen."""
    place = block.directions.names.index(direction)
    if place < len(block.directions.vectors):
        return np.asarray(block.directions.vectors[place])
    info, score = block.banks[0].info[begun], block.banks[0].score[begun]
    delta = np.linalg.solve(info + _LOOSE * np.eye(len(score)), score)
    return np.asarray(-delta / np.abs(delta).max())


def _bet(watch: Watch, bet: int) -> tuple[str, str, BoolArray]:
    """Return kind, name and members of a bet."""
    total = sum(len(block.kept) for block in watch.blocks)
    members = np.zeros(total, dtype=np.bool_)
    first = 0
    for block in watch.blocks:
        n, m = len(block.directions.names), len(block.kept)
        if bet < n:
            members[first : first + m] = block.directions.members[bet]
            return block.kind, block.directions.names[bet], members
        bet, first = bet - n, first + m
    q = bet // len(STRONGER)
    members[q] = True
    kind, mode = watch.quantities[q]
    return "scatter", f"scatter of the {kind} of {watch.labels[mode]}", members


def _all_info(watch: Watch) -> tuple[FloatArray, FloatArray]:
    """Return A and b of steps of all quantities under the likeliest models."""
    n, m = watch.begins.log_scatter.shape[:2]
    info, score = np.zeros((n, m, m)), np.zeros((n, m))
    first = 0
    for block in watch.blocks:
        bank = block.banks[int(np.argmax(block.log_weights))]
        place = slice(first, first + len(block.kept))
        info[:, place, place], score[:, place] = bank.info, bank.score
        first += len(block.kept)
    return info, score


def _prior_precision(watch: Watch) -> FloatArray:
    return np.concatenate([np.full(len(b.kept), BROAD[b.kind] ** -2.0) for b in watch.blocks])


def _sizes(
    info: FloatArray, score: FloatArray, by_begin: FloatArray, prior: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation of the change of each quantity, over begins."""
    share = by_begin / by_begin.sum()
    covariance = np.linalg.inv(info + np.diag(prior))
    each = np.einsum("tij,tj->ti", covariance, score)
    mean = share @ each
    variance = share @ (np.einsum("tii->ti", covariance) + (each - mean) ** 2)
    return mean, np.sqrt(variance)


def _louder(watch: Watch, by_begin: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return ln of the factor on each quantity's noise: mean over the factors bet on, none among them."""
    share = by_begin / by_begin.sum()
    m = watch.begins.log_scatter.shape[1]
    logs = np.concatenate(
        [np.zeros((*watch.begins.log_scatter.shape[:2], 1)), watch.begins.log_scatter], axis=2
    )
    weight = np.exp(logs - np.logaddexp.reduce(logs, axis=2)[..., None])
    ln_g = np.log(np.concatenate([[1.0], STRONGER]))
    mean = share @ (weight @ ln_g)
    square = share @ (weight @ ln_g**2)
    return mean, np.sqrt(np.maximum(square - mean**2, 0.01)).reshape(m)


def _without(watch: Watch, change: Change, begun: int) -> Watch:
    """Return the watch without bets that looks for what changes next; a change is taken over as a step."""
    blocks, first = [], 0
    for block in watch.blocks:
        m = len(block.kept)
        members = change.members[first : first + m]
        if change.kind == "scatter":
            louder = np.exp(change.size[first : first + m])
            blocks.append(replace(cleared(block), louder=block.louder * np.where(louder > 1.2, louder, 1.0)))
        elif members.any():
            blocks.append(adopted(block, begun, np.ones(m, dtype=np.bool_), len(watch.design.states)))
        else:
            blocks.append(cleared(block))
        first += m
    total = watch.begins.log_scatter.shape[1]
    return replace(watch, blocks=tuple(blocks), begins=_no_begins(total))
