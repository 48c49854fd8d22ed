"""Interface to the engine, with documents as inputs and outputs.

Modules below it do not use the store, modules above it do not use models.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from jackettwin.errors import require
from jackettwin.files import StoredSchema, atomic_path, digest
from jackettwin.findings import Finding
from jackettwin.identification import Pick
from jackettwin.records import Channel, FileDefaults
from jackettwin.store import read_waveform
from jackettwin.structure import Structure
from jackettwin.twin import (
    ALL,
    OBSERVATION,
    Day,
    Observation,
    TwinConfig,
    TwinModel,
    TwinState,
    advance,
    average,
    observe,
    read_twin,
    twin_model,
)
from jackettwin.version import __version__

TWIN_FILE = "twin.yaml"
DAY = StoredSchema("twin_day", Day)
"""Format of the stored state of a day."""


@dataclass(frozen=True)
class FoldedDay:
    """The state of a day as a document, its number of records, and the findings on each new one."""

    document: str
    n_records: int
    findings: tuple[tuple[dict[str, Any], ...], ...]


class Twin(NamedTuple):
    """Configuration of a version of a twin, and its model."""

    config: TwinConfig
    model: TwinModel


@lru_cache(maxsize=256)
def load_twin(folder: Path) -> Twin:
    """Return the twin in a folder, cached since a version never changes."""
    config = read_twin(folder / TWIN_FILE, records_follow=True)
    return Twin(config, twin_model(config))


@dataclass(frozen=True)
class TwinProfile:
    """Data of a version of a twin that a server needs without building the model.

    Attributes
    ----------
    identity : hash of model and settings, which identifies a version's observations
    settings_hash : of the settings of its observations
    model_hash, by_wind, with_shapes : of the states of its observations
    labels : of its modes
    channels : {name: channel}, as stated in the twin file
    defaults : properties of files that do not state them
    """

    identity: str
    settings_hash: str
    model_hash: str
    by_wind: bool
    with_shapes: bool
    labels: tuple[str, ...]
    channels: dict[str, Channel]
    defaults: FileDefaults


PROFILE = StoredSchema("twin_profile", TwinProfile)
"""Format of profiles, as sent by workers and stored with the files of a version."""


def profile_of(twin: Twin) -> TwinProfile:
    """Return the profile of a twin."""
    model = twin.model
    settings = model.settings_hash("")
    named = {
        s.channel: Channel(s.channel, height_m=s.height_m, node=s.node, direction=s.direction)
        for s in twin.config.sensors
    }
    keeps = (model.by_wind, model.with_shapes, tuple(model.labels))
    identity = digest([model.model_hash, settings])
    return TwinProfile(identity, settings, model.model_hash, *keeps, named, twin.config.defaults)


def examine(folder: Path, most_freedoms: int) -> TwinProfile:
    """Evaluate a twin that a client sent.

    Raises
    ------
    InputError
        If it cannot be read, or has too many degrees of freedom.
    """
    config = read_twin(folder / TWIN_FILE, records_follow=True)
    check_freedoms(config.structure, config.subdivide, most_freedoms)
    return profile_of(Twin(config, twin_model(config)))


def check_freedoms(structure: Structure, subdivide: int | None, most_freedoms: int) -> None:
    """Raise an error on a structure that would have too many degrees of freedom.

    Raises
    ------
    InputError
    """
    usual = subdivide or structure.subdivide
    inner = sum((bar.elements or usual) - 1 for bar in structure.bars)
    freedoms = 6 * (len(structure.nodes) + inner)
    require(
        freedoms <= most_freedoms,
        "the structure has too many degrees of freedom",
        field="subdivide",
        value=freedoms,
        allowed=f"up to {most_freedoms} freedoms",
        remedy="divide members less finely, or set JACKETTWIN_SERVE_FREEDOMS_LIMIT",
    )


def profile_path(folder: Path) -> Path:
    """Return the path of a version's profile, for this version of the program."""
    return folder.with_name(f"{folder.name}-{__version__}.json")


def keep_profile(folder: Path, profile: TwinProfile) -> None:
    """Store a profile with the files of its version."""
    with atomic_path(profile_path(folder)) as temporary:
        temporary.write_text(json.dumps(PROFILE.dump(profile)), encoding="utf-8")


def read_profile(path: Path) -> TwinProfile:
    """Return a stored profile."""
    return PROFILE.load(json.loads(path.read_text(encoding="utf-8")))


def _empty(model: TwinModel | TwinProfile) -> TwinState:
    return TwinState(model.model_hash, model.by_wind, model.with_shapes)


class ObservationRows(NamedTuple):
    """An observation as the store keeps it: the document, its modes and its findings as rows.

    ``problem`` is the reason of exclusion, if the record is of another structure.
    """

    document: str
    modes: tuple[dict[str, Any], ...]
    findings: tuple[dict[str, Any], ...]
    problem: dict[str, Any] | None


def observed(
    model: TwinModel, waveform: Path, conditions: Mapping[str, Any], picks: Sequence[Mapping[str, Any]] = ()
) -> ObservationRows:
    """Return the observation of a stored record.

    ``picks`` are manually selected poles, which replace the automatic selection.
    """
    if picks:
        model = model.with_picks(tuple(Pick(float(p["frequency_hz"]), p.get("order")) for p in picks))
    record = read_waveform(waveform)
    record = replace(record, conditions={**conditions, **record.conditions})
    return observation_rows(observe(record, model))


def observation_rows(seen: Observation) -> ObservationRows:
    """Return an observation as the store keeps it."""
    rows = []
    for mode, known in zip(seen.identification.modes, seen.recognised, strict=True):
        low, high = mode.damping_ratio_interval_90 or (None, None)
        rows.append(
            {
                "label": "" if known is None else known.label,
                "frequency_hz": mode.frequency_hz,
                "frequency_std_hz": mode.frequency_std_hz,
                "damping_ratio": mode.damping_ratio,
                "damping_ratio_std": mode.damping_ratio_std,
                "damping_ratio_low_90": low,
                "damping_ratio_high_90": high,
                "status": str(mode.status)[:255],
            }
        )
    document = json.dumps(OBSERVATION.dump(seen), ensure_ascii=False, separators=(",", ":"))
    said = tuple(finding_row(f) for f in seen.findings)
    return ObservationRows(document, tuple(rows), said, _MISMATCHED if seen.mismatched else None)


def said_of_modes(document: str) -> dict[float, str | None]:
    """Return why each mode of an observation is not simply one, by its frequency [Hz]."""
    found = OBSERVATION.load(json.loads(document)).identification.modes
    return {mode.frequency_hz: mode.status_reason for mode in found}


_MISMATCHED = {
    "detail": "none of its modes is one of this twin's; the record is not used",
    "field": "record",
    "remedy": "check whether it is of another turbine, and the positions of the sensors in the twin",
}


def advance_day(
    model: TwinModel | TwinProfile, day: str, stored: str | None, observations: Sequence[str]
) -> FoldedDay:
    """Return the state of a day with some more observations."""
    days = {} if stored is None else {day: DAY.load(json.loads(stored))}
    state = replace(_empty(model), days=days)
    found = []
    for document in observations:
        state, findings = advance(state, OBSERVATION.load(json.loads(document)))
        found.append(tuple(finding_row(f) for f in findings if f.code != "record_late"))
    known = state.days.get(day, Day())
    text = json.dumps(DAY.dump(known), ensure_ascii=False, sort_keys=True, separators=(",", ":"))
    return FoldedDay(text, len(known.records), tuple(found))


def finding_row(finding: Finding) -> dict[str, Any]:
    """Return a finding as it is stored."""
    row = finding.document
    del row["repaired"]  # stored findings do not contain it
    return row


@dataclass(frozen=True)
class Sums:
    """Sums over some days, of a size that does not depend on their number."""

    state: TwinState
    records: int = 0
    first_utc: datetime | None = None
    last_utc: datetime | None = None


def no_days(model: TwinModel | TwinProfile) -> Sums:
    """Return the sums over no days."""
    return Sums(_empty(model))


def with_day(
    sums: Sums, day: str, document: str, chosen: Callable[[str], bool] = lambda operation: True
) -> Sums:
    """Return the sums with one more day, of its records in some states of operation."""
    new = DAY.load(json.loads(document)).of_operations(chosen)
    state = replace(sums.state.with_day(day, new), days={})
    times = [t for t in (sums.first_utc, sums.last_utc, new.first, new.last) if t is not None]
    first, last = (min(times), max(times)) if times else (None, None)
    return Sums(state, sums.records + len(new.records), first, last)


@dataclass(frozen=True)
class Past:
    """Stored sums over all days but the last, which still grows.

    ``through`` is the last summed day, ``of`` the identity of these days.
    """

    sums: Sums
    through: str
    of: str


PAST = StoredSchema("twin_past", Past)
"""Format of stored sums of past days."""


def days_unsummed(past: Mapping[str, Any] | None, identities: Mapping[str, str]) -> str | None:
    """Return the last day of stored sums; None if these are outdated."""
    if past is None or past["through"] >= max(identities, default=""):
        return None
    return past["through"] if past["of"] == _identity(identities, past["through"]) else None


def kept_through(so_far: Mapping[str, Any], through: str, identities: Mapping[str, str]) -> dict[str, Any]:
    """Return what is kept of the days through one, so that :func:`days_unsummed` tells whether it holds."""
    return {"so_far": so_far, "through": through, "of": _identity(identities, through)}


def _identity(identities: Mapping[str, str], through: str) -> str:
    return digest([item for item in identities.items() if item[0] <= through])


def summed(
    twin: Twin, past: Mapping[str, Any] | None, identities: Mapping[str, str], documents: Mapping[str, str]
) -> tuple[Sums, Mapping[str, Any] | None]:
    """Return the sums over all days of records that may update the supports, and those to store.

    ``documents`` are those of the days that are not in ``past``, or of all days without it.
    """
    known = None if past is None else PAST.load(past)
    sums, through = (no_days(twin.model), "") if known is None else (known.sums, known.through)
    *before, last = [day for day in identities if day > through]
    for day in before:
        sums = with_day(sums, day, documents[day], twin.config.operation.may_update)
    if before:
        past = PAST.dump(Past(sums, before[-1], _identity(identities, before[-1])))
    return with_day(sums, last, documents[last], twin.config.operation.may_update), past


def knowledge(model: TwinModel | TwinProfile, sums: Sums) -> dict[str, Any]:
    """Return the means of every mode over some days with standard deviations, and the period."""
    total = sums.state.totals.get(ALL)
    modes = []
    for number, seen in sorted(total.modes.items()) if total is not None else ():
        mean = average(seen)
        modes.append(
            {
                "mode": number,
                "label": model.labels[number - 1] if number <= len(model.labels) else "",
                "frequency_hz": mean.frequency_hz,
                "frequency_std_hz": mean.frequency_hz * mean.log_std[0],
                "damping_ratio": mean.damping_ratio,
                "damping_ratio_std": mean.damping_ratio * mean.log_std[1],
                "records": seen.sums.n,
            }
        )
    return {
        "records": sums.records,
        "first_utc": sums.first_utc,
        "last_utc": sums.last_utc,
        "modes": modes,
        "parameters": {},
        "status": "ok" if modes else "no mode of the model has been measured",
    }


def stabilisation(folder: str, waveform: str) -> dict[str, Any]:
    """Return the poles of every model order of a stored record."""
    from jackettwin.twin import examined

    record = read_waveform(Path(waveform))
    poles = examined(record, load_twin(Path(folder)).model).identification.stabilisation
    return {
        "order": poles.order.tolist(),
        "frequency_hz": poles.frequency_hz.tolist(),
        "damping_ratio": poles.damping_ratio.tolist(),
        "stable": poles.stable.tolist(),
        "mode": poles.cluster.tolist(),
        "mpc": poles.mpc.tolist(),
    }
