"""First function of the pair: an observation from a record and a model, without state."""

from __future__ import annotations

from dataclasses import dataclass

from jackettwin.errors import JackettwinError
from jackettwin.files import NOT_KEPT, Keep
from jackettwin.findings import Finding
from jackettwin.identification import Examination, examine
from jackettwin.records import Channel, Record, record_id
from jackettwin.sensing import Weather, readings_of
from jackettwin.twin.calibration import calibrated, sensors_at, uncalibrated
from jackettwin.twin.life.likely_structures import likely_structures
from jackettwin.twin.life.sensed_damage import SensedDamage, sensed_damage
from jackettwin.twin.mode_doubts import sea_share, unlike_model
from jackettwin.twin.model import TwinModel
from jackettwin.twin.observation import Observation, Recognised
from jackettwin.twin.operation import AT_WORK, UNKNOWN
from jackettwin.twin.sensor_polarity import sensor_polarity
from jackettwin.updating import STIFFEST_N_M, Counterpart, Feet, counterparts, pair
from jackettwin.version import __version__

TRUTH = ("true_modes", "true_support", "model")
"""Metadata keys of records of a known structure."""


def observe(record: Record, model: TwinModel) -> Observation:
    """Return the observation of a record: its quality, and its modes with their labels in the model.

    Raises
    ------
    InputError
        If no channel carries a signal, the record cannot be identified, or a sensor's position is not on the
        structure.
    """
    return observed(record, examined(record, model), model)


def examined(
    record: Record, model: TwinModel, *, compare: bool = False, keep: Keep = NOT_KEPT
) -> Examination:
    """Return the examination of a record with a model's settings, which figures need.

    Raises
    ------
    InputError
        If a channel has no signal, or the record cannot be identified.
    """
    sensors = sensors_at(model.sensors, model.calibrations, record.start_utc)
    return examine(
        calibrated(record, model.calibrations),
        model.identification,
        places=[Channel(s.channel, node=s.node, height_m=s.height_m, direction=s.direction) for s in sensors],
        picks=model.picks,
        compare=compare,
        keep=keep,
    )


def observed(record: Record, seen: Examination, model: TwinModel) -> Observation:
    """Return the observation of an examined record.

    Parameters
    ----------
    record : Record
        As read; its samples define its identity.
    seen : Examination
        Result of :func:`examined`.

    Raises
    ------
    InputError
        If a sensor sits where the structure has no place.
    """
    found = seen.identification
    feet = model.most_likely_feet(seen)
    known = _known(seen, model, feet)
    damage, defaults = _damage(seen, model, known, feet)
    if model.identification.refine and known.held and feet is not None:
        sea = sea_share(found.modes, model.structure, model.sees(seen), feet)
        found = unlike_model(found, known.held, sea)
    return Observation(
        record_id=record_id(record),
        model_hash=model.model_hash,
        settings_hash=model.settings_hash(record.name),
        code_version=__version__,
        name=record.name,
        start_utc=record.start_utc,
        conditions=model.operation.with_state(seen.record.conditions),
        quality=seen.quality.summary(),
        identification=found.without_figures,
        recognised=known.recognised,
        held=known.held,
        sensors=model.placed(seen.record),
        findings=(
            *seen.quality.findings,
            *found.findings,
            *known.findings,
            *uncalibrated(model.calibrations, record.start_utc),
            *_unsaid(model, seen.record),
            *defaults,
        ),
        damage=damage,
        truth={key: value for key, value in record.metadata.items() if key in TRUTH},
    )


def _unsaid(model: TwinModel, record: Record) -> tuple[Finding, ...]:
    """Return findings on missing conditions if these leave the state of operation unknown."""
    missing = model.operation.missing(record.conditions)
    if not missing or model.operation.with_state(record.conditions)["state"] != UNKNOWN:
        return ()
    return (Finding("operation_unknown", params={"missing": ", ".join(missing)}),)


def _damage(
    seen: Examination, model: TwinModel, known: _Known, feet: Feet | None
) -> tuple[SensedDamage | None, tuple[Finding, ...]]:
    """Return the damage of a record at the welds, or why there is none."""
    if model.stress is None or feet is None or not any(known.recognised):
        return None, ()
    modes = {
        of.mode: mode
        for mode, of in zip(seen.identification.modes, known.recognised, strict=True)
        if of is not None and mode.status.is_a_mode
    }
    record = seen.record
    conditions = model.operation.with_state(record.conditions)
    works = conditions.get("state") == AT_WORK
    stress = model.stress.working() if works else model.stress
    try:
        stiffness = min(feet.stiffness_n_m, STIFFEST_N_M)
        likely = likely_structures(stress, modes, stiffness, sensors=model.sees(seen))
        readings = readings_of(record, model.placed(record), model.structure)
        weather = Weather.of(conditions, stress.depth_m, stress.coefficients, stress.rotor)
        return sensed_damage(likely, readings, weather), ()
    except JackettwinError as error:
        return None, (Finding("life_unknown", params={"reason": str(error)}),)


@dataclass(frozen=True)
class _Known:
    """Recognised modes of an identification, and findings on them."""

    recognised: tuple[Recognised | None, ...]
    held: tuple[Counterpart, ...]
    findings: tuple[Finding, ...]


def _known(seen: Examination, model: TwinModel, feet: Feet | None) -> _Known:
    """Return the recognised modes, compared on the most similar feet."""
    modes = seen.identification.modes
    if model.numbered is None or feet is None:
        return _Known((None,) * len(modes), (), ())
    names = [channel.name for channel in seen.identification.channels]
    shapes = model.sees(seen) @ feet.shapes
    which = {
        index: Recognised(mode + 1, model.labels[mode], subspace_mac)
        for mode, (index, subspace_mac) in pair(modes, feet.frequency_hz, shapes).items()
    }
    against = [
        Finding(
            "sensor_against_model",
            " or ".join(names[i] for i in one.rows),
            {"before": one.before, "after": one.after},
        )
        for one in sensor_polarity(modes, feet.frequency_hz, shapes)
    ]
    if not which:
        against.append(Finding("no_mode_of_the_model", params={"modes": len(modes)}))
    held = counterparts(modes, feet.frequency_hz, shapes)
    return _Known(tuple(which.get(i) for i in range(len(modes))), held, tuple(against))
