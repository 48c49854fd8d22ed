"""Assemble the report: ``report.html`` and its figures from a ``TwinResult``."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from jackettwin.answers import Answers, answer
from jackettwin.identification import Identification
from jackettwin.report.pages.page import Block, PageSection, Text, write_figures, write_page
from jackettwin.report.sections import appendix as appendix, first as first
from jackettwin.report.sections.records import further_records, the_records
from jackettwin.report.sections.structure import the_structure
from jackettwin.report.table import Table
from jackettwin.report.tables import answers as tables
from jackettwin.report.tables.numbers import fixed, sentence
from jackettwin.report.tables.sentences import FirstPageWords, sentences
from jackettwin.report.tables.updating import true_parameters_table, truth_table
from jackettwin.study import TwinResult, true_parameters
from jackettwin.study.truth import true_modes
from jackettwin.twin import Observation
from jackettwin.version import __version__

Rows = tuple[tuple[str, str], ...]


def build_report(
    result: TwinResult, out_dir: Path, *, answers: Answers | None = None, provenance: Rows = ()
) -> Path:
    """Write ``report.html`` (self-contained) and ``figures/NAME.html``; return the path of the report.

    Parameters
    ----------
    answers : Answers, optional
        Answers of this result, if already computed.
    provenance : tuple of (what, value)
        Facts that only the caller knows: time, command, files.

    Raises
    ------
    OSError
        If the directory cannot be written.
    """
    sections = report_sections(result, answers or answer(result), provenance)
    write_figures(sections, out_dir / "figures")
    title = f"{result.name}: digital twin of {result.assembly.structure.name}"
    return write_page(sections, out_dir / "report.html", title=title, subtitle=_subtitle(result, provenance))


def report_sections(
    result: TwinResult, answers: Answers | None = None, provenance: Rows = ()
) -> list[PageSection]:
    """Return the report's sections: verdict, engineer's part, appendix; empty ones are left out."""
    a = answers or answer(result)
    said = sentences(a)
    makers: tuple[tuple[str, Callable[[TwinResult], list[Block]]], ...] = (
        ("Verdict", lambda r: [first.first_page(a, said)]),
        ("Modes", partial(_modes, a=a, said=said)),
        ("The ground", partial(_ground, a=a, said=said)),
        ("Whose damping", partial(_damping, a=a, said=said)),
        ("What to do next", partial(_next, a=a, said=said)),
        ("Records", the_records),
        ("Assumptions and warnings", _assumptions),
    )
    after: tuple[tuple[str, Callable[[TwinResult], list[Block]]], ...] = (
        ("Structure", the_structure),
        ("Every law", appendix.every_law),
        ("Posterior", appendix.posterior),
        ("Tolerances", appendix.tolerances),
        ("Solutions", appendix.every_solution),
        ("Identification", further_records),
        ("Provenance", partial(_provenance, given=provenance)),
    )
    sections = [PageSection(title, tuple(make(result))) for title, make in makers]
    sections += [PageSection(title, tuple(make(result)), appendix=True) for title, make in after]
    return [section for section in sections if section.blocks]


def _subtitle(result: TwinResult, provenance: Rows) -> str:
    names = [name for found in result.identifications for name in found.records]
    source = (
        f"record {names[0]}" if len(names) == 1 else f"{len(names)} records" if names else "given targets"
    )
    when = dict(provenance).get("made", "")
    return " · ".join(
        filter(
            None, (source, when, f"jackettwin {__version__}", "intervals are 90 % unless stated otherwise")
        )
    )


def _more(said: FirstPageWords, title: str) -> list[Block]:
    texts = next(q.more for q in said.questions if q.title == title)
    return [Text(texts)] if texts else []


def _modes(result: TwinResult, *, a: Answers, said: FirstPageWords) -> list[Block]:
    blocks: list[Block] = [*_more(said, first.MODEL), tables.modes_table(a, result), *first.shapes(result)]
    known = true_modes(result)
    return [*blocks, truth_table(result, a, known)] if known else blocks


def _ground(result: TwinResult, *, a: Answers, said: FirstPageWords) -> list[Block]:
    if not a.ground:
        return []
    blocks: list[Block] = [
        *_more(said, first.GROUND),
        *first.ground_drawing(a),
        *first.tornado_drawing(a),
    ]
    blocks += [tables.ground_table(a), tables.laws_table(a)]
    parameters = true_parameters(result)
    return [*blocks, true_parameters_table(parameters)] if parameters else blocks


def _damping(result: TwinResult, *, a: Answers, said: FirstPageWords) -> list[Block]:
    return [*_more(said, first.DAMPING), tables.budget_table(a)] if a.law else []


def _next(result: TwinResult, *, a: Answers, said: FirstPageWords) -> list[Block]:
    return [*_more(said, first.NEXT), *([tables.next_table(a)] if a.next_steps else [])]


def _assumptions(result: TwinResult) -> list[Block]:
    choices = tuple(sentence(one.value) for one in result.assumptions if one.confirmed is None)
    blocks: list[Block] = [Text(choices, "list")] if choices else []
    return [*blocks, Text(result.warnings, "warnings")] if result.warnings else blocks


def _provenance(result: TwinResult, *, given: Rows) -> list[Block]:
    rows = [("jackettwin", __version__), ("twin", result.name), ("structure", result.assembly.structure.name)]
    rows += [("degrees of freedom", str(result.assembly.n_dof)), *given]
    rows += [("record", _conditions(seen)) for seen in result.observations]
    settings: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for found in result.identifications:
        settings.setdefault(_settings(found), []).extend(found.records)
    for chosen, records in settings.items():
        rows += [("identified with, in", ", ".join(records)), *chosen]
    return [Table("Where do the numbers come from?", ("what", "value"), tuple(rows), 2)]


def _conditions(record: Observation) -> str:
    return "; ".join([record.name, *(f"{key} {_short(value)}" for key, value in record.conditions.items())])


def _short(value: Any) -> str:
    """Return a condition without the digits that a store adds."""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _settings(found: Identification) -> tuple[tuple[str, str], ...]:
    s = found.settings
    return (
        ("channels", ", ".join(c.name for c in found.channels)),
        ("band", f"{fixed(s.lowest_frequency_hz, 3)} to {fixed(s.highest_frequency_hz, 3)} Hz"),
        ("decimated to", f"{s.sample_rate_hz:.4g} Hz"),
        ("lag window", f"{s.lag_window_s:.3g} s, {s.block_rows} block rows"),
        ("model orders", f"{s.orders[0]} to {s.orders[-1]}, {len(s.orders)} of them"),
    )
