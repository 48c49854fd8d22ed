"""Day after day: what the records so far say of the supports, and whether their stiffness drifts.

Records are fused in the data, where they are independent of each other; errors of the model are not, and
enter once. The posterior after a day is that of the prior and of all records so far: what taking each day's
posterior as the next day's prior comes to, without the loss of handing draws on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import UTC
from functools import partial
from itertools import groupby
from typing import Literal

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.response.labels import mode_kinds, mode_labels
from jackettwin.structure import Assembly
from jackettwin.twin.assembled import assembled
from jackettwin.twin.config import PAIRED_MODES, TwinConfig
from jackettwin.twin.fitted import recorded_modes, residuals
from jackettwin.twin.followed import FEWEST_DAYS, STIFFNESS, Day, Followed, RecordModes, since_first
from jackettwin.twin.measure import Measured, measure
from jackettwin.twin.model import placed_sensors
from jackettwin.twin.problem import Evidence, law_model, model_problem, tied_problem
from jackettwin.twin.relaxations import measured_relaxations, relaxing
from jackettwin.twin.rotor import RotorDamping, States, mean_wind, operating_states, rotor_damping
from jackettwin.updating import Problem, SupportModel, numbered_modes
from jackettwin.updating.drift import Drift, find_drift
from jackettwin.updating.joint import Growth
from jackettwin.updating.posterior import sample_posterior

FloatArray = npt.NDArray[np.float64]

Each = Literal["day", "record"]

_WHOLE_SPAN = 2.0
"""Prior standard deviation of the logarithm by which stiffness drifts over the whole time."""


def follow_twin(
    config: TwinConfig,
    *,
    law: str | None = None,
    each: Each = "day",
    prior: Followed | None = None,
    step: Callable[[str], None] = lambda _: None,
) -> Followed:
    """Return what is known after each day of a twin's records.

    Parameters
    ----------
    law : str, optional
        Instead of the twin file's first, or the prior's.
    each : {"day", "record"}
        Whether the records of a UTC day count together, or each on its own.
    prior : Followed, optional
        To go on from; records that are in it already are left out.
    step : callable
        Told what is being done: once a record, then once a day.

    Raises
    ------
    InputError
        If there is no new record, a record has no start time or precedes the prior, or the twin has changed.
    NumericalError
        If a posterior does not converge.
    """
    known = {record.name for day in prior.days for record in day.records} if prior is not None else set()
    new = replace(config, records=tuple(path for path in config.records if path.stem not in known))
    if not new.records:
        raise InputError("no new records to follow", file=config.path, field="records", value=[])
    assembly = assembled(config)
    found = measure(new, assembly, step=step)
    warnings = [f"left out: {one.problem}" for one in found.failed]
    warnings += [f"{o.record.name}: {w}" for o in found.observations for w in o.identification.warnings]
    followed = follow_modes(
        config, assembly, _record_modes(new, found), law=law, each=each, prior=prior, step=step
    )
    return replace(followed, warnings=tuple(warnings))


def follow_modes(
    config: TwinConfig,
    assembly: Assembly,
    records: Sequence[RecordModes],
    *,
    law: str | None = None,
    each: Each = "day",
    prior: Followed | None = None,
    step: Callable[[str], None] = lambda _: None,
) -> Followed:
    """Return what is known after each day, from the modes that records show; see :func:`follow_twin`."""
    past = () if prior is None else prior.days
    batches = _batches(config, sorted(records, key=lambda r: r.time_utc), each, past)
    known = [record for day in past for record in day.records]
    everything = [*known, *(record for batch in batches for record in batch)]
    numbered = numbered_modes(assembly, PAIRED_MODES)
    labels = mode_labels(mode_kinds(assembly, numbered.shapes))
    wind = mean_wind(config, _measured(everything)) if prior is None else prior.wind_m_s
    law = law or (config.update.laws[0] if prior is None else prior.law)
    rotor = rotor_damping(config, assembly, numbered, wind)
    evidence = partial(_evidence, config, assembly, rotor, labels, wind)
    at_last = evidence(everything)
    if at_last.relaxations:
        relaxing(config, (law,))
    model = law_model(config, at_last, law)
    parameters = model_problem(config, at_last, model).parameters
    if prior is not None:
        _agree(config, prior, law, model, [p.name for p in parameters])
    days = past
    for batch in batches:
        step(f"update after {batch[-1].name}")
        known = [*known, *batch]
        now = evidence(known)
        reaching = model.reaching(max(m for r, _ in now.states.values() for m in r.modes))
        days = (*days, _known_after(config, batch, model_problem(config, now, reaching)))
    return Followed(
        name=config.name,
        law=law,
        reference_hz=model.reference_hz,
        wind_m_s=wind,
        units={p.name: p.unit for p in parameters},
        days=days,
        drift=_drift(config, model, days, labels, wind),
        warnings=(),
    )


def _record_modes(config: TwinConfig, found: Measured) -> list[RecordModes]:
    """Return the modes of every record."""
    records = []
    for i, seen in enumerate(found.observations):
        start = seen.record.start_utc
        if start is None:
            raise InputError(
                "a record without a start cannot be followed in time",
                file=config.path,
                field="records",
                value=seen.record.name,
                remedy="give start_utc in the record's description",
            )
        records.append(
            RecordModes(
                seen.record.name,
                start,
                found.of_record(i),
                placed_sensors(config.sensors, seen.record),
                found.relaxations[i],
            )
        )
    return records


def _batches(
    config: TwinConfig, records: list[RecordModes], each: Each, past: tuple[Day, ...]
) -> list[tuple[RecordModes, ...]]:
    """Return the new records of each day."""
    if past and records[0].time_utc < past[-1].time_utc:
        raise InputError(
            "a record precedes the last day of the prior",
            file=config.path,
            field="records",
            value=records[0].name,
            allowed=f"starts from {past[-1].time_utc.isoformat()} on",
            remedy="follow all records anew, without the prior",
        )
    if each == "record":
        return [(record,) for record in records]
    return [tuple(day) for _, day in groupby(records, key=lambda r: r.time_utc.astimezone(UTC).date())]


def _states(
    config: TwinConfig, records: Sequence[RecordModes], labels: tuple[str, ...], wind: float | None
) -> States:
    """Return the data of some records by operating state."""
    found = _measured(records)
    measured = recorded_modes(config, found, labels)
    fitted = residuals(config, measured)
    if fitted.relative:
        raise InputError(
            "following needs a standard deviation of every measured value",
            file=config.path,
            field="update.weighting",
            value=config.update.weighting,
            allowed="auto or covariance",
        )
    return operating_states(config, measured, found, fitted, wind)


def _measured(records: Sequence[RecordModes]) -> Measured:
    modes = sorted({mode for record in records for mode in record.sightings})
    sightings = {m: tuple(r.sightings[m] for r in records if m in r.sightings) for m in modes}
    sensors = {sensor.channel: sensor for record in reversed(records) for sensor in record.sensors}
    relaxations = tuple(record.relaxations for record in records)
    return Measured((), tuple(sensors.values()), sightings, (), relaxations)


def _evidence(
    config: TwinConfig,
    assembly: Assembly,
    rotor: RotorDamping,
    labels: tuple[str, ...],
    wind: float | None,
    records: Sequence[RecordModes],
) -> Evidence:
    """Return what some records say, as a law is fitted to it."""
    found = _measured(records)
    relaxations = measured_relaxations(config, found)
    states = _states(config, records, labels, wind)
    return Evidence(assembly, found, states, rotor, relaxations)


def _known_after(config: TwinConfig, batch: tuple[RecordModes, ...], problem: Problem) -> Day:
    posterior = sample_posterior(problem, particles=config.update.particles, seed=config.update.seed)
    names = [p.name for p in problem.parameters]
    median = np.exp(np.median(posterior.log_theta, axis=0))
    interval = {n: (float(a), float(b)) for n, (a, b) in zip(names, posterior.interval(), strict=True)}
    return Day(batch, dict(zip(names, median.tolist(), strict=True)), interval)


def _drift(
    config: TwinConfig,
    model: SupportModel,
    days: tuple[Day, ...],
    labels: tuple[str, ...],
    wind: float | None,
) -> Drift | None:
    """Return the slope of all stiffness through the days' frequencies and damping, each by itself."""
    if len(days) < FEWEST_DAYS:
        return None
    exact = replace(config, update=replace(config.update, model_errors=()))
    at = since_first(days)
    states: States = {}
    times: dict[str, float] = {}
    for i, (day, t) in enumerate(zip(days, at, strict=True)):
        for name, (data, factors) in _states(exact, day.records, labels, wind).items():
            states[f"{i}: {name}"] = (data, factors or _usual(config, day, wind))
            times[f"{i}: {name}"] = float(t)
    growing = tuple(p.name for p in model.parameters if p.unit == STIFFNESS)
    growth = Growth(growing, times, _WHOLE_SPAN / float(at[-1]))
    errors = _model_errors(config, labels)
    problem = tied_problem(config, model, states, errors=errors, growth=growth)
    start = [days[-1].median.get(p.name, 1.0) for p in problem.parameters[:-1]]
    return find_drift(problem, np.log(start))


def _usual(config: TwinConfig, day: Day, wind: float | None) -> dict[str, float]:
    """Return the dashpots' factors in a day's mean wind."""
    winds = [s.wind_m_s for record in day.records for s in record.sightings.values()]
    known = [v for v in winds if v is not None]
    if wind is None or not known or len(known) < len(winds):
        return {}
    return {name: float(np.mean(known)) / wind for name in config.update.dashpots}


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


def _agree(config: TwinConfig, prior: Followed, law: str, model: SupportModel, names: list[str]) -> None:
    """Refuse a prior of another structure, law or set of parameters."""
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
