"""Estimation problem common to all days, and the estimates after each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC
from functools import cached_property

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.change import Days
from jackettwin.errors import InputError
from jackettwin.files import digest
from jackettwin.intervals import QUANTILES
from jackettwin.progress import SILENT, Progress
from jackettwin.study.fit_data import recorded_modes, residuals
from jackettwin.study.follow_result import STIFFNESS, DayEstimate, Followed, PooledEstimate
from jackettwin.study.in_time.stiffness import Reference, StiffnessLevel, sensitivity
from jackettwin.study.in_time.track import StiffnessTrack, resumed
from jackettwin.study.problem import UpdateEvidence, law_model, model_problem
from jackettwin.study.relaxations import measured_relaxations, relaxing
from jackettwin.study.rotor import RotorDamping, States, operating_states, rotor_damping
from jackettwin.twin import (
    ALL,
    UNDATED,
    Day,
    Observation,
    TwinConfig,
    TwinModel,
    TwinState,
    empty_state,
)
from jackettwin.updating import (
    Problem,
    SupportModel,
    laplace_draws,
    posterior_or_status,
    weighted_draws,
)
from jackettwin.updating.search.solutions import search

GROWN = 1.3
"""Growth of the number of records after which the posterior of all is sampled again. Until then they reduce
the deviation of damping by an eighth, and a posterior costs a thousand times a day's update of stiffness."""


def question_of(
    config: TwinConfig,
    model: TwinModel,
    state: TwinState,
    wind: float | None,
    law: str | None = None,
    prior: Followed | None = None,
) -> FollowQuestion:
    """Return the estimation problem of every day, as of the last day or as an earlier run had it."""
    rotor = rotor_damping(config, model.structure, model.modes, wind if prior is None else prior.wind_m_s)
    own = config.update.laws[0] if prior is None else prior.law
    return FollowQuestion(config, model, state, rotor, law or own, wind, prior)


def _evidence(
    config: TwinConfig, model: TwinModel, rotor: RotorDamping, wind: float | None, state: TwinState
) -> UpdateEvidence:
    """Return the data of some records in the form that a law is fitted to."""
    relaxations = measured_relaxations(config, state)
    return UpdateEvidence(model.structure, state, data_of(config, model, state, wind), rotor, relaxations)


def data_of(config: TwinConfig, model: TwinModel, state: TwinState, wind: float | None) -> States:
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
    return operating_states(
        config, measured, state, fitted, wind, assembly=model.structure, numbered=model.modes
    )


@dataclass(frozen=True)
class InTime:
    """Estimates up to a day: the stiffness track, the estimate of each day, and those of all records."""

    track: StiffnessTrack
    days: tuple[DayEstimate, ...] = ()
    pooled: Mapping[str, PooledEstimate] = field(default_factory=dict)

    @property
    def last(self) -> PooledEstimate | None:
        """The latest estimate from all records together."""
        return next(reversed(dict(self.pooled).values()), None)

    def with_day(self, date_: str, pooled: PooledEstimate, *, asked: bool) -> InTime:
        """Return the estimates after one more day; ``asked`` if all records were evaluated after it."""
        every = {**self.pooled, date_: pooled} if asked else self.pooled
        if pooled.about is None:
            return replace(self, pooled=every)
        track = self.track.with_day(date_, pooled.about, copied=asked)
        track = track.with_changes(pooled.reference).moved(pooled.reference)
        return replace(self, track=track, pooled=every)

    def with_known(self, known: DayEstimate) -> InTime:
        """Return it with the estimate after the last day."""
        return replace(self, days=(*self.days, known))

    def again(self, date_: str, known: DayEstimate | None, pooled: PooledEstimate | None) -> InTime:
        """Return the estimates with a day that an earlier run evaluated already."""
        of = pooled or self.last
        if known is None or of is None:
            return self
        return self.with_day(date_, of, asked=pooled is not None).with_known(known)


@dataclass(frozen=True)
class FollowQuestion:
    """Estimation problem of the state after each day; ``state`` holds all days."""

    config: TwinConfig
    model: TwinModel
    state: TwinState
    rotor: RotorDamping
    law: str
    first_wind: float | None = None
    prior: Followed | None = None

    @property
    def wind(self) -> float | None:
        """The wind speed [m/s] that nacelle dashpots are stated at."""
        return self.first_wind if self.prior is None else self.prior.wind_m_s

    @cached_property
    def support(self) -> SupportModel:
        """The model of the supports, made only if all records are evaluated, which most days do not need."""
        evidence = _evidence(self.config, self.model, self.rotor, self.wind, self.state)
        if evidence.relaxations:
            relaxing(self.config, (self.law,))
        return law_model(self.config, evidence, self.law)

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of the parameters, by name."""
        if self.prior is not None:
            return dict(self.prior.units)
        return {p.name: p.unit for p in self.support.parameters}

    @cached_property
    def reference_hz(self) -> float:
        """The first frequency on pinned feet."""
        return self.support.reference_hz if self.prior is None else self.prior.reference_hz

    def agree(self, prior: Followed) -> None:
        """Refuse a prior of another structure, law or set of parameters."""
        model, names = self.support, [p.name for p in self.support.parameters]
        same = abs(prior.reference_hz / model.reference_hz - 1.0) < 1e-6
        if not same or prior.law != self.law or list(prior.units) != names:
            raise InputError(
                "the prior is of another law, structure or set of parameters",
                file=self.config.path,
                field="prior",
                value=f"{prior.law}: {', '.join(prior.units)}; {prior.reference_hz:.6g} Hz on pinned feet",
                allowed=f"{self.law}: {', '.join(names)}; {model.reference_hz:.6g} Hz",
                remedy="follow all records anew, without the prior",
            )

    def followed(self, found: InTime, state: TwinState, *, to_go_on: bool = False) -> Followed:
        """Return the result and its state; with ``to_go_on`` only what the next run continues from."""
        last = None if to_go_on else found.last
        return Followed(
            name=self.config.name,
            law=self.law,
            reference_hz=self.reference_hz,
            wind_m_s=self.wind,
            units=self.units,
            days=found.days,
            drift=None,
            state=state,
            pooled=found.pooled,
            track=found.track.stored(),
            smoothed={} if last is None else found.track.levels(last.reference),
            ahead={} if last is None else found.track.ahead(last.reference),
        )

    def after_days(self, every: Days, same: int, before: TwinState, progress: Progress) -> InTime:
        """Return the estimates after each day; those of the first days may be from an earlier run.

        Parameters
        ----------
        same : number of first days unchanged since the earlier run
        before : sums of these days
        """
        dates = [own for own in every.identities if own != UNDATED]
        prior = self.prior
        found, begun = self._resumed(every, dates[:same])
        known = {} if prior is None else {day.date: day for day in prior.days}
        for date_ in dates[begun:same]:
            found = found.again(date_, known.get(date_), None if prior is None else prior.pooled.get(date_))
        running = before
        for date_ in dates[same:]:
            running = replace(running.with_day(date_, day := every.load(date_)), days={})
            found = self.after_day(found, date_, day, running, progress)
        return found

    def _resumed(self, every: Days, same: Sequence[str]) -> tuple[InTime, int]:
        """Return the estimates of an earlier run to continue from, and the number of days that they cover.

        These are all if its days are unchanged, else those when its window last moved, or none.
        """
        empty, prior = InTime(StiffnessTrack(self.model, every)), self.prior
        if prior is None or prior.track is None:
            return empty, 0
        days = [day for day in prior.days if day.date in set(same)]
        tracked = [day.date for day in days if day.relative is not None]
        kept = prior.track
        if len(days) < len(prior.days):
            if not 0 < kept.settled <= len(tracked):
                return empty, 0
            tracked = tracked[: kept.settled]
            kept = kept.until(tracked[-1])
            days = [day for day in days if day.date <= tracked[-1]]
        track = resumed(self.model, every, kept, tracked, unchanged=True)
        pooled = {date_: one for date_, one in prior.pooled.items() if days and date_ <= days[-1].date}
        return InTime(track, tuple(days), pooled), sum(1 for own in same if days and own <= days[-1].date)

    def after_day(
        self, found: InTime, date_: str, day: Day, running: TwinState, progress: Progress
    ) -> InTime:
        """Return the estimates after one more day; ``running`` holds the sums up to its end."""
        time = day.time_utc
        if time is None or not day.operations or ALL not in running.totals or not running.totals[ALL].modes:
            return found
        progress(f"update after {date_}")
        return self._moment(
            found, date_, running, DayEstimate(date_, time, len(day.records), "", {}, {}), progress
        )

    def _moment(
        self, found: InTime, date_: str, running: TwinState, moment: DayEstimate, progress: Progress
    ) -> InTime:
        number, last = running.totals[ALL].conditions.records, found.last
        due = last is None or number >= GROWN * last.records
        new = self.pooled(running, progress, last) if due else None
        pooled = last if new is None else new
        if pooled is None:
            raise ValueError("nothing is known of all records")
        found = found.with_day(date_, pooled, asked=new is not None)
        known = replace(
            moment, evidence=self._identity(running), median=pooled.median, interval_90=pooled.interval_90,
            status=pooled.status,
        )  # fmt: skip
        level = None if pooled.about is None else found.track.level(pooled.reference)
        return found.with_known(self._on_the_day(known, level))

    def _on_the_day(self, known: DayEstimate, level: StiffnessLevel | None) -> DayEstimate:
        """Return the estimate with the stiffness of the day."""
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

    def after_records(self, moments: Sequence[tuple[Observation, TwinState]], progress: Progress) -> InTime:
        """Return the estimates after each record; the stiffness is that of the day so far."""
        found = InTime(StiffnessTrack(self.model, Days.of(empty_state(self.model))))
        if self.prior is not None:
            found = replace(found, days=self.prior.days, pooled=dict(self.prior.pooled))
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
            known = DayEstimate(time.isoformat(), time, 1, "", {}, {})
            found = self._moment(found, date_, state, known, progress)
        return found

    def pooled(
        self, state: TwinState, progress: Progress = SILENT, before: PooledEstimate | None = None
    ) -> PooledEstimate:
        """Return the estimate from some records together; that of fewer records shortens the sampling."""
        evidence = _evidence(self.config, self.model, self.rotor, self.wind, state)
        highest = max(mode for data, _ in evidence.states.values() for mode in data.modes)
        problem = model_problem(self.config, evidence, self.support.reaching(highest))
        names = [p.name for p in problem.parameters]
        log_theta, status = _draws_after(before, problem, self.config.update.seed), "ok"
        if log_theta is None:
            log_theta, status = _draws(self.config, problem, progress)
        low, median, high = np.exp(np.quantile(log_theta, QUANTILES, axis=0))
        stiff = [i for i, p in enumerate(problem.parameters) if p.unit == STIFFNESS]
        modes = tuple(
            sorted(
                {m for data, _ in evidence.states.values() for m in data.modes} & {*self.config.update.modes}
            )
        )
        about = sensitivity(problem, np.log(median), stiff, modes) if stiff and modes else None
        return PooledEstimate(
            state.totals[ALL].conditions.records,
            dict(zip(names, median.tolist(), strict=True)),
            dict(zip(names, zip(low.tolist(), high.tolist(), strict=True), strict=True)),
            status,
            about,
            Reference.of(log_theta, stiff),
            log_theta.mean(axis=0),
            np.atleast_2d(np.cov(log_theta.T)),
        )

    def _identity(self, state: TwinState) -> str:
        """Return the identity of everything that an estimate depends on."""
        return digest([state.totals, state.clearest, self.wind, self.law])


def _draws_after(before: PooledEstimate | None, problem: Problem, seed: int) -> FloatArray | None:
    """Return draws of ln θ near an earlier estimate; None if it is of other parameters or too far away."""
    if (
        before is None
        or not before.centre.size
        or list(before.median) != [p.name for p in problem.parameters]
    ):
        return None
    rng = np.random.default_rng((seed, before.records))
    return weighted_draws(problem, before.centre, before.covariance, rng)


def _draws(config: TwinConfig, problem: Problem, progress: Progress) -> tuple[FloatArray, str]:
    """Return draws of ln θ and ``"ok"``; without a posterior, draws by Laplace's method and the reason."""
    how = config.update
    posterior, status = posterior_or_status(
        problem, sampler=how.sampler, particles=how.particles, seed=how.seed, progress=progress
    )
    if posterior is not None:
        return posterior.log_theta, status
    found = search(problem, starts=how.starts_for(problem), seed=how.seed, progress=progress)
    return laplace_draws(problem, found.solutions[0].theta, seed=how.seed), status
