"""``jackettwin simulate``: the record of a known asset under wind and waves."""

from __future__ import annotations

from pathlib import Path

import click
from rich.table import Table

from jackettwin.cli.console import output, print_json, working
from jackettwin.errors import InputError
from jackettwin.records import write_record
from jackettwin.simulate import Simulation, read_scenario, rotor_notes, simulate
from jackettwin.structure import assemble, check
from jackettwin.updating import beyond_literature

DEFAULT_SCENARIO = "parked"

_NOTHING = 1e-9
"""A damping ratio that is rounding: there is no such source."""
_SHOWN = 12
"""True modes in the terminal."""


@click.command("simulate")
@click.argument("scenario", default=DEFAULT_SCENARIO)
@click.option("--out", help="The record, NAME.json beside it; default out/NAME.parquet.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def simulate_command(scenario: str, out: str | None, as_json: bool) -> None:
    """Simulate SCENARIO, a shipped name or a YAML file, and write its record."""
    chosen = read_scenario(scenario)
    path = _record_path(out or f"out/{chosen.name}")
    with working(f"simulate {chosen.name}"):
        done = simulate(chosen)
    write_record(done.record, path)
    asset = chosen.asset
    odd = check(assemble(asset.structure)).warnings
    notes = [
        *rotor_notes(chosen.air, chosen.turbine),
        *asset.support.notes,
        *odd,
        *_unusual_shares(done, loops=asset.foundation is not None),
    ]
    if as_json:
        print_json({**done.document(), "record": str(path), "notes": notes})
    else:
        _print(done, path)
        for note in notes:
            output.print(f"note: {note}")


def _unusual_shares(done: Simulation, *, loops: bool) -> list[str]:
    """Return which of the sources there are damp the first bending modes beyond the literature's range.

    The damping of a ground with ``loops`` grows with the motion: the linear modes know nothing of it.
    """
    return [
        note
        for mode in done.record.metadata["true_modes"]
        for note in beyond_literature(
            mode["label"],
            {
                name: zeta
                for name, zeta in mode["damping_by_source"].items()
                if zeta > _NOTHING and not (loops and name == "soil")
            },
        )
    ]


def _record_path(out: str) -> Path:
    path = Path(out)
    if path.is_dir():
        raise InputError("is a folder", field="--out", value=out, remedy="name a file, e.g. record.parquet")
    return path if path.suffix else path.with_suffix(".parquet")


def _print(done: Simulation, path: Path) -> None:
    speed = done.seconds_simulated / done.wall_s
    output.print(
        f"{path}: {done.seconds_simulated:g} s simulated in {done.wall_s:.2f} s ({speed:.0f} times real time)"
    )
    table = Table("channel", "unit", "rms", "largest")
    for channel, row in zip(done.record.channels, done.record.data, strict=True):
        known = row[row == row]
        rms = float((known**2).mean() ** 0.5)
        table.add_row(channel.name, channel.unit, f"{rms:.4g}", f"{abs(known).max():.4g}")
    output.print(table)
    truth = Table("true mode", "f [Hz]", "ζ [%]")
    modes = done.record.metadata["true_modes"]
    for mode in modes[:_SHOWN]:
        truth.add_row(mode["label"], f"{mode['frequency_hz']:.4f}", f"{100.0 * mode['damping_ratio']:.2f}")
    output.print(truth)
    if len(modes) > _SHOWN:
        last = modes[-1]["frequency_hz"]
        output.print(f"and {len(modes) - _SHOWN} more up to {last:.2f} Hz, in the record's JSON")
    _print_levels(done)


def _print_levels(done: Simulation) -> None:
    found = done.record.metadata["levels"]
    if not found:
        return
    table = Table(
        "band", "direction", r"rms here \[cm/s²]", "OpenFAST, nine records of ten", title_justify="left"
    )
    table.title = "acceleration at the tower top, in wind of the same class"
    for level in found:
        low, high = level["limits_hz"]
        there = " to ".join(f"{100.0 * value:.2f}" for value in level["openfast_m_s2"])
        band = f"{level['band']}, {low:.2f} to {high:.2f} Hz"
        table.add_row(band, level["direction"], f"{100.0 * level['rms_m_s2']:.2f}", there)
    output.print(table)
    beyond = done.record.metadata["levels_beyond_comparison"]
    if beyond:
        output.print(f"OpenFAST's levels were not compared in such a case: {'; '.join(beyond)}")
