"""What a turbine's records together say of its supports, and of a change.

It is asked when no record waits: a posterior costs as much as ten records.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from jackettwin.answers import ModeAnswer, answer
from jackettwin.arrays import FloatArray
from jackettwin.change import JUDGED, Days, Ground, corrections, finding_of, judge
from jackettwin.report import PageSection
from jackettwin.report.build import report_sections
from jackettwin.report.pages.page import page_text
from jackettwin.service.workers import engine
from jackettwin.study import TwinResult, sensitivity_rows
from jackettwin.study.measure import Measured
from jackettwin.study.run import updated_twin
from jackettwin.twin import ALL, OBSERVATION
from jackettwin.twin.operation import OperationRule
from jackettwin.updating import Update, sensitivity
from jackettwin.version import __version__

CANNOT_MEET = "the model cannot meet what was measured on any ground: no interval; see the report"
"""What is said of parameters that come nearest to the data and do not explain them."""
NO_MODE = "no mode of the model has been seen"
NOT_TO_UPDATE = "no record is in a state of operation that may update the supports (operation.updates)"


def known(
    twin: engine.Twin, sums: engine.Sums, newest: Sequence[str], in_all: tuple[int, float]
) -> tuple[dict[str, Any], list[PageSection] | None]:
    """Return what records say of the supports under the twin's first law, and the page on it in sections.

    Of every parameter the median, its 90 % interval and unit; of every mode whose damping it is.

    Parameters
    ----------
    sums : of the records that may update the supports
    newest : documents of the newest observations
    in_all : how many records there are, and how long they are together [s]
    """
    total = sums.state.totals.get(ALL)
    if total is None or not total.modes:
        return {"status": NO_MODE if total else NOT_TO_UPDATE, "parameters": {}}, None
    every = (OBSERVATION.load(json.loads(document)) for document in newest)
    shown = tuple(one for one in every if not one.mismatched)
    measured = Measured(shown, sums.state, in_all=in_all)
    laws = twin.config.update.laws[:1]
    config = replace(twin.config, operation=OperationRule())  # who may update was asked of each day
    result = updated_twin(config, twin.model, measured, laws=laws, posteriors="likely")
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
        "records": in_all[0],
        "until_utc": None if sums.last_utc is None else sums.last_utc.isoformat(),
        "parameters": {
            p.name: {"median": float(value), "interval_90": span, "unit": p.unit}
            for p, value, span in zip(u.problem.parameters, median, spans, strict=True)
        },
        "budget": [_budget(mode) for mode in answers.modes],
        "sensitivity": _sensitivity(u, median, result),
    }, sections


def _sensitivity(u: Update, median: FloatArray, result: TwinResult) -> list[dict[str, Any]]:
    """Return by how much every parameter moves each measured mode; of none that does not oscillate."""
    theta = u.problem.vectors(np.log(median)[None], u.problem.states[0])[0]
    found = sensitivity(u.model, theta, tuple(m.mode for m in result.measured))
    rows = sensitivity_rows(found, [m.label for m in result.measured])
    return [row for row in rows if np.isfinite(row["frequency_hz"])]


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
    twin: engine.Twin,
    identities: Mapping[str, str],
    documents: Mapping[str, str],
    kept: Mapping[str, Any] | None,
) -> tuple[dict[str, Any], tuple[dict[str, Any], ...]]:
    """Return what is kept of watching a turbine's days, and every finding of them that holds now, as rows.

    Parameters
    ----------
    identities : {day: identity}
        One day at least.
    documents : {day: document}
        Of those days that may be asked for.
    kept : mapping or None
        What an earlier call returned; it only saves time.

    Raises
    ------
    KeyError
        If a day is needed that has no document here.
    """
    last = max(identities)
    every = Days(identities, lambda day: engine.DAY.load(json.loads(documents[day])))
    before, ground = JUDGED.load(kept) if kept else None, Ground.of(twin.config)
    judged, new = judge(twin.model, every, before, twin.config.watch, ground)
    said = [(f"{last}T00:00:00+00:00", f) for f in new if f.severity == "info"]
    for alarm in judged.alarms:
        said += [(alarm["time_utc"], finding_of(alarm)), *corrections(alarm)]
    return JUDGED.dump(judged), tuple(
        engine.finding_row(f) | {"time_utc": at, "day": at[:10]} for at, f in said
    )
