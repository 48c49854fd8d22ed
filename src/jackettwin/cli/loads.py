"""``jackettwin loads``: wave and wind loads alone."""

from __future__ import annotations

from typing import Any

import click
from rich.table import Table

from jackettwin.cli.console import fixed, output, print_json, working
from jackettwin.simulate import loads_document, read_scenario


@click.command("loads")
@click.argument("scenario")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def loads_command(scenario: str, as_json: bool) -> None:
    """Wave and wind loads of SCENARIO on an asset that stands still, about still water and about the bed."""
    chosen = read_scenario(scenario)
    with working(f"loads of {chosen.name}"):
        document = loads_document(chosen)
    if as_json:
        print_json(document)
    else:
        _print(chosen.name, document)


def _print(name: str, document: dict[str, Any]) -> None:
    x, y, z = document["reference_point_m"]
    about = f"M about ({x:g}, {y:g}, {z:g}) m of the structure's frame, at still water"
    _print_loads(f"{name}: {' and '.join(document['parts'])}; {about}", document)
    if len(document["parts"]) > 1:
        for part, loads in document["parts"].items():
            _print_loads(f"{part} alone", loads)
    mudline = document["mudline"]
    if mudline is not None:
        output.print(
            f"at the bed, z = {mudline['z_msl_m']:g} m: base shear "
            f"{1e-6 * mudline['base_shear_n']:.4f} MN, overturning moment "
            f"{1e-6 * mudline['overturning_moment_n_m']:.3f} MN·m"
        )
    if document["still_water"] is not None:
        _print_still_water(document["still_water"])
    if document["phases"] is not None:
        _print_phases(document["phases"])
    for warning in document["warnings"]:
        output.print(f"warning: {warning}")


def _print_loads(title: str, loads: dict[str, Any]) -> None:
    output.print(title, markup=False)
    table = Table("load", "max", "min", "mean", "std")
    for key, letter, unit in (("force_n", "F", "MN"), ("moment_msl_n_m", "M", "MN·m")):
        for axis, row in loads[key].items():
            shown = (fixed(1e-6 * row[what], 4) for what in ("max", "min", "mean", "std"))
            table.add_row(rf"{letter}{axis} \[{unit}]", *shown)
    output.print(table)


def _print_still_water(still: dict[str, Any]) -> None:
    centre = still["center_of_buoyancy_m"]
    inside = still["water_inside_n"]
    filled = "not known what is filled" if inside is None else f"water inside weighs {1e-6 * inside:.3f} MN"
    at = "" if centre is None else f" at z = {centre[2]:.2f} m"
    output.print(
        f"still water, not in the loads above: buoyancy {1e-6 * still['buoyancy_n']:.3f} MN{at}, {filled}, "
        f"growth {1e-6 * still['growth_weight_n']:.3f} MN in air; "
        f"{1e-6 * still['pressure_at_the_bed_pa']:.3f} MPa at the bed"
    )


def _print_phases(phases: list[dict[str, Any]]) -> None:
    names = ("phase [°]", r"η \[m]", "Fx [MN]", "Fy [MN]", "Mx at the bed [MN·m]", "My at the bed [MN·m]")
    table = Table(*names, title="water, over one wave", title_justify="left")
    for row in phases:
        scaled = [1e-6 * value for value in (*row["force_n"][:2], *row["moment_mudline_n_m"][:2])]
        table.add_row(
            f"{row['phase_deg']:g}", fixed(row["wave_elevation_m"], 2), *(fixed(value, 4) for value in scaled)
        )
    output.print(table)
