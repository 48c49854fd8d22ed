"""``jackettwin verify``: every published number beside ours."""

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
    TableColumn("verdict", lambda row: {True: "ok", False: "FAILED", None: "informs"}[row.ok]),
)


@click.command("verify")
@answers
def verify_command() -> Reply:
    """Recompute every published number of the thesis.

    The exit code is 1 if one fails.
    """
    from jackettwin.verify import STEPS, published_rows

    with progress(STEPS, "verify") as step:
        rows = published_rows(step)
    failed = frozenset(i for i, row in enumerate(rows) if row.ok is False)

    def show() -> None:
        show_table(Table("", _COLUMNS, rows, marked=failed))
        say(_summary(rows))

    return Reply({"rows": [row.document() for row in rows]}, show, exit_code=OUR_FAULT if failed else 0)


def _summary(rows: tuple[Row, ...]) -> str:
    checked = [row.ok for row in rows if row.ok is not None]
    return (
        f"{sum(checked)} of {len(checked)} checked rows hold; {len(rows) - len(checked)} rows only inform: "
        "most need drawings or data that were not published, and --json says why of each"
    )
