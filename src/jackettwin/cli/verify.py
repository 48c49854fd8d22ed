"""``jackettwin verify``: every published number beside ours."""

from __future__ import annotations

import click
from rich import table as rich

from jackettwin.cli.console import OUR_FAULT, number, output, print_json, progress
from jackettwin.verify import STEPS, Row, published_rows

COLUMNS = ("source", "quantity", "published", "computed", "error [%]", "tolerance [%]", "verdict")


@click.command("verify")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.pass_context
def verify_command(ctx: click.Context, as_json: bool) -> None:
    """Recompute every published number of the thesis; exit 1 if one fails."""
    with progress(STEPS, "verify") as step:
        rows = published_rows(step)
    if as_json:
        print_json({"rows": [row.document() for row in rows]})
    else:
        _print(rows)
    if any(row.ok is False for row in rows):
        ctx.exit(OUR_FAULT)


def _cells(row: Row) -> tuple[str, ...]:
    error = row.relative_error
    return (
        row.source,
        row.quantity,
        ("≤ " if row.kind == "at most" else "") + number(row.published, 6),
        number(row.computed, 6),
        number(None if error is None else 100 * error, 2),
        number(None if row.tolerance is None else 100 * row.tolerance, 2),
        {True: "ok", False: "FAILED", None: "informs"}[row.ok],
    )


def _summary(rows: tuple[Row, ...]) -> str:
    checked = [row.ok for row in rows if row.ok is not None]
    return (
        f"{sum(checked)} of {len(checked)} checked rows hold; {len(rows) - len(checked)} rows only inform: "
        "they need drawings or data that were not published"
    )


def _print(rows: tuple[Row, ...]) -> None:
    colours = {True: "green", False: "bold red", None: "dim"}
    table = rich.Table(*COLUMNS)
    for row in rows:
        *cells, verdict = _cells(row)
        table.add_row(*cells, f"[{colours[row.ok]}]{verdict}[/]")
    output.print(table)
    output.print(_summary(rows))
