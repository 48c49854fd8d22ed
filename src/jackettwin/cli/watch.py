"""``jackettwin watch``: detection of changes in a table of modes over time."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import click

from jackettwin.cli.console import (
    FiniteFloat,
    Reply,
    answers,
    progress,
    say,
    say_all,
    show_table,
    with_omissions,
)
from jackettwin.errors import InputError, located, require
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.change import Ground, WorkingRotor
    from jackettwin.change.modal_table import ModalTable
    from jackettwin.structure import Structure
    from jackettwin.twin import WaterConfig


class _Of(TypedDict, total=False):
    """The measured table."""

    structure: Structure
    gravity: bool
    ground: Ground
    rotor: WorkingRotor | None
    water: WaterConfig | None


_SHOWN = 4
"""Largest number of printed causes."""


@click.command("watch")
@click.argument("table", type=click.Path(path_type=Path, dir_okay=False))
@click.option("--columns", help="Frequency columns of a table with one column a mode: f1,f2,…")
@click.option("--conditions", help="Columns with conditions, or none; default: all other numeric columns.")
@click.option(
    "--baseline-days",
    default=365.0,
    show_default=True,
    type=FiniteFloat(min=1.0),
    help="Length of the baseline period.",
)
@click.option(
    "--arl-years", default=10.0, show_default=True, type=FiniteFloat(min=0.1, max=1e4),
    help="Mean time between false alarms.",
)  # fmt: skip
@click.option(
    "--structure",
    "structure_name",
    help="STRUCTURE that was measured, whose patterns distinguish causes.",
)
@click.option(
    "--twin",
    "twin_file",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Twin file in place of --structure: also its ground, and its rotor if that is at work.",
)
@click.option("--timezone", "zone", help="Time zone of times without one, e.g. Europe/Berlin or +01:00.")
@click.option("--relearn", help="Start of a new baseline, after a repair or a confirmed change.")
@click.option(
    "--out", type=click.Path(path_type=Path, file_okay=False), help="Folder for watched.json and report.html."
)
@answers
def watch_command(
    table: Path,
    columns: str | None,
    conditions: str | None,
    baseline_days: float,
    arl_years: float,
    structure_name: str | None,
    twin_file: Path | None,
    zone: str | None,
    relearn: str | None,
    out: Path | None,
) -> Reply:
    """Report whether the modes in TABLE have changed, and why.

    The report includes time and size of changes. TABLE is CSV or Parquet, sorted by time, with one row for
    each mode and time (time_utc, label, frequency_hz and, if known, frequency_std_hz, damping_ratio,
    damping_ratio_std), or with --columns one column for each mode. Further columns are conditions. The first
    days are assumed healthy.
    """
    from jackettwin.change import (
        smallest_sentence,
        statement,
        watched_document,
    )
    from jackettwin.change.modal_table import read_modal_table
    from jackettwin.change.table_monitoring import watch_table
    from jackettwin.decks import read_structure
    from jackettwin.files import atomic_folder, write_json
    from jackettwin.records import read_zone
    from jackettwin.report.pages.watch import build_watch_page

    clock = None if zone is None else read_zone(zone, field="--timezone")
    read = read_modal_table(
        table, columns=_names(columns) or (), conditions=_chosen(conditions), zone=clock
    )  # fmt: skip
    from_day = _day(read, relearn)
    of: _Of = {} if structure_name is None else {"structure": read_structure(structure_name)}
    if twin_file is not None:
        require(
            structure_name is None, "both a structure and a twin are given", field="--twin", value=twin_file,
            remedy="omit --structure: the twin has its own",
        )  # fmt: skip
        of = _twin(twin_file)
    with progress(3 + len(read.history.by_day()), read.name) as step, located(file=table):
        watched = watch_table(
            read,
            baseline_days=baseline_days,
            arl_years=arl_years,
            from_day=from_day,
            progress=step,
            **of,
        )
    document = watched_document(watched)
    if out is not None:
        with atomic_folder(out) as temporary:
            write_json(with_omissions(document, "watch"), temporary / "watched.json")
            build_watch_page(watched, temporary / "report.html")

    def show() -> None:
        say(statement(watched))
        for alarm in document["alarms"]:
            if not (alarm["takes_back_utc"] or alarm["again_utc"]):  # told with the first of its kind
                _show_causes(alarm)
        if could := smallest_sentence(document["smallest_found"]):
            say(could)
        say_all(watched.limits, "limit")
        if out is not None:
            say(f"report: {out / 'report.html'}")

    return Reply(document, show)


def _show_causes(alarm: Mapping[str, Any]) -> None:
    """Print the causes of an alarm's document, and what would tell them apart."""
    from jackettwin.change import alike_sentence, next_sentence

    show_table(Table(f"alarm of {alarm['time_utc']}", _CAUSES, alarm["causes"][:_SHOWN]))
    if alike := alike_sentence(alarm):
        say(alike)
    for group in alarm["inseparable"]:
        say(f"not distinguished by these data: {', '.join(group)}")
    if alarm["next_measurements"]:
        say(next_sentence(alarm))


_CAUSES = (TableColumn("cause", "cause"), TableColumn("probability [%]", "probability", ".1f", 100.0))


def _twin(path: Path) -> _Of:
    """Return what a twin knows of what was measured."""
    from jackettwin.change import Ground, WorkingRotor
    from jackettwin.twin import read_twin

    config = read_twin(path)
    return {
        "structure": config.structure,
        "gravity": config.gravity,
        "ground": Ground.of(config),
        "rotor": WorkingRotor.of(config),
        "water": config.water,
    }


def _names(text: str | None) -> tuple[str, ...] | None:
    return None if text is None else tuple(name.strip() for name in text.split(",") if name.strip())


def _chosen(conditions: str | None) -> tuple[str, ...] | None:
    names = _names(conditions)
    return () if names == ("none",) else names


def _day(table: ModalTable, relearn: str | None) -> float:
    from jackettwin.records import parse_time

    if relearn is None:
        return 0.0
    with located(field="--relearn"):
        try:
            time = parse_time(relearn)
        except InputError as error:
            raise InputError(error.problem, value=relearn, allowed="2025-01-01T13:00:00Z") from None
    return (time.astimezone(UTC) - table.origin).total_seconds() / 86400.0
