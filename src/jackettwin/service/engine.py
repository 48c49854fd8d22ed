"""The seam to the engine: documents in, documents out.

Nothing below it knows of a store, nothing above it of a model.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from jackettwin.answers import answer
from jackettwin.answers.result import ModeAnswer
from jackettwin.findings import Finding
from jackettwin.identification.picks import Pick
from jackettwin.records import Channel
from jackettwin.report.build import report_sections
from jackettwin.report.page import PageSection, page_text
from jackettwin.store import read_waveform
from jackettwin.twin import (
    JUDGED,
    TwinConfig,
    TwinModel,
    TwinState,
    advance,
    finding_of,
    judge,
    observe,
    read_twin,
    twin_model,
)
from jackettwin.twin.fitted import updating
from jackettwin.twin.measure import Measured
from jackettwin.twin.observation import OBSERVATION, Observation
from jackettwin.twin.run import updated_twin
from jackettwin.twin.state import ALL, Day, empty_state
from jackettwin.twin.stored import StoredSchema, digest
from jackettwin.twin.sums import average
from jackettwin.version import __version__

TWIN_FILE = "twin.yaml"
CANNOT_MEET = "the model cannot meet what was measured on any ground: no interval; see the report"
"""What is said of parameters that come nearest to the data and do not explain them."""
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


def identity(model: TwinModel) -> tuple[str, str]:
    """Return the hashes of a model and of the settings it observes with."""
    settings = model.settings_hash("")
    return digest([model.model_hash, settings]), settings


def channels(folder: Path) -> dict[str, Channel]:
    """Return what a twin says of its channels, {name: channel}."""
    return {
        s.channel: Channel(s.channel, height_m=s.height_m, node=s.node, direction=s.direction)
        for s in load_twin(folder).config.sensors
    }


def observed(
    model: TwinModel, waveform: Path, conditions: Mapping[str, Any], picks: Sequence[Mapping[str, Any]] = ()
) -> tuple[str, tuple[dict[str, Any], ...], tuple[dict[str, Any], ...]]:
    """Return the observation of a stored record as a document, its modes and its findings as rows.

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
    return document, tuple(rows), tuple(_finding(f) for f in seen.findings)


def advance_day(model: TwinModel, day: str, stored: str | None, observations: Sequence[str]) -> FoldedDay:
    """Return the state of a day that knows some more observations of it."""
    days = {} if stored is None else {day: DAY.load(json.loads(stored))}
    state = replace(empty_state(model), days=days)
    found = []
    for document in observations:
        state, findings = advance(state, OBSERVATION.load(json.loads(document)))
        found.append(tuple(_finding(f) for f in findings if f.code != "record_late"))
    known = state.days[day]
    text = json.dumps(DAY.dump(known), ensure_ascii=False, sort_keys=True, separators=(",", ":"))
    return FoldedDay(text, len(known.records), tuple(found))


def state_of(model: TwinModel, days: Mapping[str, str]) -> TwinState:
    """Return the state of a twin whose days are these documents."""
    state = empty_state(model)
    for day, document in days.items():
        state = state.with_day(day, DAY.load(json.loads(document)))
    return state


def _finding(finding: Finding) -> dict[str, Any]:
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


def no_days(model: TwinModel) -> Sums:
    """Return what no day says."""
    return Sums(empty_state(model))


def with_day(sums: Sums, day: str, document: str) -> Sums:
    """Return what some days and one more say together."""
    new = DAY.load(json.loads(document))
    state = replace(sums.state.with_day(day, new), days={})
    times = [t for t in (sums.first_utc, sums.last_utc, new.first, new.last) if t is not None]
    first, last = (min(times), max(times)) if times else (None, None)
    return Sums(state, sums.records + len(new.records), first, last)


def knowledge(model: TwinModel, sums: Sums) -> dict[str, Any]:
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


@dataclass(frozen=True)
class Basis:
    """What a turbine's records showed: their state, and the newest observations alone.

    ``in_all`` is how many records there are, and how long they are together [s].
    """

    state: TwinState
    newest: tuple[Observation, ...] = ()
    in_all: tuple[int, float] = (0, 0.0)


def seen(state: TwinState, newest: Sequence[str], in_all: tuple[int, float]) -> Basis:
    """Return what records showed, the newest observations from their documents."""
    return Basis(state, tuple(OBSERVATION.load(json.loads(document)) for document in newest), in_all)


def known(twin: Twin, seen: Basis) -> tuple[dict[str, Any], list[PageSection] | None]:
    """Return what records say of the supports under the twin's first law, and the page on it in sections.

    Of every parameter the median, its 90 % interval and unit; of every mode whose damping it is.
    """
    state = updating(twin.config, seen.state)
    if ALL not in state.totals or not state.totals[ALL].modes:
        return {"status": "no mode of the model has been seen", "parameters": {}}, None
    measured = Measured(seen.newest, seen.state, in_all=seen.in_all)
    laws = twin.config.update.laws[:1]
    result = updated_twin(twin.config, twin.model, measured, laws=laws, posteriors="likely")
    answers = answer(result)
    sections = report_sections(result, answers)
    if not result.updates:
        return {"status": "no law can explain what was measured", "parameters": {}}, sections
    (u,) = result.updates
    sure = u.uncertainty
    median = u.best.theta if sure is None else sure.median
    meets = answers.fit is None or answers.fit.fits
    spans = sure.interval_90.tolist() if sure is not None and meets else [None] * len(median)
    status = "without standard deviations, no interval" if sure is None else sure.status
    return {
        "law": u.law,
        "status": status if meets else CANNOT_MEET,
        "records": seen.in_all[0],
        "until_utc": max(day.time_utc for day in state.days.values() if day.time_utc).isoformat(),
        "parameters": {
            p.name: {"median": float(value), "interval_90": span, "unit": p.unit}
            for p, value, span in zip(u.problem.parameters, median, spans, strict=True)
        },
        "budget": [_budget(mode) for mode in answers.modes],
    }, sections


def _budget(mode: ModeAnswer) -> dict[str, Any]:
    """Return whose damping a mode's is: damping ratios by source, with 90 % intervals."""
    measured = mode.measured_damping
    return {
        "label": mode.label,
        "measured": None if measured is None else asdict(measured),
        "sources": {name: asdict(span) for name, span in mode.sources.items()},
    }


def report(sections: Sequence[PageSection], *, title: str, subtitle: str) -> bytes:
    """Return the page of some sections, compressed."""
    text = page_text(sections, title=title, subtitle=f"{subtitle} · jackettwin {__version__}")
    return gzip.compress(text.encode(), mtime=0)


def watched(
    twin: Twin, state: TwinState, kept: Mapping[str, Any] | None
) -> tuple[dict[str, Any], tuple[dict[str, Any], ...]]:
    """Return what is kept of watching a turbine's days, and every finding of them that holds now, as rows.

    Parameters
    ----------
    state : TwinState
        With one day at least.
    kept : mapping or None
        What an earlier call returned; it only saves time.
    """
    last = max(state.days)
    judged, new = judge(twin.model, state, JUDGED.load(kept) if kept else None, twin.config.watch)
    said = [(f"{last}T00:00:00+00:00", f) for f in new if f.severity == "info"]
    said += [(alarm["time_utc"], finding_of(alarm)) for alarm in judged.alarms]
    return JUDGED.dump(judged), tuple(_finding(f) | {"time_utc": at, "day": at[:10]} for at, f in said)


def stabilisation(folder: str, waveform: str) -> dict[str, Any]:
    """Return the poles of every model order of a stored record."""
    from jackettwin.twin.observe import examined

    record = read_waveform(Path(waveform))
    poles = examined(record, load_twin(Path(folder)).model).identification.stabilisation
    return {
        "order": poles.order.tolist(),
        "frequency_hz": poles.frequency_hz.tolist(),
        "damping_ratio": poles.damping_ratio.tolist(),
        "stable": poles.stable.tolist(),
        "mode": poles.cluster.tolist(),
    }
