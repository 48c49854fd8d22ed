"""Estimates of a turbine's supports and of changes from all its records.

They are computed when no record is waiting, as a posterior costs as much as ten records.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from datetime import date
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.answers import ModeAnswer, Span, answer
from jackettwin.arrays import FloatArray
from jackettwin.caveats import assumption_documents
from jackettwin.change import (
    JUDGED,
    Days,
    Ground,
    WorkingRotor,
    corrections,
    finding_of,
    judge,
    monitoring_document,
    sight_of,
)
from jackettwin.errors import JackettwinError
from jackettwin.files import null_for_nan
from jackettwin.report import (
    PageSection,
    sentences,
    span_words,
    stiffness_section,
    structure_view,
    view_document,
)
from jackettwin.report.build import report_sections
from jackettwin.report.pages.page import page_text
from jackettwin.service.workers import engine, stiffness
from jackettwin.soil import parameter_words
from jackettwin.study import (
    LIFE_SO_FAR,
    ExploreSettings,
    Followed,
    LifeSoFar,
    TwinResult,
    asset_life,
    days_document,
    exploration_document,
    explore_update,
    in_time_document,
    sensitivity_rows,
)
from jackettwin.study.measure import Measured
from jackettwin.study.run import updated_twin
from jackettwin.twin import ALL, OBSERVATION
from jackettwin.twin.operation import OperationRule
from jackettwin.updating import Update, sensitivity
from jackettwin.version import __version__

if TYPE_CHECKING:
    from jackettwin.service.workers.question import Question

CANNOT_MEET = "the model cannot reproduce the measurements on any ground: no interval; see the report"
"""Status of parameters whose best fit does not explain the data."""
_GRID = 33
"""Number of points along each side of the stored cost surface."""
DRAWN = ("explored", "structure", "assumptions")
"""Parts of an answer that are stored for pages of their own."""
NO_MODE = "no mode of the model has been measured"
FEW, GROWN, MOST_DAYS = 24, 1.3, 30
"""Number of records up to which each new one gives a new posterior; beyond it, growth of the number and days
after which there is a new one. A posterior costs as much as a hundred days of stiffness."""
NOT_TO_UPDATE = "no record is in a state of operation that may update the supports (operation.updates)"


def due(before: Mapping[str, Any] | None, asked: Question, changes: int) -> bool:
    """Return whether the posterior of all records is to be sampled again.

    It is while records are few, when their number has grown by a third, once a month, after a change of the
    stiffness, and when the earlier one is outdated. In between, the stiffness is tracked from day to day.
    """
    if before is None or "parameters" not in before["known"] or before["code_version"] != __version__:
        return True
    records, then = asked.in_all[0], before["records"]
    aged = (date.fromisoformat(max(asked.identities)) - date.fromisoformat(before["day"])).days
    grown = records <= max(FEW, then) or records >= GROWN * then
    return bool(grown or aged >= MOST_DAYS or changes != before["changes"])


def asked_together(known: Mapping[str, Any], asked: Question, changes: int) -> dict[str, Any]:
    """Return the part of an estimate from all records that is stored until :func:`due`."""
    return {
        "known": dict(known), "records": asked.in_all[0], "day": max(asked.identities), "changes": changes,
        "code_version": __version__,
    }  # fmt: skip


def of_today(known: Mapping[str, Any], followed: Followed | None) -> dict[str, Any]:
    """Return the estimate from all records, with the stiffness of the last day.

    Parameters that are tracked from day to day have that day's date.
    """
    parameters = {name: dict(p) for name, p in known["parameters"].items()}
    found = {name: value for name, value in known.items() if name not in DRAWN}
    said = "" if followed is None else followed.stiffness_statement
    if followed is not None and said and known["status"] != CANNOT_MEET:
        last = followed.days[-1]
        for name in {*followed.stiffness} & {*parameters}:
            span = list(last.interval_90[name])
            parameters[name] |= {"median": last.median[name], "interval_90": span, "day": last.date}
        found["statement"] = said
    for name, p in parameters.items():
        low, high = p["interval_90"] or (None, None)
        p["words"], p["text"] = parameter_words(name), span_words(Span(p["median"], low, high), p["unit"])
    return found | {"parameters": parameters}


def supports(followed: Followed | None) -> dict[str, Any]:
    """Return the stiffness of every day, as in ``jackettwin follow --json``; empty if there is none."""
    if followed is None or not followed.stiffness_statement:
        return {}
    days = days_document(followed)
    for day in days:
        day["parameters"] = {name: day["parameters"][name] for name in followed.stiffness}
    return {
        "law": followed.law,
        "units": {name: followed.units[name] for name in followed.stiffness},
        "days": days,
        "stiffness_in_time": in_time_document(followed),
        "statement": followed.stiffness_statement,
    }


def through_time(twin: engine.Twin, asked: Question) -> tuple[Followed | None, Mapping[str, Any] | None]:
    """Return the estimates of the supports after each day, or None, and the part to store.

    Raises
    ------
    KeyError
        If a needed day was not sent.
    """
    kept = asked.kept.get("followed")
    try:
        return stiffness.followed(twin, kept, asked.identities, asked.days)
    except (
        JackettwinError
    ):  # no mode yet, or none with a standard deviation; the estimate from all records has the reason
        return None, None


def known(
    twin: engine.Twin, sums: engine.Sums, newest: Sequence[str], in_all: tuple[int, float]
) -> tuple[dict[str, Any], list[PageSection] | None]:
    """Return the estimate of the supports under the twin's first law, and the sections of its report.

    It contains median, 90 % interval and unit of every parameter, and the damping of every mode by source.

    Parameters
    ----------
    sums : of the records that may update the supports
    newest : documents of the newest observations
    in_all : number of records, and their total duration [s]
    """
    total = sums.state.totals.get(ALL)
    if total is None or not total.modes:
        return {"status": NO_MODE if total else NOT_TO_UPDATE, "parameters": {}}, None
    every = (OBSERVATION.load(json.loads(document)) for document in newest)
    shown = tuple(one for one in every if not one.mismatched)
    if twin.config.operation.updates is not None:  # others are followed, and not what the estimate rests on
        used = max(seen.sums.n for seen in total.modes.values())
        in_all = (used, in_all[1] * used / in_all[0])
    measured = Measured(shown, sums.state, in_all=in_all)
    laws = twin.config.update.laws[:1]
    config = replace(twin.config, operation=OperationRule())  # the days contain only records that may update
    result = updated_twin(config, twin.model, measured, laws=laws, posteriors="likely")
    answers = answer(result)
    sections = report_sections(result, answers)
    if not result.updates:
        return {"status": "no law can explain the measured data", "parameters": {}}, sections
    (u,) = result.updates
    sure = u.uncertainty
    median = u.best.theta if sure is None else sure.median
    meets = answers.fit is None or answers.fit.fits
    spans = sure.interval_90.tolist() if sure is not None and meets else [None] * len(median)
    status = "no interval without standard deviations" if sure is None else sure.status
    return {
        "law": u.law,
        "status": status if meets else CANNOT_MEET,
        "reliable": meets,
        "records": in_all[0],
        "until_utc": None if sums.last_utc is None else sums.last_utc.isoformat(),
        "parameters": {
            p.name: {"median": float(value), "interval_90": span, "unit": p.unit}
            for p, value, span in zip(u.problem.parameters, median, spans, strict=True)
        },
        "answers": [
            {"question": q.title, "answer": " ".join(dict.fromkeys((*q.answer, *q.short)))}
            for q in sentences(answers).questions
        ],
        "budget": [_budget(mode) for mode in answers.modes],
        "sensitivity": _sensitivity(u, median, result),
        "explored": _explored(u, median, result.name),
        "structure": null_for_nan(view_document(structure_view(result))),
        "assumptions": assumption_documents(result.assumptions),
    }, sections


def _sensitivity(u: Update, median: FloatArray, result: TwinResult) -> list[dict[str, Any]]:
    """Return the sensitivity of each measured, oscillating mode to every parameter."""
    theta = u.problem.vectors(np.log(median)[None], u.problem.states[0])[0]
    found = sensitivity(u.model, theta, tuple(m.mode for m in result.measured))
    rows = sensitivity_rows(found, [m.label for m in result.measured])
    return [row for row in rows if np.isfinite(row["frequency_hz"])]


def _explored(u: Update, median: FloatArray, name: str) -> dict[str, Any]:
    """Return cost and root loci along each parameter around the medians; empty if there are none.

    The estimate lets a model be wrong in frequency by a constant factor for each mode; the poles contain
    it, so that at the medians each measured mode has its reported frequency.
    """
    at = {p.name: float(np.clip(v, p.low, p.high)) for p, v in zip(u.problem.parameters, median, strict=True)}
    try:
        found = explore_update(name, u, ExploreSettings(grid=_GRID, starts=0, at=at))
    except JackettwinError:  # no mode oscillates there; other results remain
        return {}
    document = exploration_document(found)
    kept = {key: document[key] for key in ("parameters", "loci", "surface", "curves")}
    reported = dict(zip(u.shown, u.central_hz, strict=True))
    for locus in kept["loci"]:
        for branch in locus["branches"]:
            there = branch["frequency_hz"][locus["origin"]]
            factor = reported.get(branch["mode"], np.nan) / there
            if np.isfinite(factor):
                for key in ("pole_real_rad_s", "pole_imag_rad_s", "frequency_hz"):
                    branch[key] = factor * branch[key]
    return {"law": u.law, **_rounded(null_for_nan(kept))}


def _rounded(value: Any) -> Any:
    """Return plain JSON data with numbers of six digits, which suffice for plots."""
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_rounded(one) for one in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value


def _budget(mode: ModeAnswer) -> dict[str, Any]:
    """Return the damping ratios of a mode by source, with 90 % intervals."""
    measured = mode.measured_damping
    return {
        "label": mode.label,
        "measured": None if measured is None else asdict(measured),
        "sources": {name: asdict(span) for name, span in mode.sources.items()},
        "unexplained": mode.unexplained,
    }


def report(sections: Sequence[PageSection], followed: Followed | None, *, title: str, subtitle: str) -> bytes:
    """Return the compressed page of some sections, with the stiffness over time after the first one."""
    if followed is not None and followed.stiffness_statement:
        sections = [*sections[:1], stiffness_section(followed), *sections[1:]]
    text = page_text(sections, title=title, subtitle=f"{subtitle} · jackettwin {__version__}")
    return gzip.compress(text.encode(), mtime=0)


def watched(
    twin: engine.Twin,
    identities: Mapping[str, str],
    documents: Mapping[str, str],
    kept: Mapping[str, Any] | None,
) -> tuple[dict[str, Any], tuple[dict[str, Any], ...], dict[str, Any]]:
    """Return the stored state of monitoring a turbine's days, all present findings as rows, and what it saw.

    Parameters
    ----------
    identities : {day: identity}
        At least one day.
    documents : {day: document}
        Documents of the days that may be needed.
    kept : mapping or None
        Result of an earlier call, which only saves time.

    Raises
    ------
    KeyError
        If a needed day has no document.
    """
    last = max(identities)
    every = Days(identities, lambda day: engine.DAY.load(json.loads(documents[day])))
    before, ground = JUDGED.load(kept) if kept else None, Ground.of(twin.config)
    judged, new = judge(
        twin.model, every, before, twin.config.watch, ground, partial(WorkingRotor.of, twin.config),
        twin.config.water,
    )  # fmt: skip
    said = [(f"{last}T00:00:00+00:00", f) for f in new if f.severity == "info"]
    if (sees := sight_of(judged)) is not None:
        said.append((f"{min(identities)}T00:00:00+00:00", sees))
    for alarm in judged.alarms:
        said += [(alarm["time_utc"], finding_of(alarm)), *corrections(alarm)]
    rows = tuple(engine.finding_row(f) | {"time_utc": at, "day": at[:10]} for at, f in said)
    return JUDGED.dump(judged), rows, monitoring_document(judged)


def lived(
    twin: engine.Twin,
    identities: Mapping[str, str],
    documents: Mapping[str, str],
    kept: Mapping[str, Any] | None,
) -> tuple[list[dict[str, Any]], Mapping[str, Any] | None, tuple[dict[str, Any], ...]]:
    """Return the life of the welds, what to keep of the past days, and findings as rows.

    Nothing if the twin does not ask for life. The last day, which still grows, is not kept.

    Raises
    ------
    KeyError
        If a day is needed that has no document here.
    """
    model = twin.model.stress
    if model is None:
        return [], None, ()
    known = engine.days_unsummed(kept, identities) is not None and kept is not None
    so_far = LIFE_SO_FAR.load(kept["so_far"]) if known and kept is not None else LifeSoFar()
    days = [day for day in identities if day > so_far.through]
    if not days:
        return [], None, ()
    *before, last = days

    def plus(state: LifeSoFar, name: str) -> LifeSoFar:
        return state.plus(name, engine.DAY.load(json.loads(documents[name])), model.settings.budget)

    for name in before:
        so_far = plus(so_far, name)
    past = engine.kept_through(LIFE_SO_FAR.dump(so_far), so_far.through, identities)
    found = asset_life(model, plus(so_far, last))
    rows = tuple(
        engine.finding_row(f) | {"time_utc": f"{day}T00:00:00+00:00", "day": day}
        for day, f in found.findings()
    )
    return _rounded(found.rows()), past, rows
