"""The run of a twin: from records to modes to updated supports."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal

import numpy as np

from jackettwin.caveats import Assumption
from jackettwin.errors import InputError
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.progress import SILENT, Progress
from jackettwin.soil import SERIES
from jackettwin.study.fit_cache import fitted, with_kept_posterior
from jackettwin.study.fit_data import recorded_modes, residuals, target_modes, updating
from jackettwin.study.measure import Measured, measure
from jackettwin.study.measurements import MeasuredMode
from jackettwin.study.narrative import (
    cautions,
    modelling_assumptions,
    tolerance_assumptions,
    without_fit,
    without_relaxation,
)
from jackettwin.study.pair_directions import measured_directions
from jackettwin.study.problem import UpdateEvidence, law_problem
from jackettwin.study.relaxations import measured_relaxations, relaxing
from jackettwin.study.result import DampingExcess, TwinResult
from jackettwin.study.rotor import mean_wind, operating_states, rotor_damping, rotor_speed_hz
from jackettwin.study.scrutiny import Scrutiny, scrutiny
from jackettwin.twin import TwinConfig, TwinModel, TwinState, suspects, twin_model
from jackettwin.updating import Update, contradicted, likely, recommended, series

Posteriors = Literal["all", "likely", "none"]
log = logging.getLogger(__name__)
_MOST_REASONS = 20
"""Largest number of lines with reasons that no identified mode is a mode of the model."""


def run_twin(
    config: TwinConfig,
    *,
    laws: tuple[str, ...] | None = None,
    compare: bool = False,
    posteriors: Posteriors = "all",
    workers: int = 1,
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> TwinResult:
    """Identify the records of a twin (or take its targets) and update its supports under each law.

    Parameters
    ----------
    laws : tuple of str, optional
        Replaces those of the twin file.
    compare : bool
        Identify the first record by every method, for comparison.
    posteriors : {"all", "likely", "none"}
        Laws whose posterior is sampled: all, the recommended one, or none; all laws are fitted.
    workers : int
        Number of processes that identify records.
    progress : Progress
        Receives a message at each step; ``count_steps`` gives their number.
    keep : Keep
        Stores identified records and fits for the next run.

    Raises
    ------
    InputError
        If records, sensors or targets do not fit the structure, or no support can produce the targets.
    """
    config.require_records()
    progress("assemble the structure")
    model = twin_model(config)
    found = (
        measure(config, model, compare=compare, workers=workers, progress=progress, keep=keep)
        if config.records
        else None
    )
    return updated_twin(config, model, found, laws=laws, posteriors=posteriors, progress=progress, keep=keep)


def updated_twin(
    config: TwinConfig,
    model: TwinModel,
    found: Measured | None,
    *,
    laws: tuple[str, ...] | None = None,
    posteriors: Posteriors = "all",
    progress: Progress = SILENT,
    keep: Keep = NOT_KEPT,
) -> TwinResult:
    """Return a twin updated to its records, or to its targets if there are no records.

    Raises
    ------
    InputError
        If the measured modes do not fit the structure, or no support can produce them.
    """
    assembly, numbered, labels = model.structure, model.modes, model.labels
    state = None if found is None else updating(config, found.state)
    measured = (
        target_modes(config, labels, pinned_hz=numbered.frequency_hz)
        if found is None or state is None
        else _recorded(config, found, state, labels)
    )
    relaxations = measured_relaxations(config, state)
    wind = mean_wind(config, state)
    states = operating_states(
        config,
        measured,
        state,
        residuals(config, measured, relaxations),
        wind,
        assembly=assembly,
        numbered=numbered,
    )
    sensors = () if found is None else found.sensors
    pairs = measured_directions(state, sensors, assembly, measured)
    evidence = UpdateEvidence(
        assembly, state, states, rotor_damping(config, assembly, numbered, wind), relaxations, pairs
    )
    wanted = laws or config.update.laws
    shown, updates, lengths = tuple(m.mode for m in measured), [], []

    def fit(law: str, *, sampled: bool = posteriors == "all") -> Update:
        problem = law_problem(config, evidence, law)
        with _said_where(config):
            return fitted(problem, shown, config.update, sampled=sampled, progress=progress, keep=keep)

    unfit = dict[str, InputError]()
    for law in relaxing(config, wanted) if relaxations else wanted:
        progress(f"update {law}")
        try:
            if law == SERIES:
                chosen, why = series(lambda name: fit(name, sampled=False), progress)
                lengths.append(Assumption(SERIES, why))
                wanted = tuple(chosen.law if name == SERIES else name for name in wanted)
                updates.append(fit(chosen.law))
            else:
                updates.append(fit(law))
        except InputError as error:  # other laws may still explain the data
            unfit[law] = error
    if not updates:
        raise next(iter(unfit.values()))
    # a series may end with a law that is also listed
    updates = list({u.law: u for u in updates}.values())
    if posteriors == "likely":
        updates = _with_one_posterior(config, updates, progress, keep)
    speed, blades = rotor_speed_hz(config)
    others = suspects(config, assembly) if any(u.problem.weighted for u in updates) else ()
    seen = () if found is None else found.observations
    checked = tuple(scrutiny(u, measured, others, pairs, seen) for u in updates)
    updates = [_judged(u, s) for u, s in zip(updates, checked, strict=True)]
    left_out = tuple(law for law in wanted if law not in {*unfit, *(u.law for u in updates)})
    return TwinResult(
        name=config.name,
        assembly=assembly,
        sensors=sensors,
        numbered=numbered,
        labels=labels,
        observations=seen,
        shown=None if found is None else found.shown,
        measured=measured,
        updates=tuple(updates),
        excess=tuple(_excess(measured, result) for result in updates),
        assumptions=(
            *modelling_assumptions(config, measured, relaxations, wind),
            *lengths,
            *_of_tolerances(config, updates, checked),
        ),
        warnings=(
            *without_relaxation(left_out),
            *without_fit(unfit),
            *cautions(config, found, measured, tuple(updates), labels),
        ),
        relaxations=relaxations,
        rotor_speed_hz=speed,
        rotor_state=None if config.update.rotor is None else config.update.rotor_state,
        wind_m_s=wind,
        blades=blades,
        in_all=None if found is None else found.in_all,
        scrutiny=checked,
    )


def _of_tolerances(
    config: TwinConfig, updates: Sequence[Update], checked: Sequence[Scrutiny]
) -> tuple[Assumption, ...]:
    """Return the tolerances of a twin, with what they move under the law that is recommended."""
    u = recommended(updates)
    s = next((s for one, s in zip(updates, checked, strict=True) if one is u), None)
    names = () if u is None else tuple(p.name for p in u.problem.parameters)
    return tolerance_assumptions(config, s, names)


def _recorded(
    config: TwinConfig, found: Measured, state: TwinState, labels: tuple[str, ...]
) -> tuple[MeasuredMode, ...]:
    """Return the modes of the records; if none is in the model, log the identified modes."""
    try:
        return recorded_modes(config, state, labels, found.clearest)
    except InputError:
        for line in cautions(config, found, (), (), labels)[:_MOST_REASONS]:
            log.warning(line)
        if any(one.identification.modes for one in found.observations):
            raise
        raise InputError(
            "no mode was identified in any record",
            file=config.path,
            field="records",
            value=[path.name for path in config.records],
            remedy="look at their spectra (`jackettwin identify RECORD --report PAGE`); check that the "
            "sensors are connected and resolve the motion, and measure in more wind or for longer",
        ) from None


def count_steps(config: TwinConfig, laws: tuple[str, ...] | None = None) -> int:
    """Return the number of steps that ``run_twin`` reports."""
    return 1 + len(config.records) + len(laws or config.update.laws)


@contextmanager
def _said_where(config: TwinConfig) -> Iterator[None]:
    """Add the place in the twin file to errors about data that no support can produce."""
    try:
        yield
    except InputError as error:
        source = "records" if config.records else "targets"
        raise error.at(file=config.path, field=None if error.field else source) from None


def _judged(u: Update, s: Scrutiny) -> Update:
    """Return a fit of which nothing is identified if its data ask for an error beyond the tolerances."""
    asked = () if s.objection is None else s.objection.suspected
    if not asked or u.uncertainty is None:
        return u
    verdicts = contradicted(u.uncertainty.verdicts, " and ".join(t.words for t in asked))
    return replace(u, fit=replace(u.fit, uncertainty=replace(u.uncertainty, verdicts=verdicts)))


def _with_one_posterior(
    config: TwinConfig, updates: list[Update], progress: Progress, keep: Keep
) -> list[Update]:
    """Return the updates, the most probable one with its posterior."""
    chosen = likely(updates)
    return [
        with_kept_posterior(u, config.update, progress=progress, keep=keep) if u is chosen else u
        for u in updates
    ]


def _excess(measured: tuple[MeasuredMode, ...], result: Update) -> tuple[DampingExcess, ...]:
    return tuple(
        DampingExcess(
            m.label, m.damping_ratio, m.damping_ratio_std, float(steel + soil + sum(water)), float(rotor)
        )
        for m, (steel, soil, rotor, *water) in zip(measured, result.budget.damping_ratio, strict=True)
        if m.damping_ratio is not None and not np.isnan(steel)
    )
