r"""Probability of detection: the probability that a change raises an alarm within some days.

The information A of the innovations on a step does not depend on the measured values but on the times and
accuracy of the measurements, on the unexplained variation and on the uncertainty left by the baseline. A step
s of all quantities of a kind is tested along directions u, with

.. math:: a = u^T A u, \quad c \sim N(u^T A s, a)

and raises an alarm if its prior weight times the Bayes factor of a and c reaches the threshold. Future
records are assumed to be as many and as accurate as those of the same number of days at the end of the
baseline. Of a horizon longer than the baseline the answer is projected: the baseline's records are taken to
come again and again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm

from jackettwin.arrays import FloatArray
from jackettwin.watching.block import WINDOW_DAYS, Block, residuals
from jackettwin.watching.day_parts import INSIDE
from jackettwin.watching.design import regressors
from jackettwin.watching.directions import Directions, log_along
from jackettwin.watching.history import History
from jackettwin.watching.hours import by_hour
from jackettwin.watching.memory import empty_bank, filtered
from jackettwin.watching.state import Watch

CHANCE = 0.95
"""Probability of detection that defines the smallest detectable change."""
_WHOLE = 0.9
"""Share of the days considered that the end of a baseline must cover."""
_LEAST_DAYS = 60.0
"""Shortest baseline whose records are projected beyond its length [days]."""
_LEAST = 0.01
"""Weight below which a model is ignored."""
_Z = np.linspace(-4.0, 4.0, 65)
"""Standard normal values over which the probability is summed."""
_HALVINGS = 14
"""Number of halvings of the range of ln size; the error is below a thousandth for a range of a factor of
twenty."""


@dataclass(frozen=True)
class Sight:
    """Information that some days of records would give on a step.

    Attributes
    ----------
    days : number of days
    directions : for each block, the tested directions with their weights
    info : for each block, (n_models, m, m) A of a step at the beginning of these days
    weights : for each block, (n_models,) weights of the models
    log_needed : ln of the Bayes factor that raises an alarm, divided by the power applied to the evidence
    projected : whether the days are more than those of the baseline
    """

    days: float
    directions: tuple[Directions, ...]
    info: tuple[FloatArray, ...]
    weights: tuple[FloatArray, ...]
    log_needed: float
    power: float
    projected: bool = False

    def chance(self, steps: FloatArray) -> float:
        """Return the probability that a change is detected by its clearest kind of quantity.

        Parameters
        ----------
        steps : (n_draws, m_all) of all quantities, as probable one as the other
        """
        found, first = [np.zeros(len(steps))], 0
        for directions, info, weights in zip(self.directions, self.info, self.weights, strict=True):
            part = steps[:, first : first + info.shape[1]]
            found.append(np.array([weights @ self._each(directions, info, step) for step in part]))
            first += info.shape[1]
        return float(np.max(found, axis=0).mean())

    def _each(self, directions: Directions, info: FloatArray, step: FloatArray) -> FloatArray:
        """Return the probability of detection of a step (m,) under each model."""
        u = directions.vectors
        a = np.einsum("di,kij,dj->kd", u, info, u)
        c = np.einsum("di,kij,j->kd", u, info, step)
        drawn = c[..., None] + np.sign(c)[..., None] * np.sqrt(a)[..., None] * _Z
        each = np.moveaxis(drawn, 2, 1)
        worth = log_along(directions, np.repeat(a[:, None], _Z.size, axis=1), np.ascontiguousarray(each))
        best = (self.power * worth + directions.log_weights[:-1]).max(axis=2)
        mass = norm.pdf(_Z) / norm.pdf(_Z).sum()
        return np.asarray((best >= self.log_needed) @ mass)

    def smallest(self, step: Callable[[float], FloatArray], low: float, high: float) -> float | None:
        """Return the smallest size within limits detected with ``CHANCE``; None if the largest is not.

        Parameters
        ----------
        step : function that returns the changes of all quantities (n_draws, m_all) at a size
        """
        if self.chance(step(high)) < CHANCE:
            return None
        ends = np.log([low, high])
        for _ in range(_HALVINGS):
            middle = float(ends.mean())
            ends[1 if self.chance(step(float(np.exp(middle)))) >= CHANCE else 0] = middle
        return float(np.exp(ends[1]))


def sight(watch: Watch, baseline: History, days: float) -> Sight | None:
    """Return the information of some days after a baseline on a step; None if the baseline is too short.

    Parameters
    ----------
    watch : state at the end of the baseline
    """
    span = float(baseline.days[-1]) - float(baseline.days[0])
    projected = span < _WHOLE * days
    if (projected and span < _LEAST_DAYS) or days <= watch.patience_days:
        return None
    records = replayed(baseline, days)
    rows, _ = regressors(watch.design, records, watch.lagged)
    known = [informed(block, records, rows, watch.last_day, np.array([np.inf])) for block in watch.blocks]
    gap = days / np.unique(np.floor(records.days)).size
    needed = watch.log_threshold - np.log(max(gap, 1.0) * (1.0 - INSIDE)) + np.log(watch.staked)
    return Sight(
        days,
        tuple(block.directions for block in watch.blocks),
        tuple(info[0] for info, _ in known),
        tuple(weights for _, weights in known),
        float(needed),
        watch.power,
        projected,
    )


def replayed(baseline: History, days: float) -> History:
    """Return the records of a baseline's last days, as if they followed it; more than it has come again.

    Examples
    --------
    >>> none = np.full((3, 1), np.nan)
    >>> days, state = np.array([0.5, 1.5, 2.5]), np.zeros(3, int)
    >>> baseline = History(days, ("f",), none, none, none, none, none, ("t",), state)
    >>> replayed(baseline, 5.0).days.tolist(), replayed(baseline, 1.5).days.tolist()
    ([3.5, 4.5, 5.5, 6.5, 7.5], [3.5, 4.5])
    """
    first, end = float(np.floor(baseline.days[0])), float(np.ceil(baseline.days[-1]))
    rounds = max(int(np.ceil(days / (end - first))), 1)
    n = baseline.days.size
    again = baseline.rows(np.tile(np.arange(n), rounds))
    again = replace(again, days=again.days + np.repeat(np.arange(rounds), n) * (end - first))
    records = again.rows(again.days > again.days[-1] - days)
    return replace(records, days=records.days + end - np.floor(records.days[0]))


def informed(
    block: Block, records: History, rows: FloatArray, last_day: float, ages: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return A of a step before some records at each age, (n_ages, n_models, m, m), and the models' weights.

    Parameters
    ----------
    ages : (n_ages,) ascending [days]
    """
    y, _, variance, _ = residuals(block, records, rows)
    hours = by_hour(records.days, records.states, np.nan_to_num(rows), y, variance, WINDOW_DAYS)
    live = [i for i, weight in enumerate(block.log_weights) if np.exp(weight) > _LEAST]
    age = np.searchsorted(ages, hours.days - np.floor(records.days[0]), side="right")
    info = []
    for i in live:
        belief, last = block.beliefs[i], last_day
        bank, grown = empty_bank(len(block.kept), belief.mean.size).with_begin(), []
        for k in range(len(ages)):
            part = hours.at(age == k)
            if part.days.size:
                done = filtered(block.memories[i], belief, bank, part, last)
                belief, bank, last = done.belief, done.bank, float(part.days[-1])
            grown.append(bank.info[0])
        info.append(grown)
    weights = np.exp(block.log_weights[live])
    return np.swapaxes(np.array(info), 0, 1), np.asarray(weights / weights.sum())
