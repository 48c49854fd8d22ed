"""The seam to the engine: documents in, documents out.

Nothing below it knows of a store, nothing above it of a model.
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
from jackettwin.records import Channel, Unsaid
from jackettwin.store import read_waveform
from jackettwin.twin import (
    ALL,
    OBSERVATION,
    Day,
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
"""How the state of one day is kept."""


@dataclass(frozen=True)
class FoldedDay:
    """The state of a day as a document, how many records it holds, and what each new one gave rise to."""

    document: str
    n_records: int
    findings: tuple[tuple[dict[str, Any], ...], ...]


class Twin(NamedTuple):
    """What a version of a twin says, and the model that it builds."""

    config: TwinConfig
    model: TwinModel


@lru_cache(maxsize=256)
def load_twin(folder: Path) -> Twin:
    """Return a twin whose files stand in a folder, kept: a version never changes."""
    config = read_twin(folder / TWIN_FILE, records_follow=True)
    return Twin(config, twin_model(config))


@dataclass(frozen=True)
class TwinProfile:
    """What a server must know of a version of a twin, so that it need not build the model.

    Attributes
    ----------
    identity : hash of model and settings, by which a version's observations are known
    settings_hash : of the settings it observes with
    model_hash, by_wind, with_shapes : of the states that its observations become
    labels : of its modes
    channels : {name: channel}, as far as the twin file says
    unsaid : what holds for a file that does not say so
    """

    identity: str
    settings_hash: str
    model_hash: str
    by_wind: bool
    with_shapes: bool
    labels: tuple[str, ...]
    channels: dict[str, Channel]
    unsaid: Unsaid


PROFILE = StoredSchema("twin_profile", TwinProfile)
"""How a profile is sent by a worker, and stands beside the files of its version."""


def profile_of(twin: Twin) -> TwinProfile:
    """Return what a server must know of a twin."""
    model = twin.model
    settings = model.settings_hash("")
    named = {
        s.channel: Channel(s.channel, height_m=s.height_m, node=s.node, direction=s.direction)
        for s in twin.config.sensors
    }
    keeps = (model.by_wind, model.with_shapes, tuple(model.labels))
    identity = digest([model.model_hash, settings])
    return TwinProfile(identity, settings, model.model_hash, *keeps, named, twin.config.unsaid)


def examine(folder: Path, most_freedoms: int) -> TwinProfile:
    """Evaluate a twin that a client sent.

    Raises
    ------
    InputError
        If it cannot be read, or its structure has too many freedoms.
    """
    config = read_twin(folder / TWIN_FILE, records_follow=True)
    usual = config.subdivide or config.structure.subdivide
    inner = sum((bar.elements or usual) - 1 for bar in config.structure.bars)
    freedoms = 6 * (len(config.structure.nodes) + inner)
    require(
        freedoms <= most_freedoms,
        "the structure has too many freedoms to be observed with",
        field="subdivide",
        value=freedoms,
        allowed=f"up to {most_freedoms} freedoms",
        remedy="cut members less finely, or set JACKETTWIN_SERVE_FREEDOMS_LIMIT",
    )
    return profile_of(Twin(config, twin_model(config)))


def profile_path(folder: Path) -> Path:
    """Return where the profile of a version stands, as this version of the program sees it."""
    return folder.with_name(f"{folder.name}-{__version__}.json")


def keep_profile(folder: Path, profile: TwinProfile) -> None:
    """Put a profile beside the files of its version."""
    with atomic_path(profile_path(folder)) as temporary:
        temporary.write_text(json.dumps(PROFILE.dump(profile)), encoding="utf-8")


def read_profile(path: Path) -> TwinProfile:
    """Return a profile that was kept."""
    return PROFILE.load(json.loads(path.read_text(encoding="utf-8")))


def _empty(model: TwinModel | TwinProfile) -> TwinState:
    return TwinState(model.model_hash, model.by_wind, model.with_shapes)


def observed(
    model: TwinModel, waveform: Path, conditions: Mapping[str, Any], picks: Sequence[Mapping[str, Any]] = ()
) -> tuple[str, tuple[dict[str, Any], ...], tuple[dict[str, Any], ...], dict[str, Any] | None]:
    """Return the observation of a stored record as a document, its modes and its findings as rows.

    The last is why it does not count, if it is of another structure.

    ``picks`` are poles that a person chose instead of the automatic selection.
    """
    if picks:
        model = model.with_picks(tuple(Pick(float(p["frequency_hz"]), p.get("order")) for p in picks))
    record = read_waveform(waveform)
    record = replace(record, conditions={**conditions, **record.conditions})
    seen = observe(record, model)
    rows = []
    for mode, known in zip(seen.identification.modes, seen.recognised, strict=True):
        low, high = mode.damping_ratio_interval_95 or (None, None)
        rows.append(
            {
                "label": "" if known is None else known.label,
                "frequency_hz": mode.frequency_hz,
                "frequency_std_hz": mode.frequency_std_hz,
                "damping_ratio": mode.damping_ratio,
                "damping_ratio_std": mode.damping_ratio_std,
                "damping_ratio_low_95": low,
                "damping_ratio_high_95": high,
                "status": str(mode.status)[:255],
            }
        )
    document = json.dumps(OBSERVATION.dump(seen), ensure_ascii=False, separators=(",", ":"))
    said = tuple(finding_row(f) for f in seen.findings)
    return document, tuple(rows), said, _MISMATCHED if seen.mismatched else None


_MISMATCHED = {
    "detail": "none of its modes is one of this twin's: it does not count",
    "field": "record",
    "remedy": "see whether it is of another turbine, and where the twin says that its sensors are",
}


def advance_day(
    model: TwinModel | TwinProfile, day: str, stored: str | None, observations: Sequence[str]
) -> FoldedDay:
    """Return the state of a day that knows some more observations of it."""
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
    del row["repaired"]  # stored findings have no place for it
    return row


@dataclass(frozen=True)
class Sums:
    """What some days say together, without the days themselves: it does not grow with their number."""

    state: TwinState
    records: int = 0
    first_utc: datetime | None = None
    last_utc: datetime | None = None


def no_days(model: TwinModel | TwinProfile) -> Sums:
    """Return what no day says."""
    return Sums(_empty(model))


def with_day(
    sums: Sums, day: str, document: str, chosen: Callable[[str], bool] = lambda operation: True
) -> Sums:
    """Return what some days and one more say together, of its records in some states of operation."""
    new = DAY.load(json.loads(document)).of_operations(chosen)
    state = replace(sums.state.with_day(day, new), days={})
    times = [t for t in (sums.first_utc, sums.last_utc, new.first, new.last) if t is not None]
    first, last = (min(times), max(times)) if times else (None, None)
    return Sums(state, sums.records + len(new.records), first, last)


@dataclass(frozen=True)
class Past:
    """What all days but the last one, which still grows, say together: kept from question to question.

    ``through`` is the last of them, ``of`` their identity.
    """

    sums: Sums
    through: str
    of: str


PAST = StoredSchema("twin_past", Past)
"""How sums of past days are kept."""


def days_unsummed(past: Mapping[str, Any] | None, identities: Mapping[str, str]) -> str | None:
    """Return the day after which days are not in sums that are kept; None if these do not hold any more."""
    if past is None or past["through"] >= max(identities, default=""):
        return None
    return past["through"] if past["of"] == _identity(identities, past["through"]) else None


def _identity(identities: Mapping[str, str], through: str) -> str:
    return digest([item for item in identities.items() if item[0] <= through])


def summed(
    twin: Twin, past: Mapping[str, Any] | None, identities: Mapping[str, str], documents: Mapping[str, str]
) -> tuple[Sums, Mapping[str, Any] | None]:
    """Return what the records of all days say that may update the supports, and what to keep of it.

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
    """Return what some days say: the mean of every mode with its standard deviations, from when to when."""
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
        "status": "ok" if modes else "no mode of the model has been seen",
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
    }
