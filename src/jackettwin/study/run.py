"""The run of a twin: from records to modes to updated supports."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jackettwin.caveats import Assumption
from jackettwin.errors import InputError
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.progress import SILENT, Progress
from jackettwin.soil import SERIES
from jackettwin.study.fit_data import recorded_modes, residuals, target_modes, updating
from jackettwin.study.law_fits import Posteriors, fit_laws
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
from jackettwin.study.problem import UpdateEvidence
from jackettwin.study.relaxations import measured_relaxations
from jackettwin.study.result import DampingExcess, TwinResult
from jackettwin.study.rotor import mean_wind, operating_states, rotor_damping, rotor_speed_hz
from jackettwin.study.scrutiny import Scrutiny, scrutiny
from jackettwin.twin import TwinConfig, TwinModel, TwinState, suspects, twin_model
from jackettwin.updating import Update, contradicted, recommended

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
    state = None if found is None else updating(config, found.state)
    measured = (
        target_modes(config, model.labels, pinned_hz=model.modes.frequency_hz)
        if found is None or state is None
        else _recorded(config, found, state, model.labels)
    )
    wind, evidence = _evidence(config, model, found, state, measured)
    fits = fit_laws(
        config,
        evidence,
        laws or config.update.laws,
        tuple(m.mode for m in measured),
        posteriors=posteriors,
        progress=progress,
        keep=keep,
    )
    others = suspects(config, model.structure) if any(u.problem.weighted for u in fits.updates) else ()
    seen = () if found is None else found.observations
    checked = tuple(scrutiny(u, measured, others, evidence.pairs, seen) for u in fits.updates)
    updates = tuple(_judged(u, s) for u, s in zip(fits.updates, checked, strict=True))
    speed, blades = rotor_speed_hz(config)
    length = () if fits.series_choice is None else (Assumption(SERIES, fits.series_choice),)
    return TwinResult(
        name=config.name,
        assembly=model.structure,
        sensors=() if found is None else found.sensors,
        numbered=model.modes,
        labels=model.labels,
        observations=seen,
        shown=None if found is None else found.shown,
        measured=measured,
        updates=updates,
        excess=tuple(_excess(measured, u) for u in updates),
        assumptions=(
            *modelling_assumptions(config, measured, evidence.relaxations, wind),
            *length,
            *_of_tolerances(config, updates, checked),
        ),
        warnings=(
            *without_relaxation(fits.left_out),
            *without_fit(fits.unfit),
            *cautions(config, found, measured, updates, model.labels),
        ),
        relaxations=evidence.relaxations,
        rotor_speed_hz=speed,
        rotor_state=None if config.update.rotor is None else config.update.rotor_state,
        wind_m_s=wind,
        blades=blades,
        in_all=None if found is None else found.in_all,
        scrutiny=checked,
    )


def _evidence(
    config: TwinConfig,
    model: TwinModel,
    found: Measured | None,
    state: TwinState | None,
    measured: tuple[MeasuredMode, ...],
) -> tuple[float | None, UpdateEvidence]:
    """Return the mean wind speed [m/s], None if unknown, and the data that every law is fitted to."""
    relaxations = measured_relaxations(config, state)
    wind = mean_wind(config, state)
    states = operating_states(
        config,
        measured,
        state,
        residuals(config, measured, relaxations),
        wind,
        assembly=model.structure,
        numbered=model.modes,
    )
    sensors = () if found is None else found.sensors
    rotor = rotor_damping(config, model.structure, model.modes, wind)
    pairs = measured_directions(state, sensors, model.structure, measured)
    return wind, UpdateEvidence(model.structure, state, states, rotor, relaxations, pairs)


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


def _judged(u: Update, s: Scrutiny) -> Update:
    """Return a fit of which nothing is identified if its data ask for an error beyond the tolerances."""
    asked = () if s.objection is None else s.objection.suspected
    if not asked or u.uncertainty is None:
        return u
    verdicts = contradicted(u.uncertainty.verdicts, " and ".join(t.words for t in asked))
    return replace(u, fit=replace(u.fit, uncertainty=replace(u.uncertainty, verdicts=verdicts)))


def _excess(measured: tuple[MeasuredMode, ...], result: Update) -> tuple[DampingExcess, ...]:
    return tuple(
        DampingExcess(
            m.label,
            m.damping_ratio,
            m.damping_ratio_std,
            float(steel + soil + sum(water)),
            float("nan") if result.open_dashpot(m.label) else float(rotor),
        )
        for m, (steel, soil, rotor, *water) in zip(measured, result.budget.damping_ratio, strict=True)
        if m.damping_ratio is not None and not np.isnan(steel)
    )
