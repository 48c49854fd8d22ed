"""One common slope of all stiffness, fitted to frequencies and damping of all days."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import date, datetime

import numpy as np

from jackettwin.study.follow_result import FEWEST_DAYS, STIFFNESS, DayEstimate, since_first
from jackettwin.study.in_time.question import FollowQuestion, data_of
from jackettwin.study.problem import tied_problem
from jackettwin.study.rotor import States
from jackettwin.twin import ALL, UNDATED, TwinConfig, TwinState
from jackettwin.updating import Drift, Growth, find_drift

_WHOLE_SPAN = 2.0
"""Prior standard deviation of the change of ln k by drift over the whole time."""
MOST_SPANS = 10
"""Largest number of spans of days that a drift is fitted to, so that its cost stays that of ten days."""


def slope(question: FollowQuestion, state: TwinState, days: Sequence[DayEstimate]) -> Drift | None:
    """Return the common slope of all stiffness, fitted to frequencies and damping of spans of days."""
    if len(days) < FEWEST_DAYS:
        return None
    config = question.config
    exact = replace(config, update=config.update.model_copy(update={"model_errors": ()}))
    states: States = {}
    times: dict[str, float] = {}
    for i, span in enumerate(spans_of(state)):
        t = _mean_time(span, days[0].time_utc)
        for name, (data, factors) in data_of(exact, question.model, span, question.wind).items():
            wind = span.totals[ALL].conditions.wind_m_s
            states[f"{i}: {name}"] = (data, factors or _usual(config, wind, question.wind))
            times[f"{i}: {name}"] = t
    growing = tuple(p.name for p in question.support.parameters if p.unit == STIFFNESS)
    growth = Growth(growing, times, _WHOLE_SPAN / float(since_first([d.time_utc for d in days])[-1]))
    errors = _model_errors(config, question.model.labels)
    problem = tied_problem(config, question.support, states, errors=errors, growth=growth)
    z = [days[-1].median.get(p.name, 1.0) for p in problem.parameters[:-1]]
    return find_drift(problem, np.log(z))


def spans_of(state: TwinState) -> list[TwinState]:
    """Return the days with modes in spans of 1, 2, 4, … days, ``MOST_SPANS`` at most."""
    dates = [own for own in state.days if own != UNDATED]
    days = {own: date.fromisoformat(own).toordinal() for own in dates}
    width = 1
    while len({ordinal // width for ordinal in days.values()}) > MOST_SPANS:
        width *= 2
    groups: dict[int, list[str]] = {}
    for own, ordinal in days.items():
        groups.setdefault(ordinal // width, []).append(own)
    spans = [
        replace(state, days={own: state.days[own] for own in group}).until(group[-1])
        for group in groups.values()
    ]
    return [span for span in spans if span.totals[ALL].modes]


def _mean_time(span: TwinState, first: datetime) -> float:
    """Return the mean time of a span's records, in days after the first day."""
    times = [(day.time_utc, len(day.records)) for day in span.days.values()]
    known = [(time, weight) for time, weight in times if time is not None]
    at = since_first([first, *(time for time, _ in known)])[1:]
    return float(np.average(at, weights=[weight for _, weight in known]))


def _usual(config: TwinConfig, own: float | None, wind: float | None) -> dict[str, float]:
    """Return the dashpots' factors in the mean wind of some records."""
    if wind is None or own is None:
        return {}
    return {name: own / wind for name in config.update.dashpots}


def _model_errors(config: TwinConfig, labels: tuple[str, ...]) -> dict[str, float]:
    """Return the model error of each datum, the same on every day."""
    errors = {}
    for mode in config.update.modes:
        error = config.update.model_error(mode)
        if error.frequency > 0.0:
            errors[f"f{mode}"] = error.frequency
        if error.damping > 0.0 and config.update.fits_damping(labels[mode - 1]):
            errors[f"ζ{mode}"] = error.damping
    return errors
