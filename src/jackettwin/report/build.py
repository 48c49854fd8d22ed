"""Put the report together: ``TwinResult`` in, ``report.html`` and its figures out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from jackettwin.identification import Identification
from jackettwin.report.numbers import fixed
from jackettwin.report.page import Block, Section, Table, Text, write_figures, write_page
from jackettwin.report.section_posterior import what_is_known, whose_damping
from jackettwin.report.section_records import the_record, what_was_identified
from jackettwin.report.section_structure import the_structure
from jackettwin.report.section_updating import (
    against_the_truth,
    around_the_solution,
    damped_and_undamped,
    every_solution,
    identified_against_updated,
    the_mode_shapes,
    unexplained_damping,
)
from jackettwin.report.summary import headline
from jackettwin.report.tables_updating import key_table
from jackettwin.twin import Observation, TwinResult
from jackettwin.version import __version__

_SHOWN_WARNINGS = 3


def build_report(result: TwinResult, out_dir: Path) -> Path:
    """Write ``report.html`` (self-contained) and ``figures/NAME.html``; return the path of the report.

    Raises
    ------
    OSError
        If the directory cannot be written.
    """
    sections = report_sections(result)
    write_figures(sections, out_dir / "figures")
    title = f"{result.name}: digital twin of {result.assembly.structure.name}"
    return write_page(sections, out_dir / "report.html", title=title, subtitle=_subtitle(result))


def report_sections(result: TwinResult) -> list[Section]:
    """Return the report's sections in the order an engineer reads them; empty ones are left out."""
    makers: tuple[tuple[str, Callable[[TwinResult], list[Block]]], ...] = (
        ("Summary", _summary),
        ("Structure", the_structure),
        ("Record", the_record),
        ("Identification", what_was_identified),
        ("Identified against updated", identified_against_updated),
        ("Against the known truth", against_the_truth),
        ("What is known", what_is_known),
        ("Whose damping", whose_damping),
        ("Damped and undamped", damped_and_undamped),
        ("Mode shapes", the_mode_shapes),
        ("Solutions", every_solution),
        ("Sensitivity and root locus", around_the_solution),
        ("Damping no support explains", unexplained_damping),
        ("Assumptions and warnings", _assumptions),
        ("Provenance", _provenance),
    )
    sections = [Section(title, tuple(make(result))) for title, make in makers]
    return [section for section in sections if section.blocks]


def _subtitle(result: TwinResult) -> str:
    names = [name for found in result.identifications for name in found.records]
    source = (
        f"record {names[0]}" if len(names) == 1 else f"{len(names)} records" if names else "given targets"
    )
    return f"{source} · jackettwin {__version__}"


def _summary(result: TwinResult) -> list[Block]:
    blocks: list[Block] = [Text(headline(result)), key_table(result)]
    if result.warnings:
        more = len(result.warnings) - _SHOWN_WARNINGS
        said = (f"… and {more} more, under Assumptions and warnings.",) if more > 0 else ()
        blocks.append(Text(result.warnings[:_SHOWN_WARNINGS] + said, "warnings"))
    return blocks


def _assumptions(result: TwinResult) -> list[Block]:
    blocks: list[Block] = [Text(result.assumptions, "list")] if result.assumptions else []
    return [*blocks, Text(result.warnings, "warnings")] if result.warnings else blocks


def _provenance(result: TwinResult) -> list[Block]:
    rows = [("jackettwin", __version__), ("twin", result.name), ("structure", result.assembly.structure.name)]
    rows.append(("degrees of freedom", str(result.assembly.n_dof)))
    rows += [("record", _conditions(seen)) for seen in result.observations]
    settings: dict[tuple[tuple[str, str], ...], list[str]] = {}
    for found in result.identifications:
        settings.setdefault(_settings(found), []).extend(found.records)
    for chosen, records in settings.items():
        rows += [("identified with, in", ", ".join(records)), *chosen]
    return [Table("Where the numbers come from.", ("what", "value"), tuple(rows), 2)]


def _conditions(record: Observation) -> str:
    return "; ".join([record.name, *(f"{key} {value}" for key, value in record.conditions.items())])


def _settings(found: Identification) -> tuple[tuple[str, str], ...]:
    s = found.settings
    return (
        ("channels", ", ".join(c.name for c in found.channels)),
        ("band", f"{fixed(s.lowest_frequency_hz, 3)} to {fixed(s.highest_frequency_hz, 3)} Hz"),
        ("decimated to", f"{s.sample_rate_hz:.4g} Hz"),
        ("lag window", f"{s.lag_window_s:.3g} s, {s.block_rows} block rows"),
        ("model orders", f"{s.orders[0]} to {s.orders[-1]}, {len(s.orders)} of them"),
    )
