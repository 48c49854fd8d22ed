"""``jackettwin loads``: wave and wind loads alone."""

from __future__ import annotations

from typing import Any

import click
from rich.table import Table

from jackettwin.cli.console import output, print_json
from jackettwin.simulate import loads_document, read_scenario


@click.command("loads")
@click.argument("scenario")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def loads_command(scenario: str, as_json: bool) -> None:
    """Wave and wind loads of SCENARIO on an asset that stands still: force, and moment about still water."""
    document = loads_document(read_scenario(scenario))
    if as_json:
        print_json(document)
    else:
        _print(document)


def _print(document: dict[str, Any]) -> None:
    table = Table("load", "max", "min", "mean", "std")
    for key, unit, scale in (("force_n", "MN", 1e-6), ("moment_msl_n_m", "MN·m", 1e-6)):
        for axis, row in document[key].items():
            name = f"{'F' if key == 'force_n' else 'M'}{axis} [{unit}]"
            table.add_row(name, *(f"{scale * row[what]:.4f}" for what in ("max", "min", "mean", "std")))
    output.print(table)
