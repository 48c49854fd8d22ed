r"""The threshold with which false alarms come as often as is promised.

R_t − t is a martingale while nothing changes, so that the mean time to an alarm is the mean of R at the
alarm. R is evaluated once a day and exceeds a threshold A by a day's evidence: with ARL days as threshold,
alarms come more rarely than promised. For a step that a day's records move by μ standard deviations, A over
the mean of R at the alarm is

.. math:: ν(μ) ≈ \frac{(2/μ)(Φ(μ/2) - 1/2)}{(μ/2)Φ(μ/2) + φ(μ/2)}

(Siegmund & Yakir 2007, p. 112). Each tested step alone raises alarms at the rate of its prior weight times
ν/A; with all of them the mean time between false alarms is A/Σ w ν. The threshold is ARL Σ w ν.

μ is that of the day on which a step of this size reaches the threshold: a large one on its first day, a small
one after months, when unexplained variation leaves little new in a day. Steps that do not reach it in a year
are not tested: they would raise R evenly by their weight, and no alarm, so that these came more rarely than
promised at first and more often later. Nor is the noise of a quantity without scatter within hours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import f as f_distribution, norm

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.constants import YEAR_DAYS
from jackettwin.watching.block import Block, scatter_freedom
from jackettwin.watching.day_parts import INSIDE
from jackettwin.watching.design import regressors
from jackettwin.watching.detectable import informed, replayed
from jackettwin.watching.directions import SHARES, Directions
from jackettwin.watching.history import History
from jackettwin.watching.scatter import STRONGER, log_ratios
from jackettwin.watching.state import Watch

_AGES_DAYS = (1.0, 2.0, 4.0, 8.0, 15.0, 30.0, 60.0, 120.0, 240.0, 365.0)
"""Ages of a step between which the evidence grows evenly, up to the age at which it must have been found."""
_LEAST_DAYS = 60.0
"""Shortest baseline after which the evidence of future days is known."""
_SHARE = 0.5
"""Probability of the models under which a step must reach the threshold to be tested."""
_POINTS = (np.arange(200) + 0.5) / 200.0
"""Probabilities over which the evidence of a day's scatter is averaged."""


def overshoot_share(mu: FloatArray) -> FloatArray:
    """Return ν(μ), threshold over mean of R at an alarm, for steps of μ ≥ 0 standard deviations a look.

    >>> overshoot_share(np.array([0.0, 0.5, 2.0])).round(3)
    array([1.   , 0.736, 0.315])
    """
    half = 0.5 * np.maximum(mu, 1e-6)
    return np.asarray((norm.cdf(half) - 0.5) / half / (half * norm.cdf(half) + norm.pdf(half)))


def calibrated(watch: Watch, baseline: History) -> Watch:
    """Return the state at the end of a baseline with Σ w ν, and without what could not be found in a year.

    Unchanged if the baseline is too short, or the evidence is reduced.
    """
    span = float(baseline.days[-1]) - float(baseline.days[0])
    if watch.power < 1.0 or watch.patience_days > 0.0 or span < _LEAST_DAYS:
        return watch
    ages = np.array([age for age in _AGES_DAYS if age <= span])
    records = replayed(baseline, float(ages[-1]))
    rows, _ = regressors(watch.design, records, watch.lagged)
    days = np.unique(np.floor(records.days))
    looks = np.array([np.sum(days < days[0] + age) for age in ages])
    needed = float(np.log(watch.arl_years * YEAR_DAYS))
    blocks, found = [], 0.0
    for block in watch.blocks:
        info, weights = informed(block, records, rows, watch.last_day, ages)
        reached, mu = _reached(block.directions, info, looks, needed)
        own = np.exp(block.directions.log_weights)
        # a change in an arbitrary direction is like the mean of the named ones
        own = own[:-1] + own[-1] / len(own[:-1])
        tested = np.einsum("k,kds->ds", weights, reached) >= _SHARE
        largest = np.abs(block.directions.sizes).max()  # a step beyond all sizes must be found, however late
        tested |= np.abs(block.directions.sizes) == largest
        directions = block.directions.testing(tested)
        share = np.einsum("k,kds,ds->d", weights, overshoot_share(mu), np.exp(directions.log_size_weights))
        found += float(own @ share)
        blocks.append(replace(block, directions=directions))
    scatter, without = _of_scatter(watch.blocks, records, rows)
    found += SHARES["scatter"] * scatter
    crossing = (1.0 - INSIDE) * found / watch.staked
    return replace(watch, blocks=tuple(blocks), crossing=crossing, without_scatter=without)


def _reached(
    directions: Directions, info: FloatArray, looks: IntArray, needed: float
) -> tuple[BoolArray, FloatArray]:
    """Return whether a step of each model, direction and size reaches the threshold, and μ when it does.

    Both are (n_models, n_directions, n_sizes); where it does not, μ is that of the last days.

    Parameters
    ----------
    info : (n_ages, n_models, m, m)
    looks : (n_ages,) days with records up to each age
    needed : ln of the threshold
    """
    u = directions.vectors
    a = np.maximum.accumulate(np.einsum("di,akij,dj->akd", u, info, u), axis=0)
    rate = np.diff(a, axis=0, prepend=0.0) / np.maximum(np.diff(looks, prepend=0), 1)[:, None, None]
    square = directions.sizes**2
    log_bayes_factor = needed - directions.log_weights[:-1, None] - directions.log_size_weights
    over = 0.5 * a[..., None] * square >= log_bayes_factor
    first = np.where(over.any(axis=0), over.argmax(axis=0), len(a) - 1)
    models, along = np.ogrid[: a.shape[1], : a.shape[2]]
    mu = np.sqrt(rate[first, models[..., None], along[..., None]] * square)
    return np.asarray(over.any(axis=0)), np.asarray(mu)


def _of_scatter(
    blocks: Sequence[Block], records: History, rows: FloatArray
) -> tuple[float, tuple[bool, ...]]:
    """Return the mean of ν over the factors of the noise, and the quantities without scatter (ν = 0)."""
    each, without = [], []
    for block in blocks:
        freedom = scatter_freedom(block, records, rows)
        for n, steady in zip(freedom, block.steadiness, strict=True):
            without.append(bool(n < 1.0))
            if without[-1]:
                each.append(np.zeros(len(STRONGER)))
                continue
            ratio = n * np.array(STRONGER)[:, None] ** 2 * f_distribution.ppf(_POINTS, n, steady)
            shape = np.full(_POINTS.size, n), np.full(_POINTS.size, steady)
            mean = [log_ratios(x, *shape)[:, k].mean() for k, x in enumerate(ratio)]
            each.append(overshoot_share(np.sqrt(2.0 * np.maximum(mean, 0.0))))
    return float(np.mean(each)), tuple(without)
