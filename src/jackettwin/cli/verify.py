"""``jackettwin verify``: every published number beside ours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click
from rich import table as rich

from jackettwin.cli.console import OUR_FAULT, number, output, print_json, progress
from jackettwin.files import atomic_folder
from jackettwin.report import Section, Table, build_gallery
from jackettwin.report.gallery import STEPS as FIGURE_STEPS
from jackettwin.report.gallery import thesis_figures
from jackettwin.verify import STEPS, Row, published_rows

COLUMNS = ("source", "quantity", "published", "computed", "error [%]", "tolerance [%]", "verdict")


@click.command("verify")
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("out/verify"),
    show_default=True,
    help="Folder of the gallery.",
)
@click.option("--no-figures", is_flag=True, help="Only the numbers; writes nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.pass_context
def verify_command(ctx: click.Context, out: Path, no_figures: bool, as_json: bool) -> None:
    """Recompute every number and figure of the thesis; exit 1 if a number fails."""
    gallery = None if no_figures else out / "gallery.html"
    with progress(STEPS + (0 if no_figures else FIGURE_STEPS + 1), "verify") as step:
        rows = published_rows(step)
        if gallery is not None:
            sections = [Section("Every published number", (_table(rows),)), *thesis_figures(step)]
            step("write the gallery")
            with atomic_folder(out) as temporary:
                build_gallery(sections, temporary, title="The thesis, recomputed")
    if as_json:
        document = {
            "rows": [row.document() for row in rows],
            "gallery": None if gallery is None else str(gallery),
        }
        print_json(document)
    else:
        _print(rows, gallery)
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


def _table(rows: tuple[Row, ...]) -> Table:
    failed = frozenset(i for i, row in enumerate(rows) if row.ok is False)
    cells = tuple(_cells(replace(row, quantity=_with_note(row))) for row in rows)
    return Table(_summary(rows) + ".", COLUMNS, cells, text_columns=2, marked=failed)


def _with_note(row: Row) -> str:
    return f"{row.quantity} ({row.note})" if row.note else row.quantity


def _print(rows: tuple[Row, ...], gallery: Path | None) -> None:
    colours = {True: "green", False: "bold red", None: "dim"}
    table = rich.Table(*COLUMNS)
    for row in rows:
        *cells, verdict = _cells(row)
        table.add_row(*cells, f"[{colours[row.ok]}]{verdict}[/]")
    output.print(table)
    output.print(_summary(rows))
    if gallery is not None:
        output.print(f"gallery: {gallery}")
