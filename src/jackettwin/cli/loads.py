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
    """Wave and wind loads of SCENARIO on an asset that stands still, about still water and about the bed."""
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
    mudline = document["mudline"]
    if mudline is not None:
        output.print(
            f"M about still water; at the bed, z = {mudline['z_msl_m']:g} m: base shear "
            f"{1e-6 * mudline['base_shear_n']:.4f} MN, overturning moment "
            f"{1e-6 * mudline['overturning_moment_n_m']:.3f} MN·m"
        )
    if document["phases"] is not None:
        _print_phases(document["phases"])
    for warning in document["warnings"]:
        output.print(f"warning: {warning}")


def _print_phases(phases: list[dict[str, Any]]) -> None:
    names = ("phase [°]", "η [m]", "Fx [MN]", "Fy [MN]", "Mx at the bed [MN·m]", "My at the bed [MN·m]")
    table = Table(*names, title="water, over one wave", title_justify="left")
    for row in phases:
        scaled = [1e-6 * value for value in (*row["force_n"][:2], *row["moment_mudline_n_m"][:2])]
        table.add_row(
            f"{row['phase_deg']:g}", f"{row['wave_elevation_m']:.2f}", *(f"{value:.4f}" for value in scaled)
        )
    output.print(table)
