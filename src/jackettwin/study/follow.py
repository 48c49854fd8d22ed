"""Day after day: what the records so far say of the supports, and whether their stiffness drifts.

Records are fused in the data, where they are independent of each other; errors of the model are not, and
enter once. The posterior after a day is that of the prior and of all records so far: what taking each day's
posterior as the next day's prior comes to, without the loss of handing draws on. Its cost does not depend on
how many days there were, since the state holds their sums.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, date, datetime
from itertools import takewhile
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change import Days
from jackettwin.errors import InputError
from jackettwin.files import NOT_KEPT, Keep, digest
from jackettwin.progress import SILENT, Progress
from jackettwin.study.fit_data import recorded_modes, residuals, updating
from jackettwin.study.follow_result import FEWEST_DAYS, STIFFNESS, Followed, Known, Pooled, since_first
from jackettwin.study.in_time.stiffness import Reference, StiffnessLevel, sensitivity
from jackettwin.study.in_time.track import StiffnessTrack, resumed
from jackettwin.study.problem import UpdateEvidence, law_model, model_problem, tied_problem
from jackettwin.study.relaxations import measured_relaxations, relaxing
from jackettwin.study.rotor import RotorDamping, States, mean_wind, operating_states, rotor_damping
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
from jackettwin.twin.state import ConditionSums
from jackettwin.updating import (
    Drift,
    Growth,
    Problem,
    SupportModel,
    find_drift,
    laplace_draws,
    posterior_or_status,
)
from jackettwin.updating.search.solutions import search

Each = Literal["day", "record"]

_WHOLE_SPAN = 2.0
"""Prior standard deviation of the logarithm by which stiffness drifts over the whole time."""
GROWN = 1.3
"""Growth of the number of records after which all together are asked again: until then they tell an eighth
more of damping, and a posterior costs a thousand times what a day of stiffness does."""
MOST_SPANS = 10
"""Spans of days that a drift is fitted to: its cost is that of the tenth day, however many there are."""


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
    """Return what is known after each day of a twin's records.

    Parameters
    ----------
    law : str, optional
        Instead of the twin file's first, or the prior's.
    each : {"day", "record"}
        Whether the records of a UTC day count together, or each on its own.
    prior : Followed, optional
        To go on from; records that are in it already are left out, whatever their files are called.
    workers : int
        Processes that observe records.
    progress : Progress
        Told what is being done: once a record, then once a day.
    keep : Keep
        Keeps what was identified for the next run.

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
    """Return what is known after each day, from what records show; see :func:`follow`."""
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
    question = _question(config, model, used, law, prior)
    if each == "record":
        in_time = question.after_records(moments, prior, progress)
    else:
        in_time = question.after_days(used, prior, _same_days(state, prior), progress)
    days, last = in_time.days, in_time.last
    return Followed(
        name=config.name,
        law=question.support.family.name,
        reference_hz=question.support.reference_hz,
        wind_m_s=question.wind,
        units=question.units,
        days=days,
        drift=question.drift(used, days),
        state=state,
        warnings=tuple(findings),
        pooled=in_time.pooled,
        track=in_time.track.stored(),
        smoothed={} if last is None else in_time.track.levels(last.reference),
        ahead={} if last is None else in_time.track.ahead(last.reference),
    )


def _same_days(state: TwinState, prior: Followed | None) -> set[str]:
    """Return the days, from the first on, that are as an earlier run had them."""
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
    """Return what the records show that the prior does not know, and what is worth saying of them."""
    known = () if prior is None else [own for day in prior.state.days.values() for own in day.records]
    results = observe_files(
        config.records,
        model,
        unsaid=config.unsaid,
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


def _question(
    config: TwinConfig, model: TwinModel, state: TwinState, law: str | None, prior: Followed | None
) -> _Question:
    """Return what is asked of every day, fixed by the last one."""
    wind = mean_wind(config, state.until(next(iter(state.days)))) if prior is None else prior.wind_m_s
    rotor = rotor_damping(config, model.structure, model.modes, wind)
    law = law or (config.update.laws[0] if prior is None else prior.law)
    evidence = _evidence(config, model, rotor, wind, state)
    if evidence.relaxations:
        relaxing(config, (law,))
    question = _Question(config, model, wind, rotor, law_model(config, evidence, law))
    if prior is not None:
        _agree(config, prior, law, question)
    return question


def _evidence(
    config: TwinConfig, model: TwinModel, rotor: RotorDamping, wind: float | None, state: TwinState
) -> UpdateEvidence:
    """Return what some records say, as a law is fitted to it."""
    relaxations = measured_relaxations(config, state)
    return UpdateEvidence(model.structure, state, _states(config, model, state, wind), rotor, relaxations)


def _states(config: TwinConfig, model: TwinModel, state: TwinState, wind: float | None) -> States:
    """Return the data of some records by operating state."""
    measured = recorded_modes(config, state, model.labels)
    fitted = residuals(config, measured)
    if fitted.relative:
        raise InputError(
            "following needs a standard deviation of every measured value",
            file=config.path,
            field="update.weighting",
            value=config.update.weighting,
            allowed="auto or covariance",
        )
    return operating_states(config, measured, state, fitted, wind)


@dataclass(frozen=True)
class _InTime:
    """What is known up to a day: the stiffness so far, of each day, and what all records said together."""

    track: StiffnessTrack
    days: tuple[Known, ...] = ()
    pooled: Mapping[str, Pooled] = field(default_factory=dict)

    @property
    def last(self) -> Pooled | None:
        """What all records said together when they were asked the last time."""
        return next(reversed(dict(self.pooled).values()), None)

    def with_day(self, date_: str, pooled: Pooled, *, asked: bool) -> _InTime:
        """Return what is known after one more day; ``asked`` if all records were asked after it."""
        every = {**self.pooled, date_: pooled} if asked else self.pooled
        if pooled.about is None:
            return replace(self, pooled=every)
        track = self.track.with_day(date_, pooled.about, copied=asked)
        track = track.with_changes(pooled.reference).moved(pooled.reference)
        return replace(self, track=track, pooled=every)

    def with_known(self, known: Known) -> _InTime:
        return replace(self, days=(*self.days, known))

    def again(self, date_: str, known: Known | None, pooled: Pooled | None) -> _InTime:
        """Return what is known with a day that an earlier run knew already."""
        of = pooled or self.last
        if known is None or of is None:
            return self
        return self.with_day(date_, of, asked=pooled is not None).with_known(known)


@dataclass(frozen=True)
class _Question:
    """What is asked of the state after each day."""

    config: TwinConfig
    model: TwinModel
    wind: float | None
    rotor: RotorDamping
    support: SupportModel

    @property
    def units(self) -> dict[str, str]:
        return {p.name: p.unit for p in self.support.parameters}

    def after_days(
        self, state: TwinState, prior: Followed | None, as_before: set[str], progress: Progress
    ) -> _InTime:
        """Return what is known after each day; an earlier run knew it of the first ones."""
        dates = [own for own in state.days if own != UNDATED]
        same = sum(1 for own in dates if own in as_before)
        every = Days.of(state)
        known = {} if prior is None else {day.date: day for day in prior.days if day.date in dates[:same]}
        pooled = {} if prior is None else {d: one for d, one in prior.pooled.items() if d in dates[:same]}
        track = None
        if prior is not None and prior.track is not None and same == len(prior.days) == len(known):
            track = resumed(self.model, every, prior.track, dates[:same], unchanged=True)
        found = _InTime(
            StiffnessTrack(self.model, every) if track is None else track,
            tuple(known.values()) if track is not None else (),
            pooled if track is not None else {},
        )
        running = state.until(dates[same - 1]) if same else replace(state, days={}, totals={}, clearest={})
        for i, date_ in enumerate(dates[0 if track is None else same :], 0 if track is None else same):
            if i < same:
                found = found.again(date_, known.get(date_), pooled.get(date_))
                continue
            running = running.with_day(date_, state.days[date_])
            if ALL not in running.totals or not running.totals[ALL].modes:
                continue
            found = self._after_day(found, date_, running, progress)
        return found

    def _after_day(self, found: _InTime, date_: str, running: TwinState, progress: Progress) -> _InTime:
        """Return what is known after one more day."""
        day, time = running.days[date_], running.days[date_].time_utc
        if time is None:
            return found
        progress(f"update after {date_}")
        return self._moment(found, date_, running, Known(date_, time, len(day.records), "", {}, {}), progress)

    def _moment(
        self, found: _InTime, date_: str, running: TwinState, moment: Known, progress: Progress
    ) -> _InTime:
        number, last = running.totals[ALL].conditions.records, found.last
        new = None if last is not None and number < GROWN * last.records else self._pooled(running, progress)
        pooled = last if new is None else new
        if pooled is None:
            raise ValueError("nothing is known of all records")
        found = found.with_day(date_, pooled, asked=new is not None)
        known = replace(
            moment, evidence=self._identity(running), median=pooled.median, interval_90=pooled.interval_90,
            status=pooled.status,
        )  # fmt: skip
        return found.with_known(self._on_the_day(known, found.track.level(pooled.reference)))

    def _on_the_day(self, known: Known, level: StiffnessLevel | None) -> Known:
        """Return what is known with the stiffness of the day."""
        if level is None:
            return known
        stiff = [name for name, unit in self.units.items() if unit == STIFFNESS]
        own = dict(zip(stiff, level.absolute, strict=True))
        return replace(
            known,
            median={**known.median, **{name: span[1] for name, span in own.items()}},
            interval_90={**known.interval_90, **{name: (span[0], span[2]) for name, span in own.items()}},
            relative=level.relative,
        )

    def after_records(
        self, moments: Sequence[tuple[Observation, TwinState]], prior: Followed | None, progress: Progress
    ) -> _InTime:
        """Return what is known after each record; the stiffness is that of the day so far."""
        found = _InTime(StiffnessTrack(self.model, Days.of(empty_state(self.model))))
        if prior is not None:
            found = replace(found, days=prior.days, pooled=dict(prior.pooled))
        before = found.track
        for seen, state in moments:
            if seen.start_utc is None:
                raise ValueError("a record that is followed has a start")
            time = seen.start_utc.astimezone(UTC)
            date_ = time.date().isoformat()
            if found.track.dates and found.track.dates[-1] != date_:
                before = found.track
            found = replace(found, track=replace(before, every=Days.of(state)))
            progress(f"update after {seen.name}")
            known = Known(time.isoformat(), time, 1, "", {}, {})
            found = self._moment(found, date_, state, known, progress)
        return found

    def _known(self, state: TwinState, moment: Known, progress: Progress = SILENT) -> Known:
        """Return the moment with what the records up to then say together."""
        found = self._pooled(state, progress)
        return replace(
            moment, evidence=self._identity(state), median=found.median, interval_90=found.interval_90,
            status=found.status,
        )  # fmt: skip

    def _pooled(self, state: TwinState, progress: Progress = SILENT) -> Pooled:
        """Return what some records say together."""
        evidence = _evidence(self.config, self.model, self.rotor, self.wind, state)
        highest = max(mode for data, _ in evidence.states.values() for mode in data.modes)
        problem = model_problem(self.config, evidence, self.support.reaching(highest))
        log_theta, status = _draws(self.config, problem, progress)
        names = [p.name for p in problem.parameters]
        low, median, high = np.exp(np.quantile(log_theta, [0.05, 0.5, 0.95], axis=0))
        stiff = [i for i, p in enumerate(problem.parameters) if p.unit == STIFFNESS]
        modes = tuple(
            sorted(
                {m for data, _ in evidence.states.values() for m in data.modes} & {*self.config.update.modes}
            )
        )
        about = sensitivity(problem, np.log(median), stiff, modes) if stiff and modes else None
        return Pooled(
            state.totals[ALL].conditions.records,
            dict(zip(names, median.tolist(), strict=True)),
            dict(zip(names, zip(low.tolist(), high.tolist(), strict=True), strict=True)),
            status,
            about,
            Reference.of(log_theta, stiff),
        )

    def _identity(self, state: TwinState) -> str:
        """Return the identity of everything that an estimate follows from."""
        return digest([state.totals, state.clearest, self.wind, self.support.family.name, self.units])

    def drift(self, state: TwinState, days: Sequence[Known]) -> Drift | None:
        """Return the slope of all stiffness through the frequencies and damping of spans of days."""
        if len(days) < FEWEST_DAYS:
            return None
        config = self.config
        exact = replace(config, update=config.update.model_copy(update={"model_errors": ()}))
        states: States = {}
        times: dict[str, float] = {}
        for i, span in enumerate(_spans(state)):
            t = _mean_time(span, days[0].time_utc)
            for name, (data, factors) in _states(exact, self.model, span, self.wind).items():
                said = span.totals[ALL].conditions
                states[f"{i}: {name}"] = (data, factors or _usual(config, said, self.wind))
                times[f"{i}: {name}"] = t
        growing = tuple(p.name for p in self.support.parameters if p.unit == STIFFNESS)
        growth = Growth(growing, times, _WHOLE_SPAN / float(since_first([d.time_utc for d in days])[-1]))
        errors = _model_errors(config, self.model.labels)
        problem = tied_problem(config, self.support, states, errors=errors, growth=growth)
        z = [days[-1].median.get(p.name, 1.0) for p in problem.parameters[:-1]]
        return find_drift(problem, np.log(z))


def _draws(config: TwinConfig, problem: Problem, progress: Progress) -> tuple[FloatArray, str]:
    """Return draws of ln θ and ``"ok"``; those of Laplace's method, and why, if there is no posterior."""
    how = config.update
    posterior, status = posterior_or_status(
        problem, sampler=how.sampler, particles=how.particles, seed=how.seed, progress=progress
    )
    if posterior is not None:
        return posterior.log_theta, status
    found = search(problem, starts=how.starts_for(problem), seed=how.seed, progress=progress)
    return laplace_draws(problem, found.solutions[0].theta, seed=how.seed), status


def _spans(state: TwinState) -> list[TwinState]:
    """Return the days in spans of 1, 2, 4, … days, ``MOST_SPANS`` at most, those with modes."""
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
    """Return when the records of a span were taken, in days after the first day."""
    times = [(day.time_utc, len(day.records)) for day in span.days.values()]
    known = [(time, weight) for time, weight in times if time is not None]
    at = since_first([first, *(time for time, _ in known)])[1:]
    return float(np.average(at, weights=[weight for _, weight in known]))


def _usual(config: TwinConfig, said: ConditionSums, wind: float | None) -> dict[str, float]:
    """Return the dashpots' factors in the mean wind of some records."""
    if wind is None or said.wind_m_s is None:
        return {}
    return {name: said.wind_m_s / wind for name in config.update.dashpots}


def _model_errors(config: TwinConfig, labels: tuple[str, ...]) -> dict[str, float]:
    """Return what the model may miss of each datum, every day alike."""
    errors = {}
    for mode in config.update.modes:
        error = config.update.model_error(mode)
        if error.frequency > 0.0:
            errors[f"f{mode}"] = error.frequency
        if error.damping > 0.0 and config.update.fits_damping(labels[mode - 1]):
            errors[f"ζ{mode}"] = error.damping
    return errors


def _agree(config: TwinConfig, prior: Followed, law: str, question: _Question) -> None:
    """Refuse a prior of another structure, law or set of parameters."""
    model, names = question.support, list(question.units)
    same = abs(prior.reference_hz / model.reference_hz - 1.0) < 1e-6
    if not same or prior.law != law or list(prior.units) != names:
        raise InputError(
            "the prior is of another law, structure or set of parameters",
            file=config.path,
            field="prior",
            value=f"{prior.law}: {', '.join(prior.units)}; {prior.reference_hz:.6g} Hz on pinned feet",
            allowed=f"{law}: {', '.join(names)}; {model.reference_hz:.6g} Hz",
            remedy="follow all records anew, without the prior",
        )


def _start(seen: Observation) -> float:
    return float("-inf") if seen.start_utc is None else seen.start_utc.timestamp()
