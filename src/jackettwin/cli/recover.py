"""``jackettwin recover``: members and feet of a foundation from another program's interface motion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from jackettwin.caveats import omission_documents, omission_sentences
from jackettwin.cli.console import Reply, answers, numbers_of, say, say_all, show_table, working
from jackettwin.errors import require
from jackettwin.report import Table, TableColumn

_SHOWN = 12
"""Channels shown on the terminal."""


@click.command("recover")
@click.argument("scenario")
@click.argument("motion", type=click.Path(dir_okay=False, path_type=Path))
@click.option(
    "--out",
    required=True,
    type=click.Path(dir_okay=False, path_type=Path),
    help="Series of section forces and reactions: .parquet, or OpenFAST's .outb.",
)
@click.option(
    "--channel",
    "channels",
    multiple=True,
    metavar="MOTION=NAME",
    help="Channel of MOTION that is x, y, z, rx, ry or rz of the interface, for each of the six: Bladed's.",
)
@click.option("--members", metavar="NAME,…", help="Of which; default: those on the ground and the interface.")
@click.option(
    "--reference",
    metavar="X,Y,Z",
    help="Point that MOTION is of [m], in the structure's frame; default: the interface's centroid.",
)
@click.option(
    "--modes",
    "number",
    type=click.IntRange(1, 500),
    help="Internal coordinates of the foundation; default 120, or as many as it has.",
)
@answers
def recover_command(
    scenario: str,
    motion: Path,
    out: Path,
    channels: tuple[str, ...],
    members: str | None,
    reference: str | None,
    number: int | None,
) -> Reply:
    """Recover forces below the interface from its MOTION.

    SCENARIO has structure, support, and what acts below the interface: weight, water, waves. MOTION is
    OpenFAST's output (.out, .outb) with PtfmSurge … PtfmYaw or IntfTDXss … IntfRDZss, Bladed's (.%NN, with
    --channel), or a CSV.
    """
    from jackettwin.simulate import (
        FORCES_LEFT_OUT,
        read_interface_motion,
        read_scenario,
        recovered,
        write_force_series,
    )

    named = None if not channels else dict(_channel(text) for text in channels)
    chosen, moved = read_scenario(scenario), read_interface_motion(motion, named)
    names = () if members is None else tuple(name.strip() for name in members.split(","))
    point = None
    if reference is not None:
        x, y, z = numbers_of(reference, "--reference", "X,Y,Z", (3,))
        point = (x, y, z)
    with working(f"forces below the interface of {chosen.name}"):
        found = recovered(chosen, moved, names, reference_m=point, number=number)
        write_force_series(found.series, out)
    series = found.series
    document = {
        "scenario": chosen.name,
        "motion": str(motion),
        "out": str(out),
        "reference_m": found.element.reference_m,
        "coordinates": found.element.n,
        "step_s": series.step_s,
        "duration_s": series.step_s * (series.values.shape[1] - 1),
        "channels": [
            {"name": name, "max": float(row.max()), "min": float(row.min()), "std": float(row.std())}
            for name, row in zip(series.names, series.values, strict=True)
        ],
        "left_out": omission_documents(FORCES_LEFT_OUT),
    }
    return Reply(document, lambda: _show(document))


def _channel(text: str) -> tuple[str, str]:
    """Return motion and channel of ``x=NAME``."""
    motion, equals, name = text.partition("=")
    require(
        bool(equals and name.strip()), "is no MOTION=NAME", field="--channel", value=text, allowed="x=NAME"
    )
    return motion.strip(), name.strip()


def _show(document: dict[str, Any]) -> None:
    x, y, z = document["reference_m"]
    channels = document["channels"]
    largest = sorted(channels, key=lambda row: -row["std"])[:_SHOWN]
    columns = (TableColumn("channel", "name"), *(TableColumn(k, k, ".4g") for k in ("max", "min", "std")))
    show_table(Table(f"channels that vary most, {len(channels)} in all [N, N·m]", columns, largest))
    say(
        f"{document['out']}: {document['duration_s']:g} s, {document['coordinates']} coordinates, motion of "
        f"({x:g}, {y:g}, {z:g}) m"
    )
    say_all(omission_sentences(document["left_out"]), "left out")
