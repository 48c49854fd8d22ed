"""``jackettwin verify``: comparison with published numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jackettwin.cli.console import OUR_FAULT, Reply, answers, progress, say, show_table
from jackettwin.report import Table, TableColumn, cell

if TYPE_CHECKING:
    from jackettwin.verify import Row


_COLUMNS = (
    TableColumn("source", lambda row: row.source),
    TableColumn("quantity", lambda row: row.quantity),
    TableColumn(
        "published", lambda row: ("≤ " if row.kind == "at most" else "") + cell(row.published, ".6g")
    ),
    TableColumn("computed", lambda row: row.computed, ".6g"),
    TableColumn("error [%]", lambda row: row.relative_error, ".2g", 100.0),
    TableColumn("tolerance [%]", lambda row: row.tolerance, ".2g", 100.0),
    TableColumn("verdict", lambda row: _verdict(row)),
)


@click.command("verify")
@click.option("--published", is_flag=True, help="Benchmarks by other authors, instead of the thesis's.")
@answers
def verify_command(published: bool) -> Reply:
    """Recompute every published number of the thesis.

    With --published: published benchmarks of beams, frames, piles, rotors, waves and welds. The exit code is
    1 if a row fails; a row that fails for a known reason is listed with that reason.
    """
    from jackettwin.verify import STEPS, STEPS_OF_OTHERS, benchmark_rows, published_rows

    recompute, steps = (benchmark_rows, STEPS_OF_OTHERS) if published else (published_rows, STEPS)
    with progress(steps, "verify") as step:
        rows = recompute(step)
    failed = frozenset(i for i, row in enumerate(rows) if row.failed)

    def show() -> None:
        show_table(
            Table("", _COLUMNS, rows, marked=frozenset(i for i, row in enumerate(rows) if row.ok is False))
        )
        if published:
            _say_tolerances(rows)
        _say_reasons(rows)
        say(_summary_of_others(rows) if published else _summary(rows))

    document = {"rows": [row.document() for row in rows]}
    return Reply(document, show, exit_code=OUR_FAULT if failed else 0)


def _summary(rows: tuple[Row, ...]) -> str:
    checked = [row.ok for row in rows if row.ok is not None]
    return (
        f"{sum(checked)} of {len(checked)} checked rows hold; {len(rows) - len(checked)} rows are "
        "not checked, for the reasons above"
    )


def _verdict(row: Row) -> str:
    if row.ok is False:
        return "misses" if row.missed else "FAILED"
    return "informs" if row.ok is None else "ok"


def _say_tolerances(rows: tuple[Row, ...]) -> None:
    tolerances = dict.fromkeys((row.source, row.note) for row in rows if row.note and row.ok is not None)
    for source, note in tolerances:
        say(f"tolerance of {source}: {note}")


def _say_reasons(rows: tuple[Row, ...]) -> None:
    """Print why rows are not checked, or lie outside their tolerances."""
    for row in rows:
        if row.ok is None:
            say(f"informs: {row.quantity}, {row.source}: {row.note}")
        elif row.missed:
            say(f"misses: {row.quantity}, {row.source}: {row.missed}")


def _summary_of_others(rows: tuple[Row, ...]) -> str:
    from jackettwin.verify import median_error

    checked, median = [row.ok for row in rows if row.ok is not None], 100.0 * median_error(rows)
    return (
        f"{sum(checked)} of {len(checked)} checked rows hold, median error {median:.2g} %; "
        f"{len(rows) - len(checked)} rows are not checked"
    )
