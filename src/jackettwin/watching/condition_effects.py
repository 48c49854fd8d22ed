r"""What conditions do: their shares of a variance, and what they do unseen, which is unknown, not nothing.

Where a condition with the effect xᵀβ on a quantity is not seen, its regressors are their mean, and the
effect that a day lacks has the variance

.. math:: \frac{1 + r}{1 - r} \, β^T C β

with C the covariance of the regressors over the baseline and r the correlation of the condition from one day
to the next: of a storm that lasts, several days are one value. Each regressor's standard deviation is made so
large that a normal one reaches as far as one value of a thousand does, since storms are rare and far from the
mean. All modes lack the effect together, so that each has as many times the variance as there are modes:
their mean is then no better known than one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.watching.block import Block
from jackettwin.watching.design import Design
from jackettwin.watching.history import History

_BY_CHANCE = 1e-6
"""Chance of as many equal values on end from which a sensor stands still."""
_REPEATING = 0.05, 1.0 / 3.0
"""Share of a condition's values that the next repeats: the least that is believed, and the largest with which
a sensor is judged. Rounded ones, or those of an hour beside records of ten minutes, repeat more often."""
_AWAY_DAYS = 0.25
"""Time after its last value from which a condition is missing [days]: hourly weather beside records of ten
minutes is not."""
_FEWEST = 50
"""Fewest values that tell how often a condition repeats."""
_RARE = 1e-3
"""Share of the baseline's values beyond which the tail is judged."""
_MOST_LASTING = 0.95
"""Largest correlation from one day to the next."""


@dataclass(frozen=True)
class UsualConditions:
    """What a baseline says of its conditions.

    Attributes
    ----------
    still_after : (c,) equal values on end from which its sensor stands still; inf if it is not judged
    spread : (k, k) covariance of the regressors of one state of operation times (1 + r)/(1 − r), with their
        tails; zero between regressors of different conditions
    """

    still_after: FloatArray
    spread: FloatArray


@dataclass(frozen=True)
class LastSeen:
    """State of the conditions' sensors: value, how often it was seen on end, and when last, (c,) each."""

    value: FloatArray
    repeats: FloatArray
    day: FloatArray


def never_seen(history: History) -> LastSeen:
    """Return the state before the first record."""
    number = history.conditions.shape[1]
    return LastSeen(np.full(number, np.nan), np.zeros(number), np.full(number, -np.inf))


def still_after(baseline: History) -> FloatArray:
    """Return the number of equal values from which the sensor of each condition stands still, (c,).

    Examples
    --------
    >>> days, none = np.arange(200.0), np.full((200, 1), np.nan)
    >>> wind = np.column_stack([np.sin(days), np.round(np.sin(days / 20.0))])
    >>> told = History(days, ("f",), none, none, none, none, wind, ("u", "v"), np.zeros(200, int))
    >>> still_after(told).tolist()
    [6.0, inf]
    """
    out = []
    for x in baseline.conditions.T:
        runs = _run_lengths(x[np.isfinite(x)])
        share = max(float(np.mean(runs > 1)) if runs.size >= _FEWEST else 1.0, _REPEATING[0])
        judged = share <= _REPEATING[1]
        out.append(1.0 + np.ceil(np.log(_BY_CHANCE) / np.log(share)) if judged else np.inf)
    return np.array(out)


def _run_lengths(x: FloatArray) -> FloatArray:
    starts = np.flatnonzero(np.diff(x, prepend=np.nan) != 0.0)
    return np.diff(starts, append=x.size).astype(np.float64)


def without_still(history: History, seen: LastSeen, limit: FloatArray) -> tuple[History, BoolArray, LastSeen]:
    """Return the records without values of sensors that stand still, what is missing (n, c), and the state.

    Of a sensor that stands still all equal values among these records are left out.

    Parameters
    ----------
    limit : (c,) number of equal values from which a sensor stands still
    """
    conditions = history.conditions.copy()
    missing = np.zeros(conditions.shape, dtype=np.bool_)
    value, repeats, last = seen.value.copy(), seen.repeats.copy(), seen.day.copy()
    for k, x in enumerate(conditions.T):
        there = np.flatnonzero(np.isfinite(x))
        if there.size:
            known = x[there]
            begins = np.diff(known, prepend=value[k]) != 0.0
            run = np.cumsum(begins)
            long = np.bincount(run).astype(np.float64)
            long[0] += repeats[k] if long[0] else 0.0
            x[there[long[run] >= limit[k]]] = np.nan
            value[k], repeats[k] = known[-1], long[run[-1]]
        good = np.where(np.isfinite(x), history.days, -np.inf)
        before = np.maximum.accumulate(np.append(last[k], good))
        missing[:, k] = history.days - before[1:] > _AWAY_DAYS
        last[k] = before[-1]
    return replace(history, conditions=conditions), missing, LastSeen(value, repeats, last)


def unseen_share(history: History, limit: FloatArray) -> FloatArray:
    """Return the share of the records in which a condition is missing or its sensor stands still, (c,)."""
    seen, _, _ = without_still(history, never_seen(history), limit)
    return np.asarray(np.mean(~np.isfinite(seen.conditions), axis=0))


def usual_conditions(
    design: Design, baseline: History, rows: FloatArray, limit: FloatArray
) -> UsualConditions:
    """Return what a baseline with regressors ``rows`` (n, p) says of its conditions."""
    k = len(design.columns)
    slopes = rows[:, len(design.states) :].reshape(len(rows), design.sloped, k).sum(axis=1)
    slopes = slopes[np.isfinite(slopes).all(axis=1)]
    source = np.array([column.source for column in design.columns], dtype=np.intp)
    spread = np.zeros((k, k))
    if len(slopes) > 1 and k:
        same = (source[:, None] == source) & (source >= 0)
        lasting = np.array([_lasting(baseline, one) if one >= 0 else 0.0 for one in source])
        far = _tails(slopes)
        spread = np.where(same, np.atleast_2d(np.cov(slopes.T)) * lasting * np.outer(far, far), 0.0)
    return UsualConditions(limit, spread)


def _tails(x: FloatArray) -> FloatArray:
    """Return how far the tail of every regressor is over a normal one's, at least 1, (k,)."""
    off = np.abs(x - x.mean(axis=0))
    far = np.quantile(off, 1.0 - _RARE, axis=0) / np.maximum(np.std(x, axis=0), 1e-12)
    return np.asarray(np.maximum(far / norm.isf(0.5 * _RARE), 1.0))


def _lasting(baseline: History, source: int) -> float:
    """Return (1 + r)/(1 − r) of a condition's daily means."""
    x, day = baseline.conditions[:, source], np.floor(baseline.days)
    there = np.isfinite(x)
    days, at = np.unique(day[there], return_inverse=True)
    mean = np.bincount(at, x[there]) / np.bincount(at)
    next_day = np.flatnonzero(np.diff(days) == 1.0)
    if next_day.size < 3 or np.std(mean) == 0.0:
        return 1.0
    off = mean - mean.mean()
    r = float(np.clip(np.mean(off[next_day] * off[next_day + 1]) / np.mean(off**2), 0.0, _MOST_LASTING))
    return (1.0 + r) / (1.0 - r)


def absent_variance(
    design: Design, usual: UsualConditions, missing: BoolArray, rows: FloatArray, coefficients: FloatArray
) -> FloatArray:
    """Return the variance of the effects that some records of a day lack, (n, m).

    It is as many times larger as there are records: those of a day lack the same.

    Parameters
    ----------
    missing : (n, c) bool
    rows : (n, p) regressors
    coefficients : (m, p) of the quantities
    """
    n, states, k = len(rows), len(design.states), len(design.columns)
    out = np.zeros((n, len(coefficients)))
    if not missing.any():
        return out
    source = np.array([column.source for column in design.columns], dtype=np.intp)
    place = np.nan_to_num(rows[:, :states]).argmax(axis=1)
    place = np.where(place < design.sloped, place, 0)
    for state in np.unique(place):
        beta = coefficients[:, states + k * state : states + k * (state + 1)]
        for condition in np.flatnonzero(missing.any(axis=0)):
            own = np.where(source == condition, beta, 0.0)
            effect = np.einsum("qi,ij,qj->q", own, usual.spread, own)
            out += np.outer(missing[:, condition] & (place == state), effect)
    return n * len(coefficients) * out


def shares(
    block: Block, design: Design, rows: FloatArray, values: FloatArray
) -> tuple[dict[str, float], ...]:
    """Return for each quantity the share of its variance over the baseline by condition.

    The share of a condition is the covariance of its contribution with the quantity, so that the shares add
    up to the part explained by all conditions. "slow" is the share of unexplained slow processes, "noise"
    that of identification.

    Parameters
    ----------
    rows : (n, p) regressors of the baseline
    values : (n, m) logarithms of the quantities, NaN where missing
    """
    names = np.array(design.names)
    out = []
    for q in range(len(block.kept)):
        seen = np.isfinite(values[:, q]) & np.isfinite(rows).all(axis=1)
        y = values[seen, q] - values[seen, q].mean()
        total = float(np.mean(y**2))
        parts = rows[seen] * block.reference[q]
        share = {
            str(name): float(np.mean((parts[:, names == name].sum(axis=1)) * y) / total)
            for name in dict.fromkeys(names)
            if name != "level"
        }
        memory = block.memories[0]
        slow = float(memory.std[q] ** 2) / total
        share["slow, unexplained"] = min(slow, max(0.0, 1.0 - sum(share.values())))
        share["noise"] = max(0.0, 1.0 - sum(share.values()))
        out.append(share)
    return tuple(out)


def slopes(block: Block, design: Design) -> tuple[dict[str, float], ...]:
    """Return the steady-state effect of a unit of each condition on each quantity, about the baseline's mean.

    The effects are on logarithms, or directions [rad], in the most frequent operating state, after all lags.
    """
    first = len(design.states)
    out: tuple[dict[str, float], ...] = tuple({} for _ in block.kept)
    for place, column in enumerate(design.columns, start=first):
        if column.shape == "line":
            for found, per_scale in zip(out, block.reference[:, place], strict=True):
                found[column.name] = found.get(column.name, 0.0) + float(per_scale) / column.scale
    return out


def unexplained_std(block: Block) -> FloatArray:
    """Return the standard deviation of the slow processes, averaged over models, (m,)."""
    weight = np.exp(block.log_weights)
    each = np.array([memory.std**2 for memory in block.memories])
    return np.asarray(np.sqrt(weight @ each))
