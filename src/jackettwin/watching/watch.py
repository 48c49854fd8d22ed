r"""Sequential monitoring: the state is updated with each day's records, which gives a result for the day.

The statistic is that of Shiryaev and Roberts as an e-detector (Shin, Ramdas & Rinaldo 2024),

.. math:: R_t = \sum_{τ \le t} w_τ \, BF(τ, t)

with w_τ the days since the previous onset, so that R_t − t is a martingale while nothing changes. The mean
time to R_t ≥ A is then the mean of R at the alarm, A or more, for any choice of tested changes and of times
of evaluation; :mod:`jackettwin.watching.overshoot` makes it the promised one. BF is the mean over models,
directions and sizes. Old onsets are merged: the contribution of one is added to its neighbour's, so that R is
unchanged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.watching.block import (
    DayResult,
    begin,
    cleared,
    coefficients,
    hours_of,
    log_evidence,
    log_scatter,
    model_of_change,
    residuals,
    thinned,
    watched,
    with_change_accepted,
    with_hours,
    with_one_model,
    with_weights_reset,
)
from jackettwin.watching.change import Change, change_of
from jackettwin.watching.condition_effects import (
    absent_variance,
    never_seen,
    still_after,
    usual_conditions,
    without_still,
)
from jackettwin.watching.day_parts import INSIDE, divided
from jackettwin.watching.design import (
    WHOLE_YEAR_DAYS,
    Slope,
    design_of,
    fresh,
    regressors,
    with_slow_processes,
)
from jackettwin.watching.directions import NOT_TESTED, SHARES, Pattern, directions_of
from jackettwin.watching.history import History, Kind, typical
from jackettwin.watching.hours import ENOUGH
from jackettwin.watching.overshoot import calibrated
from jackettwin.watching.scatter import STRONGER
from jackettwin.watching.state import PossibleOnsets, Watch

MOST_BEGINS = 26
"""Largest number of onsets; the work per day grows with it."""
_RECENT = 8
"""Number of latest onsets that are never merged."""
RECONSIDERED_DAYS, STEADY_DAYS = 10.0, 90.0
"""Interval at which the models' weights are partly reset, and the time scale of unexplained variation
[days]."""
FEWEST_DAYS = 7
"""Fewest days with records in a baseline."""
PATIENCE, MOST_PATIENCE_DAYS = 1.0 / 36.0, 10.0
"""Time that a change must last if no conditions are given, as a share of the baseline, and its limit in days:
shorter deviations may be successive storms. Omitting later onsets only lowers R, so that the rate of false
alarms remains guaranteed."""
GUARDED = 0.8
"""Power applied to the evidence if no conditions are given after a baseline of a year. The estimated models
are then certain of the effects of weather, whose distribution has longer tails than their normal processes.
The mean of a Bayes factor does not increase thereby (Jensen's inequality), so that the guarantee holds. After
a shorter baseline the models are sufficiently uncertain."""
AGAIN_DAYS = (1.0, 2.0, 3.0, 5.0, 8.0, 13.0, 21.0, 30.0)
"""Times after an alarm at which its change is estimated again [days]."""
KINDS: tuple[Kind, ...] = ("frequency", "damping", "angle")


@dataclass(frozen=True)
class Look:
    """Result of one day.

    Attributes
    ----------
    day : time of the last record
    rest, rest_std : (m_all,) daily means minus the part explained by conditions as believed before the day,
        and their standard deviations without a change since the baseline
    log_r : ln of the detection statistic
    change : Change or None
    pending : if there is a change, the data for estimating it again later
    """

    day: float
    rest: FloatArray
    rest_std: FloatArray
    log_r: float
    change: Change | None = None
    spoken: tuple[DayResult, ...] = field(default=(), repr=False)
    pending: PendingChange | None = field(default=None, repr=False)


def columns_to_watch(baseline: History) -> dict[Kind, IntArray]:
    """Return the columns of each kind of quantity with enough baseline values to be monitored.

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
            remedy="monitor for longer, or set --baseline-days so that it covers the time without a change",
        )
    return kept


def start(
    baseline: History,
    *,
    arl_years: float = 10.0,
    patterns: Sequence[Pattern] = (),
    slopes: Sequence[Slope] = (),
) -> Watch:
    """Return the state of the monitoring at the end of a baseline.

    Parameters
    ----------
    patterns : changes of the frequencies by the causes of a model; they are tested in addition to general
        ones
    slopes : effects of conditions on the frequencies, as far as a model predicts them

    Raises
    ------
    InputError
        If the baseline is too short to learn from.
    """
    return calibrated(learnt(baseline, arl_years, patterns, slopes), baseline)


def learnt(
    baseline: History, arl_years: float, patterns: Sequence[Pattern] = (), slopes: Sequence[Slope] = ()
) -> Watch:
    """Return what :func:`start` does before its threshold is corrected and its changes are selected."""
    limit = still_after(baseline)
    baseline, _, seen = without_still(baseline, never_seen(baseline), limit)
    kept = columns_to_watch(baseline)
    design = with_slow_processes(design_of(baseline), baseline)
    rows, lagged = regressors(design, baseline, fresh(design, baseline))
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
        usual=usual_conditions(design, baseline, rows, limit),
        seen=seen,
    )


def _no_begins(m: int) -> PossibleOnsets:
    return PossibleOnsets(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((0, m, len(STRONGER))))


def step(watch: Watch, day: History) -> tuple[Watch, Look]:
    """Return the state after one day's records, and the day's result.

    Raises
    ------
    InputError
        If the day lies before the last one.
    """
    if not day.days.size or day.days[0] < watch.last_day:
        raise InputError("is not after the last day, or has no records", field="days", value=watch.last_day)
    after, spoken = _with_day(watch, day)
    worth = _worth(after)
    log_r = _log_r(after, worth)
    change, pending = None, None
    if log_r >= after.log_threshold:
        change, onset = change_of(after, worth, log_r)
        pending = _pending(after)
        after = _without(after, change, onset)
    else:
        after = _reconsidered(_merged(after, worth))
    rest, std = (np.concatenate([getattr(s, name) for s in spoken]) for name in ("rest", "rest_std"))
    return after, Look(float(day.days[-1]), rest, std, log_r, change, spoken, pending)


@dataclass(frozen=True)
class PendingChange:
    """A detected change that is estimated again with the records of further days.

    Attributes
    ----------
    watch : state of the monitoring in which the change is not accepted
    alarmed, looked : day of the alarm, and of the last estimate
    """

    watch: Watch
    alarmed: float
    looked: float


def look_again(pending: PendingChange, day: History) -> tuple[PendingChange | None, Change | None]:
    """Return the pending change after one more day, and a new estimate of the change if one is due.

    On the day of the alarm onset, size and kind of a change are uncertain; they are estimated again
    ``AGAIN_DAYS`` later. This raises no further alarm.
    """
    before = pending.watch
    after, _ = _with_day(before, day)
    blocks = (replace(b, log_weights=a.log_weights) for a, b in zip(before.blocks, after.blocks, strict=True))
    # the onset is not after the day of the alarm
    after = _thinned(replace(after, blocks=tuple(blocks)), after.begins.since < pending.alarmed)
    worth = _worth(after)
    age, looked = after.last_day - pending.alarmed, pending.looked - pending.alarmed
    change = None
    if any(looked < due <= age for due in AGAIN_DAYS):
        change, _ = change_of(after, worth, _log_r(after, worth), pending.alarmed)
    if age >= AGAIN_DAYS[-1]:
        return None, change
    return PendingChange(after, pending.alarmed, pending.looked if change is None else after.last_day), change


def continues(pending: PendingChange, later: Change) -> bool:
    """Return whether a later change is the pending one, better known.

    A step that begins with a storm larger than any before is divided between the step and an effect of the
    storm that would heal. While it does not heal, the rest of the step appears as another that began with the
    alarm and moves the same quantities the same way.
    """
    if later.kind == "scatter" or later.began_interval_90[0] > pending.alarmed + 1.0:
        return False
    worth = _worth(pending.watch)
    first, _ = change_of(pending.watch, worth, _log_r(pending.watch, worth), pending.alarmed)
    weight = np.where(later.members, later.size_std, np.inf) ** -2.0
    return first.kind == later.kind and bool(weight @ (first.size * later.size) > 0.0)


def _pending(watch: Watch) -> PendingChange:
    """Return the data for estimating a change again: onsets, and the model most likely with the change."""
    blocks = tuple(with_one_model(b, model_of_change(b, watch.begins.log_stake)) for b in watch.blocks)
    return PendingChange(replace(watch, blocks=blocks), watch.last_day, watch.last_day)


def _log_r(watch: Watch, worth: FloatArray) -> float:
    """Return ln of the detection statistic R."""
    old = watch.begins.days <= watch.last_day - watch.patience_days
    return float(np.logaddexp.reduce((watch.begins.log_stake[:, None] + worth)[old].ravel(), initial=-np.inf))


def _with_day(watch: Watch, day: History) -> tuple[Watch, tuple[DayResult, ...]]:
    """Return the state after a day's records, and their results (of the last part if the day is divided).

    Possible onsets are the first record of the day and the record that divides it. As the latter is chosen
    from the data, it only has its share of the prior weight of all records that might have been chosen.
    """
    missing = np.zeros(day.conditions.shape, dtype=np.bool_)
    if watch.usual is not None and watch.seen is not None:
        day, missing, seen = without_still(day, watch.seen, watch.usual.still_after)
        watch = replace(watch, seen=seen)
    rows, lagged = regressors(watch.design, day, watch.lagged)
    cut = _cut(watch, day, rows)
    today = float(np.floor(day.days[0]))
    stake = np.log(max(today - watch.accounted, 1e-9))
    whole = (slice(None), today, stake + np.log1p(-INSIDE))
    parts = [whole]
    if cut is not None:
        first, places = cut
        parts = [
            (slice(first), *whole[1:]),
            (slice(first, None), float(day.days[first]), stake + np.log(INSIDE / places)),
        ]
    spoken: tuple[DayResult, ...] = ()
    for part, onset, log_stake in parts:
        chosen = np.arange(day.days.size)[part]
        records = day if cut is None else day.rows(np.isin(np.arange(day.days.size), chosen))
        watch, spoken = _with_records(watch, records, rows[part], missing[part], onset, log_stake)
    return replace(watch, lagged=lagged, accounted=max(today, watch.accounted)), spoken


def _cut(watch: Watch, day: History, rows: FloatArray) -> tuple[int, int] | None:
    """Return the index of the record before which a day is divided and the number tried, or None."""
    if day.days.size < 2 * ENOUGH:
        return None
    each = [residuals(block, day, rows) for block in watch.blocks]
    rest, moving = (np.concatenate([one[i] for one in each], axis=1) for i in (1, 3))
    return divided(rest, moving)


def _with_records(
    watch: Watch, records: History, rows: FloatArray, missing: BoolArray, begin: float, log_stake: float
) -> tuple[Watch, tuple[DayResult, ...]]:
    """Return the state after some records of a day, with an onset before the first of them."""
    blocks, spoken = [], []
    for block in watch.blocks:
        lacking = None
        if watch.usual is not None:
            lacking = absent_variance(watch.design, watch.usual, missing, rows, coefficients(block)[0])
        hours, apart, block = hours_of(block, records, rows, lacking)
        block, said = with_hours(block, hours, apart, watch.last_day)
        blocks.append(block)
        spoken.append(said)
    scatter = np.concatenate([log_scatter(b, s) for b, s in zip(blocks, spoken, strict=True)])
    old = watch.begins
    begins = PossibleOnsets(
        np.append(old.days, begin),
        np.append(old.since, watch.last_day),
        np.append(old.log_stake, log_stake),
        np.concatenate([old.log_scatter, np.zeros((1, *scatter.shape))]) + scatter,
    )
    return replace(watch, blocks=tuple(blocks), begins=begins, last_day=float(records.days[-1])), tuple(
        spoken
    )


def _worth(watch: Watch) -> FloatArray:
    """Return ln of the weighted Bayes factors of each onset and tested change, (n_begins, n_bets).

    The tested changes are the directions of each block, then the scatter of each quantity by each factor.
    """
    scatter = watch.begins.log_scatter
    n, m, g = scatter.shape
    share = np.full(m, np.log(SHARES["scatter"] / (m * g)))
    share[np.flatnonzero(watch.without_scatter)] = NOT_TESTED
    parts = [watch.power * log_evidence(block) + block.directions.log_weights for block in watch.blocks]
    louder = watch.power * scatter + share[:, None]
    total = np.concatenate([*parts, louder.reshape(n, m * g)], axis=1)
    return np.asarray(total - np.log(watch.staked))


def _merged(watch: Watch, worth: FloatArray) -> Watch:
    """Return the state with at most ``MOST_BEGINS`` onsets; the nearest to another for its age is merged."""
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
    merged = replace(watch, begins=replace(begins, log_stake=stake))
    return _thinned(merged, np.arange(begins.days.size) != gone)


def _thinned(watch: Watch, keep: BoolArray) -> Watch:
    """Return the state with only some of its onsets."""
    begins = watch.begins
    kept = PossibleOnsets(
        begins.days[keep], begins.since[keep], begins.log_stake[keep], begins.log_scatter[keep]
    )
    return replace(watch, begins=kept, blocks=tuple(thinned(block, keep) for block in watch.blocks))


def _reconsidered(watch: Watch) -> Watch:
    """Return the state with the models' weights partly reset at intervals; R is unchanged."""
    elapsed = watch.last_day - watch.considered
    if elapsed < RECONSIDERED_DAYS:
        return watch
    share = -np.expm1(-elapsed / STEADY_DAYS)
    after = replace(
        watch,
        blocks=tuple(with_weights_reset(block, float(share)) for block in watch.blocks),
        considered=watch.last_day,
    )
    before, now = (np.logaddexp.reduce(_worth(one), axis=1) for one in (watch, after))
    begins = replace(watch.begins, log_stake=watch.begins.log_stake + before - now)
    return replace(after, begins=begins)


def _without(watch: Watch, change: Change, onset: int) -> Watch:
    """Return the state without onsets, ready for the next change, with this change accepted as a step.

    A structure whose frequencies changed has other damping and directions since, which take longer to show:
    these are open from the same onset, so that they are no second change. Damping and directions that change
    leave the frequencies as they were.
    """
    blocks, first = [], 0
    for block in watch.blocks:
        m = len(block.kept)
        members = change.members[first : first + m]
        if change.kind == "scatter":
            louder = np.exp(change.size[first : first + m])
            blocks.append(replace(cleared(block), louder=block.louder * np.where(louder > 1.2, louder, 1.0)))
        elif members.any() or change.kind == "frequency":
            blocks.append(
                with_change_accepted(block, onset, np.ones(m, dtype=np.bool_), len(watch.design.states))
            )
        else:
            blocks.append(cleared(block))
        first += m
    total = watch.begins.log_scatter.shape[1]
    return replace(watch, blocks=tuple(blocks), begins=_no_begins(total))
