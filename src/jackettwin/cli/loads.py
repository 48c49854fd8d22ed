"""``jackettwin loads``: wave and wind loads without response."""

from __future__ import annotations

from typing import Any

import click

from jackettwin.caveats import omission_sentences
from jackettwin.cli.console import Reply, answers, say, say_all, show_table, working
from jackettwin.report import Table, TableColumn

_SLAMMED = 5
"""Number of members under slamming shown on the terminal."""


@click.command("loads")
@click.argument("scenario")
@answers
def loads_command(scenario: str) -> Reply:
    """Compute wave and wind loads of SCENARIO on a still asset.

    Moments are given about still water level and about the bed.
    """
    from jackettwin.simulate import loads_document, read_scenario

    chosen = read_scenario(scenario)
    with working(f"loads of {chosen.name}"):
        document = loads_document(chosen)
    return Reply(document, lambda: _show(chosen.name, document))


def _show(name: str, document: dict[str, Any]) -> None:
    x, y, z = document["reference_point_m"]
    about = f"M about ({x:g}, {y:g}, {z:g}) m of the structure's frame, at still water"
    _show_loads(f"{name}: {' and '.join(document['parts'])}; {about}", document)
    if len(document["parts"]) > 1:
        for part, loads in document["parts"].items():
            _show_loads(f"{part} alone", loads)
    mudline = document["mudline"]
    if mudline is not None:
        say(
            f"at the bed, z = {mudline['z_msl_m']:g} m: base shear "
            f"{1e-6 * mudline['base_shear_n']:.4f} MN, overturning moment "
            f"{1e-6 * mudline['overturning_moment_n_m']:.3f} MN·m"
        )
    if document["still_water"] is not None:
        _show_still_water(document["still_water"])
    if document["phases"] is not None:
        show_table(Table("water, over one wave", _PHASES, document["phases"]))
    if document["radiation"] is not None:
        say(
            "damping by the waves that the asset radiates, which models leave out: "
            + ", ".join(f"{m['label']} {100.0 * m['damping_ratio']:.1g} %" for m in document["radiation"])
        )
    if document["breaking"] is not None:
        _show_breaking(document["breaking"])
    say_all(document["warnings"], "warning")
    say_all(omission_sentences(document["left_out"]), "left out")


def _show_breaking(breaking: dict[str, Any]) -> None:
    height, limit = breaking["highest_wave_m"], breaking["limit_m"]
    verdict = "breaks" if breaking["breaks"] else "stands"
    say(f"the highest wave, {height:.2f} m, {verdict}: the limit is {limit:.2f} m")
    if breaking["impact"] is not None:
        hit = breaking["impact"]
        say(f"a wave that breaks at {hit['member']} hits it with {1e-6 * hit['force_n']:.2f} MN")
    for row in breaking["slammed"][:_SLAMMED]:
        say(
            f"slam of {row['member']}, z = {row['z_msl_m']:.1f} m: {1e-3 * row['force_n_m']:.1f} kN/m as "
            f"water rises at {row['speed_m_s']:.2f} m/s"
        )


def _show_loads(title: str, loads: dict[str, Any]) -> None:
    rows = [
        {"load": f"{letter}{axis} [{unit}]", **row}
        for key, letter, unit in (("force_n", "F", "MN"), ("moment_msl_n_m", "M", "MN·m"))
        for axis, row in loads[key].items()
    ]
    numbers = (TableColumn(what, what, ",.4f", 1e-6) for what in ("max", "min", "mean", "std"))
    show_table(Table(title, (TableColumn("load", "load"), *numbers), rows))


def _show_still_water(still: dict[str, Any]) -> None:
    centre = still["center_of_buoyancy_m"]
    inside = still["water_inside_n"]
    filled = "flooding is not known" if inside is None else f"water inside weighs {1e-6 * inside:.3f} MN"
    at = "" if centre is None else f" at z = {centre[2]:.2f} m"
    say(
        f"still water, not in the loads above: buoyancy {1e-6 * still['buoyancy_n']:.3f} MN{at}, {filled}, "
        f"growth {1e-6 * still['growth_weight_n']:.3f} MN in air; "
        f"{1e-6 * still['pressure_at_the_bed_pa']:.3f} MPa at the bed"
    )


_PHASES = (
    TableColumn("phase [°]", "phase_deg", "g"),
    TableColumn("η [m]", "wave_elevation_m", ".2f"),
    TableColumn("Fx [MN]", lambda row: row["force_n"][0], ",.4f", 1e-6),
    TableColumn("Fy [MN]", lambda row: row["force_n"][1], ",.4f", 1e-6),
    TableColumn("Mx at the bed [MN·m]", lambda row: row["moment_mudline_n_m"][0], ",.4f", 1e-6),
    TableColumn("My at the bed [MN·m]", lambda row: row["moment_mudline_n_m"][1], ",.4f", 1e-6),
)
