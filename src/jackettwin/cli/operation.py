"""``jackettwin operation``: damping, thrust and excitation by a rotor in operation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jackettwin.caveats import omission_documents, omission_sentences
from jackettwin.cli.console import FiniteFloat, Reply, answers, numbers_of, say_all, show_table, working
from jackettwin.cli.modes import rayleigh_option, supported_option
from jackettwin.errors import InputError, located
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.loads import Control, Rotor

_SPEEDS = "4,6,8,10,12,14,16,18,20,22,24"
_NEAR = 0.1
"""Relative distance to the blade-passing frequency within which a natural frequency is excited."""


@click.command("operation")
@click.argument("structure")
@click.option("--support", help="As for `jackettwin modes`; default: the structure's own.")
@click.option("--rotor", default="iea15", show_default=True, help="A shipped turbine, or a windIO file.")
@click.option(
    "--schedule",
    type=click.Path(dir_okay=False, path_type=Path),
    help="CSV of wind_speed_m_s, rotor_speed_rpm, pitch_deg; default: the windIO file's controller.",
)
@click.option(
    "--wind", default=_SPEEDS, show_default=True, metavar="V,V,…", help="Mean wind speeds at the hub [m/s]."
)
@click.option(
    "--turbulence",
    default="B",
    show_default=True,
    help="Turbulence class A+, A, B or C, an intensity, or none.",
)
@click.option(
    "--shear",
    default=0.14,
    show_default=True,
    type=FiniteFloat(0.0, 1.0),
    help="Exponent of the power law of wind shear.",
)
@click.option(
    "--seed",
    default=0,
    show_default=True,
    type=click.IntRange(0),
    help="Seed of the ten minutes of turbulence.",
)
@click.option(
    "--shaft",
    default="free",
    show_default=True,
    type=click.Choice(("free", "locked")),
    help="Generator with constant torque (free), or constant speed relative to the nacelle (locked).",
)
@click.option("--rayleigh", metavar="ZETA,F_HZ", help="Steel damping, as for `jackettwin modes`.")
@answers
def operation_command(
    structure: str,
    support: str | None,
    rotor: str,
    schedule: Path | None,
    wind: str,
    turbulence: str,
    shear: float,
    seed: int,
    shaft: str,
    rayleigh: str | None,
) -> Reply:
    """Compute damping and excitation by a rotor in operation.

    Pitch and speed are constant at the schedule's values.
    """
    from jackettwin.decks import read_structure
    from jackettwin.loads import Wind, read_rotor, read_schedule
    from jackettwin.simulate import LEFT_OUT, Asset, asset_model, operating_asset, operating_row
    from jackettwin.structure import assemble

    speeds = _speeds(wind)
    intensity = _turbulence(turbulence)
    machine, control = read_rotor(rotor)
    if schedule is not None:
        control = replace(control, schedule=read_schedule(schedule))
    steel = rayleigh_option(rayleigh)
    stands, held = supported_option(support, assemble(read_structure(structure)), None)
    asset = Asset(stands, held, rayleigh=steel)
    model = asset_model(asset)
    hub = stands.nodes[stands.top_node][2] - stands.sea_level_z_m + machine.hub_height
    rows = []
    for speed in speeds:
        with working(f"the rotor in operation at {speed:g} m/s"), located(field="--wind"):
            found = operating_asset(
                asset,
                machine,
                control,
                Wind(speed, hub, intensity, shear),
                shaft=shaft,
                seed=None if intensity == 0.0 else seed,
                model=model,
            )
        rows.append(operating_row(found, blades=machine.n_blades))
    document = {
        "structure": stands.name,
        "rotor": rotor,
        "shaft": shaft,
        "hub_height_m": hub,
        "winds": rows,
        "warnings": [*_rigid(machine), *_warnings(rows, control)],
        "left_out": omission_documents(LEFT_OUT),
    }
    return Reply(document, lambda: _show(document))


def _speeds(text: str) -> tuple[float, ...]:
    """Return the wind speeds [m/s]."""
    found = numbers_of(text, "--wind", "V,V,…", tuple(range(1, 101)))
    for speed in found:
        if not 0.0 < speed <= 100.0:
            raise InputError("out of range", field="--wind", value=speed, allowed="above 0, to 100 m/s")
    return found


def _turbulence(text: str) -> str | float:
    """Return a class, or an intensity; no turbulence is 0."""
    if text == "none":
        return 0.0
    try:
        intensity = float(text)
    except ValueError:
        return text
    if not 0.0 <= intensity <= 1.0:
        raise InputError(
            "out of range", field="--turbulence", value=text, allowed="0 to 1, A+, A, B, C, none"
        )
    return intensity


def _rigid(machine: Rotor) -> list[str]:
    """Return that the blades are taken as rigid, where their file leaves no choice."""
    if machine.bending is not None:
        return []
    return ["blades are rigid and no gyroscope: the rotor's file has no usable mass and stiffness of them"]


def _warnings(rows: list[dict[str, Any]], control: Control) -> list[str]:
    """Return winds beyond cut-in and cut-out, modes near the blades' passing, and modes that grow."""
    found = []
    limits = control.wind_speeds_m_s
    for row in rows:
        speed = row["wind_speed_m_s"]
        if limits is not None and not limits[0] <= speed <= limits[1]:
            found.append(f"{speed:g} m/s is beyond cut-in and cut-out, {limits[0]:g} and {limits[1]:g} m/s")
        for mode in row["modes"]:
            if abs(mode["frequency_hz"] / row["passing_hz"] - 1.0) <= _NEAR:
                found.append(
                    f"{speed:g} m/s: {mode['label']}, {mode['frequency_hz']:.3f} Hz, lies within "
                    f"{_NEAR:.0%} of the blades' passing, {row['passing_hz']:.3f} Hz"
                )
            if mode["damping_ratio"] <= 0.0:
                found.append(f"{speed:g} m/s: {mode['label']} is not damped: its motion would grow")
    return found


def _show(document: dict[str, Any]) -> None:
    rows = []
    for row in document["winds"]:
        shown = {key: row[key] for key in ("wind_speed_m_s", "rotor_speed_rpm", "pitch_deg", "passing_hz")}
        shown["thrust"] = row["thrust_n"]
        for side in ("fore_aft", "side_side"):
            part = row[side]
            shown[side] = None if part is None else part["damping_ratio"]
            shown[f"{side} rotor"] = None if part is None else part["rotor_damping_ratio"]
        shown["passing"] = row["passing"][0]["x_n"]
        shown["gusts"] = None if row["turbulent"] is None else row["turbulent"]["whole"]["x_n"]
        rows.append(shown)
    title = f"{document['structure']}, {document['rotor']} in operation, shaft {document['shaft']}"
    columns = (
        TableColumn("wind [m/s]", "wind_speed_m_s", "g"),
        TableColumn("rotor [rpm]", "rotor_speed_rpm", ".2f"),
        TableColumn("pitch [°]", "pitch_deg", ".2f"),
        TableColumn("thrust [MN]", "thrust", ".3f", 1e-6),
        TableColumn("ζ fore-aft [%]", "fore_aft", ".2f", 100.0),
        TableColumn("rotor's", "fore_aft rotor", ".2f", 100.0),
        TableColumn("ζ side-side [%]", "side_side", ".2f", 100.0),
        TableColumn("rotor's", "side_side rotor", ".2f", 100.0),
        TableColumn("blades pass [Hz]", "passing_hz", ".3f"),
        TableColumn("thrust there [kN]", "passing", ".1f", 1e-3),
        TableColumn("σ thrust [MN]", "gusts", ".3f", 1e-6),
    )
    show_table(Table(title, columns, rows))
    say_all(document["warnings"], "warning")
    say_all(omission_sentences(document["left_out"]), "left out")
