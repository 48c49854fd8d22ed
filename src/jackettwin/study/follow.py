"""Supports estimated after each day from all records so far, and the drift of their stiffness.

The data of records are independent of each other and are fused; errors of the model are common to all records
and enter once. The posterior after a day is that of the prior and all records so far. It equals the result of
using each day's posterior as the next day's prior, without the error of approximating posteriors by draws.
Its cost does not depend on the number of days, since the state holds their sums.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import takewhile
from typing import Literal

from jackettwin.change import Days
from jackettwin.errors import InputError
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.progress import SILENT, Progress
from jackettwin.study.fit_data import updating
from jackettwin.study.follow_result import Followed
from jackettwin.study.in_time.question import question_of
from jackettwin.study.in_time.slope import slope
from jackettwin.study.rotor import mean_wind
from jackettwin.twin import (
    ALL,
    UNDATED,
    Observation,
    TwinConfig,
    TwinModel,
    TwinState,
    advance,
    empty_state,
    observe_files,
    sorted_out,
    twin_model,
)
from jackettwin.twin.observe_files import undated

Each = Literal["day", "record"]


def follow(
    config: TwinConfig,
    *,
    law: str | None = None,
    each: Each = "day",
    prior: Followed | None = None,
    workers: int = 1,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> Followed:
    """Return the estimate after each day of a twin's records.

    Parameters
    ----------
    law : str, optional
        Replaces the first of the twin file, or that of the prior.
    each : {"day", "record"}
        Whether an estimate is made after each UTC day or after each record.
    prior : Followed, optional
        Result to continue; records that it contains are skipped, even under other file names.
    workers : int
        Number of processes that identify records.
    progress : Progress
        Receives a step for each record, then for each day.
    keep : Keep
        Stores identified records for the next run.

    Raises
    ------
    InputError
        If there is no new record, no record has a start time, or the twin has changed.
    """
    if not config.records:
        raise InputError("no new records to follow", file=config.path, field="records", value=[])
    config.require_records()
    model = twin_model(config)
    observations, warnings = _observed(config, model, prior, workers, progress, keep)
    followed = follow_observations(
        config, model, observations, law=law, each=each, prior=prior, progress=progress
    )
    return replace(followed, warnings=(*warnings, *followed.warnings))


def follow_observations(
    config: TwinConfig,
    model: TwinModel,
    observations: Iterable[Observation],
    *,
    law: str | None = None,
    each: Each = "day",
    prior: Followed | None = None,
    progress: Progress = SILENT,
) -> Followed:
    """Return the estimate after each day from identified records; see :func:`follow`."""
    ordered = sorted(observations, key=lambda seen: (_start(seen), seen.record_id))
    state = empty_state(model) if prior is None else prior.state
    moments, findings = [], []
    for observation in ordered:
        if observation.start_utc is None:
            raise undated(observation.name)
        before = state
        state, found = advance(state, observation)
        findings += [str(finding) for finding in found]
        if each == "record" and state is not before:
            moments.append((observation, updating(config, state)))
    used = updating(config, state)
    if ALL not in used.totals:
        raise InputError("no new records to follow", file=config.path, field="records", value=[])
    question = question_of(config, model, used, mean_wind(config, _until(used, 1)), law, prior)
    if prior is not None:
        question.agree(prior)
    if each == "record":
        in_time = question.after_records(moments, progress)
    else:
        as_before = _same_days(state, prior)
        same = sum(1 for own in used.days if own in as_before and own != UNDATED)
        in_time = question.after_days(Days.of(used), same, _until(used, same), progress)
    followed = question.followed(in_time, state)
    return replace(followed, drift=slope(question, used, in_time.days), warnings=tuple(findings))


def follow_days(
    config: TwinConfig,
    model: TwinModel,
    every: Days,
    before: TwinState,
    *,
    same: int = 0,
    prior: Followed | None = None,
) -> tuple[Followed | None, Followed]:
    """Return the result after all days but the last, which may still receive records, and after all days.

    It equals the result of :func:`follow` without the drift, which needs all days at once. Only the window's
    days and those after the first ``same`` are loaded; states hold sums only.

    Parameters
    ----------
    every : Days
        Days of records that may update the supports.
    before : TwinState
        Sums of the first ``same`` days.
    same : int
        Number of first days that are unchanged since ``prior``.

    Raises
    ------
    InputError
        If no day has a mode of the model, or a mode has no standard deviation.
    KeyError
        If a needed day cannot be loaded.
    """
    dates = [own for own in every.identities if own != UNDATED]
    total, until, first = before, before, None
    for own in dates[same:]:
        until, total = total, total.with_day(own, every.load(own))
        total = replace(total, days={})
        first = total if first is None else first
    if ALL not in total.totals or not total.totals[ALL].modes:
        raise InputError("no mode of the model has been seen", file=config.path, field="records")
    question = question_of(config, model, total, mean_wind(config, first), prior=prior)
    past = replace(every, identities={own: every.identities[own] for own in dates[:-1]})
    in_time = question.after_days(past, same, before, SILENT)
    known = question.followed(in_time, until, to_go_on=True) if in_time.days else None
    in_time = replace(in_time, track=replace(in_time.track, every=every))
    whole = question.after_day(in_time, dates[-1], every.load(dates[-1]), total, SILENT)
    return known, question.followed(whole, total)


def _until(state: TwinState, days: int) -> TwinState:
    """Return the sums of a state's first days, without the days themselves."""
    dates = [own for own in state.days if own != UNDATED]
    if days == 0:
        return replace(state, days={}, totals={}, clearest={})
    return replace(state.until(dates[days - 1]), days={})


def _same_days(state: TwinState, prior: Followed | None) -> set[str]:
    """Return the leading days that are unchanged since an earlier run."""
    before = {} if prior is None else prior.state.days
    dates = (date_ for date_ in state.days if date_ != UNDATED)
    return set(takewhile(lambda date_: state.days[date_] is before.get(date_), dates))


def _observed(
    config: TwinConfig,
    model: TwinModel,
    prior: Followed | None,
    workers: int,
    progress: Progress,
    keep: Keep,
) -> tuple[tuple[Observation, ...], tuple[str, ...]]:
    """Return the observations that the prior does not contain, and warnings about their records."""
    known = () if prior is None else [own for day in prior.state.days.values() for own in day.records]
    results = observe_files(
        config.records,
        model,
        defaults=config.defaults,
        known=known,
        dated=True,
        workers=workers,
        progress=progress,
        keep=keep,
    )
    observations, failed = sorted_out(config.records, results)
    if not observations and not failed:
        names = [path.name for path in config.records]
        raise InputError("no new records to follow", file=config.path, field="records", value=names)
    warnings = [f"left out: {one.problem}" for one in failed]
    for one in observations:
        warnings += [f"{one.name}: {finding}" for finding in one.findings if finding.severity != "info"]
    return observations, tuple(warnings)


def _start(seen: Observation) -> float:
    return float("-inf") if seen.start_utc is None else seen.start_utc.timestamp()
