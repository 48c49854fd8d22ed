r"""Overshoot of the detection statistic at an alarm, and the threshold that corrects for it.

R_t − t is a martingale while nothing changes, so that the mean time to an alarm is the mean of R at the
alarm. R is evaluated once a day and exceeds a threshold A by a day's evidence: with ARL days as threshold,
alarms come more rarely than promised. For a step that a day's records move by μ standard deviations, A over
the mean of R at the alarm is

.. math:: ν(μ) ≈ \frac{(2/μ)(Φ(μ/2) - 1/2)}{(μ/2)Φ(μ/2) + φ(μ/2)}

(Siegmund & Yakir 2007, p. 112). Each tested step alone raises alarms at the rate of its prior weight times
ν/A; with all of them the mean time between false alarms is A/Σ w ν. The threshold is ARL Σ w ν.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import norm

from jackettwin.arrays import FloatArray
from jackettwin.watching.block import Block
from jackettwin.watching.design import regressors
from jackettwin.watching.detectable import informed, replayed
from jackettwin.watching.directions import SHARES
from jackettwin.watching.history import History
from jackettwin.watching.state import Watch

_AGES_DAYS = (20.0, 30.0)
"""Age of the steps at which a day's evidence is taken: the usual delay of an alarm. Unexplained variation
makes it less for an old step than for a new one."""


def overshoot_share(mu: FloatArray) -> FloatArray:
    """Return ν(μ), threshold over mean of R at an alarm, for steps of μ ≥ 0 standard deviations a look.

    >>> overshoot_share(np.array([0.0, 0.5, 2.0])).round(3)
    array([1.   , 0.736, 0.315])
    """
    half = 0.5 * np.maximum(mu, 1e-6)
    return np.asarray((norm.cdf(half) - 0.5) / half / (half * norm.cdf(half) + norm.pdf(half)))


def crossing_share(watch: Watch, baseline: History) -> float:
    """Return Σ w ν of a state at the end of a baseline; 1 if that is too short, or the evidence is reduced.

    Increased scatter counts as one, which gives a higher threshold.
    """
    span = float(baseline.days[-1]) - float(baseline.days[0])
    if watch.power < 1.0 or watch.patience_days > 0.0 or span < 2.0 * _AGES_DAYS[1]:
        return 1.0
    records = replayed(baseline, _AGES_DAYS[1])
    rows, _ = regressors(watch.design, records, watch.lagged)
    first = records.days < records.days[0] + _AGES_DAYS[0]
    looks = np.unique(np.floor(records.days[~first])).size
    if looks == 0 or not first.any():
        return 1.0
    parts = ((records.rows(first), rows[first]), (records, rows))
    found = SHARES["scatter"] + sum(_of_block(block, parts, watch.last_day, looks) for block in watch.blocks)
    return float(found / watch.staked)


def _of_block(
    block: Block, parts: Sequence[tuple[History, FloatArray]], last_day: float, looks: int
) -> float:
    """Return Σ w ν over the directions and sizes of one kind of quantity; w includes the kind's share."""
    (young, weights), (old, _) = (informed(block, records, rows, last_day) for records, rows in parts)
    u = block.directions.vectors
    a = np.maximum(np.einsum("di,kij,dj->kd", u, old - young, u), 0.0) / looks
    mu = np.sqrt(a)[..., None] * np.abs(block.directions.sizes)
    each = weights @ (overshoot_share(mu) @ np.exp(block.directions.log_size_weights))
    w = np.exp(block.directions.log_weights)
    # a change in an arbitrary direction exceeds like the mean of the named ones
    return float(w[:-1] @ each + w[-1] * each.mean())
