"""``jackettwin simulate``: record of a known asset under wind and waves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jackettwin.cli.console import Reply, answers, say, say_all, show_table, working
from jackettwin.cli.omissions import of_simulation
from jackettwin.errors import InputError
from jackettwin.report import Table, TableColumn, cell

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jackettwin.arrays import FloatArray
    from jackettwin.simulate import OperatingLevel, Simulation


DEFAULT_SCENARIO = "parked"

_NOTHING = 1e-9
"""Damping ratio below which a source is rounding error and not listed."""
_SHOWN = 12
"""Number of true modes shown on the terminal."""


@click.command("simulate")
@click.argument("scenario", default=DEFAULT_SCENARIO)
@click.option("--out", help="The record, NAME.json beside it; default out/NAME.parquet.")
@click.option(
    "--section-forces",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Write section forces and reactions as series: .parquet, or OpenFAST's .outb.",
)
@click.option("--members", metavar="NAME,…", help="Of which; default: those on the ground and the interface.")
@answers
def simulate_command(
    scenario: str, out: str | None, section_forces: Path | None, members: str | None
) -> Reply:
    """Simulate SCENARIO and write its record.

    SCENARIO is a shipped name or a YAML file.
    """
    from jackettwin.records import write_record
    from jackettwin.simulate import (
        force_series,
        operating_levels,
        read_scenario,
        rotor_notes,
        simulate,
        write_force_series,
    )
    from jackettwin.structure import assemble, check

    chosen = read_scenario(scenario)
    path = _record_path(out or f"out/{chosen.name}")
    with working(f"simulate {chosen.name}"):
        done = simulate(chosen)
    write_record(done.record, path)
    if section_forces is not None:
        names = () if members is None else tuple(name.strip() for name in members.split(","))
        with working(f"section forces of {chosen.name}"):
            write_force_series(force_series(chosen, names), section_forces)
    elif members is not None:
        raise InputError("needs --section-forces", field="--members", value=members, remedy="name its file")
    truth = done.record.metadata["true_modes"]
    at_work = operating_levels(chosen, {m["label"]: m["damping_ratio"] for m in truth})
    asset = chosen.asset
    odd = check(assemble(asset.structure)).warnings
    notes = [
        *rotor_notes(chosen.air, chosen.turbine),
        *asset.support.notes,
        *done.notes,
        *odd,
        *_operating_notes(at_work),
        *_unusual_shares(done, loops=asset.foundation is not None),
    ]

    def show() -> None:
        _show(done, path)
        say_all(notes, "note")

    forces = None if section_forces is None else str(section_forces)
    document = {**done.document(), "record": str(path), "section_forces": forces, "notes": notes}
    document["operating_levels"] = {side: level._asdict() for side, level in at_work.items()}
    return Reply({**document, "left_out": of_simulation(chosen)}, show)


def _operating_notes(levels: Mapping[str, OperatingLevel]) -> list[str]:
    """Return by which factor the first pair of an operating rotor is too loud or quiet, and its interval."""
    return [
        f"{side}_1 has ζ {100 * level.damping_ratio:.2f} % here, with rigid blades in a frozen wake, and "
        f"{100 * level.expected_damping_ratio:.2f} % with bending blades and a wake that lags (`operation`): "
        f"its level is about {level.ratio:.2f} times as large ({low:.2f} to {high:.2f} in 90 %)"
        for side, level in levels.items()
        for low, high in (level.ratio_interval_90,)
    ]


def _unusual_shares(done: Simulation, *, loops: bool) -> list[str]:
    """Return the sources whose damping of the first bending modes is outside the literature's range.

    The damping of a ground with ``loops`` grows with the motion and is not in the linear modes.
    """
    from jackettwin.updating import beyond_literature

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


def _show(done: Simulation, path: Path) -> None:
    speed = done.seconds_simulated / done.wall_s
    say(
        f"{path}: {done.seconds_simulated:g} s simulated in {done.wall_s:.2f} s ({speed:.0f} times real time)"
    )
    channels = zip(done.record.channels, done.record.data, strict=True)
    rows = [(c.name, c.unit, *(cell(v, ".4g") for v in _sizes(y))) for c, y in channels]
    show_table(Table("", ("channel", "unit", "rms", "largest"), rows))
    modes = done.record.metadata["true_modes"]
    show_table(Table("", _MODES, modes[:_SHOWN]))
    if len(modes) > _SHOWN:
        say(f"and {len(modes) - _SHOWN} more up to {modes[-1]['frequency_hz']:.2f} Hz, in the record's JSON")
    if decay := done.record.metadata["decrement"]:
        say(_decay(decay))
    levels = done.record.metadata["levels"]
    beyond = done.record.metadata["levels_beyond_comparison"] if levels else ()
    if levels:
        show_table(Table("acceleration at the tower top, in wind of the same class", _LEVELS, levels))
    if beyond:
        say(f"levels have not been compared with OpenFAST's for this case: {'; '.join(beyond)}")
    elif levels:
        say("times OpenFAST's: the mean of seven records in this state (docs/verification/response_level.md)")


def _decay(decay: dict[str, Any]) -> str:
    """Return the logarithmic decrement with the pole that contributes most to the decay."""
    measured = f"ζ {100 * decay['damping_ratio']:.3f} % (peaks scatter by {100 * decay['scatter']:.2g} %)"
    pole = f"{100 * decay['pole_damping_ratio']:.3f} % at {decay['pole_frequency_hz']:.4f} Hz"
    return (
        f"release of {decay['node']}: logarithmic decrement {decay['logarithmic_decrement']:.4g} over "
        f"{decay['cycles']} cycles at {decay['frequency_hz']:.4f} Hz, {measured}; the pole with "
        f"{100 * decay['pole_share']:.0f} % of the displacement has {pole}"
    )


def _sizes(y: FloatArray) -> tuple[float, float]:
    """Return root mean square and largest magnitude of a channel's finite samples."""
    known = y[y == y]
    return float((known**2).mean() ** 0.5), float(abs(known).max())


_MODES = (
    TableColumn("true mode", "label"),
    TableColumn("f [Hz]", "frequency_hz", ".4f"),
    TableColumn("ζ [%]", "damping_ratio", ".2f", 100.0),
)
_LEVELS = (
    TableColumn(
        "band", lambda level: f"{level['band']}, {' to '.join(f'{f:.2f}' for f in level['limits_hz'])} Hz"
    ),
    TableColumn("direction", "direction"),
    TableColumn("rms here [cm/s²]", "rms_m_s2", ".2f", 100.0),
    TableColumn("times OpenFAST's", "ratio_to_openfast", ".2f"),
    TableColumn("90 %", lambda level: " to ".join(f"{v:.2f}" for v in level["ratio_interval_90"] or ())),
)
