r"""Sequential monitoring: a state that is updated by each day with records, and the result of the day.

The statistic is that of Shiryaev and Roberts as an e-detector (Shin, Ramdas & Rinaldo 2024),

.. math:: R_t = \sum_{τ \le t} w_τ \, BF(τ, t)

with w_τ the days since the previous onset, so that R_t − t is a martingale while nothing changes.
The mean time to R_t ≥ A is then at least A days, whatever is bet on and however often it is evaluated.
BF is the mean over models, directions and sizes. Old onsets are merged:
the value of one is added to its neighbour's, and R is unchanged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.watching.block import (
    Spoken,
    begin,
    cleared,
    hours_of,
    log_evidence,
    log_scatter,
    thinned,
    watched,
    with_change_accepted,
    with_hours,
    with_weights_reset,
)
from jackettwin.watching.change import Change, change_of
from jackettwin.watching.design import WHOLE_YEAR_DAYS, Slope, design_of, fresh, regressors
from jackettwin.watching.directions import SHARES, Pattern, directions_of
from jackettwin.watching.history import History, Kind, typical
from jackettwin.watching.scatter import STRONGER
from jackettwin.watching.state import Begins, Watch

MOST_BEGINS = 26
"""Number of onsets kept; the work per day grows with it."""
_RECENT = 8
"""Number of latest onsets that are never merged."""
RECONSIDERED_DAYS, STEADY_DAYS = 10.0, 90.0
"""Interval at which the models' weights are partly reset, and the time scale of unexplained variation
[days]."""
FEWEST_DAYS = 7
"""Fewest days with records in a baseline."""
PATIENCE, MOST_PATIENCE_DAYS = 1.0 / 36.0, 10.0
"""Time that a change must last if no conditions are given, as a share of the baseline, and its limit in days:
shorter deviations may be successive storms. Omitting later onsets only lowers R,
so that the promised rate of false alarms is kept."""
GUARDED = 0.8
"""Power applied to the evidence if no conditions are given after a baseline of a year,
when the models are sure of the effects of weather, whose tail is longer than that of any normal process.
The mean of a Bayes factor does not rise by that (Jensen), so that the promise is kept.
After a shorter baseline the models are uncertain enough."""
KINDS: tuple[Kind, ...] = ("frequency", "damping", "angle")


@dataclass(frozen=True)
class Look:
    """Result of one day.

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
        block, said = with_hours(block, hours, apart, watch.last_day)
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
        change, onset = change_of(after, worth, log_r)
        after = _without(after, change, onset)
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
    """Return ln of the value of a unit stake on each onset, by bet, (n_begins, n_bets).

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
    """Return the state with limited onsets; those closest to a neighbour relative to their age are merged."""
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
    """Return the state with the models' weights partly reset at intervals; values of onsets are kept."""
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
    """Return the state without bets, ready for the next change; a change is accepted as a step."""
    blocks, first = [], 0
    for block in watch.blocks:
        m = len(block.kept)
        members = change.members[first : first + m]
        if change.kind == "scatter":
            louder = np.exp(change.size[first : first + m])
            blocks.append(replace(cleared(block), louder=block.louder * np.where(louder > 1.2, louder, 1.0)))
        elif members.any():
            blocks.append(
                with_change_accepted(block, onset, np.ones(m, dtype=np.bool_), len(watch.design.states))
            )
        else:
            blocks.append(cleared(block))
        first += m
    total = watch.begins.log_scatter.shape[1]
    return replace(watch, blocks=tuple(blocks), begins=_no_begins(total))
