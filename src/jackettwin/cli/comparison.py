"""Comparison of mode shapes with another program's, for ``modes`` and ``stages``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jackettwin.axes import DOFS_PER_NODE
from jackettwin.cli.console import say, show_table
from jackettwin.errors import located, require
from jackettwin.report import Table, TableColumn

if TYPE_CHECKING:
    from jackettwin.response import ModeComparison, System, UndampedModes


def is_table(name: str) -> bool:
    """Return whether a name is that of a table of modes."""
    return name.lower().endswith((".csv", ".txt"))


def require_shapes(shapes: Mapping[str, ModeComparison], figure: Path) -> None:
    """Raise an error if a page of shapes is requested but none can be compared."""
    require(
        shapes,
        "there are no shapes to compare",
        field="--figure",
        value=str(figure),
        remedy="give --against FILE.csv, or a structure with the same nodes",
    )


def comparison_of(
    system: System, number: int, *, shapes: Path | None, against: Path | None, figure: Path | None
) -> dict[str, Any]:
    """Return the document's part on shapes; write the requested table of undamped modes and page.

    Raises
    ------
    InputError
        If the table of the other program's modes cannot be read or is of other nodes.
    """
    from jackettwin.decks import write_modes
    from jackettwin.report.pages.comparison import write_comparison
    from jackettwin.response import nodal_modes

    document: dict[str, Any] = {"shapes": None, "shapes_file": None, "page": None}
    require(figure is None or against is not None, "needs --against", field="--figure", value=str(figure))
    if shapes is None and against is None:
        return document
    if shapes is not None:
        own = nodal_modes(system.assembly, _own_modes(system, number))
        document["shapes_file"] = str(write_modes([("", own)], shapes))
    if against is not None:
        found = compared_with(system, number, against)
        document["shapes"] = comparison_document(found)
        if figure is not None:
            name = system.assembly.structure.name
            stages = [("modes", system.assembly, found)]
            names = ("jackettwin", against.stem)
            document["page"] = str(write_comparison(stages, figure, title=name, names=names))
    return document


def compared_with(system: System, number: int, against: Path) -> ModeComparison:
    """Return the comparison of the lowest modes with another program's table.

    Raises
    ------
    InputError
        If the table cannot be read, has several stages, or is of other nodes.
    """
    from jackettwin.decks import read_modes
    from jackettwin.response import compare_modes

    tables = read_modes(against)
    require(
        len(tables) == 1,
        "the table has several stages",
        file=against,
        field="stage",
        value=sorted(tables),
        remedy="give it to `jackettwin stages --against`",
    )
    with located(file=against):
        return compare_modes(system.assembly, _own_modes(system, number), next(iter(tables.values())))


def _own_modes(system: System, number: int) -> UndampedModes:
    """Return the lowest undamped modes without rigid-body motions."""
    from jackettwin.response import UndampedModes, undamped_modes

    every = undamped_modes(system, number + DOFS_PER_NODE)
    kept = slice(every.n_at_rest, every.n_at_rest + number)
    return UndampedModes(every.omega[kept], every.shapes[:, kept])


def comparison_document(found: ModeComparison | None) -> dict[str, Any] | None:
    """Return a comparison as plain data."""
    if found is None:
        return None
    return {
        "nodes": len(found.other.nodes),
        "unknown_nodes": list(found.unknown),
        "mac": found.mac.tolist(),
        "pairs": [
            {
                "mode": pair.own + 1,
                "frequency_hz": float(found.own.frequency_hz[pair.own]),
                "other_mode": pair.other + 1,
                "other_frequency_hz": float(found.other.frequency_hz[pair.other]),
                "relative_error": float(
                    found.own.frequency_hz[pair.own] / found.other.frequency_hz[pair.other] - 1.0
                ),
                "mac": pair.mac,
                "rotations_mac": pair.rotations_mac,
            }
            for pair in found.pairs
        ],
    }


def show_comparison(document: dict[str, Any] | None) -> None:
    """Print the pairs of modes of both programs and their agreement."""
    if document is None:
        return
    show_table(Table(f"shapes at {document['nodes']} nodes", _COLUMNS, document["pairs"]))
    lost = len(document["mac"]) - len(document["pairs"])
    if lost:
        say(f"{lost} modes resemble none of the other program's (MAC below 0.5)")
    if document["unknown_nodes"]:
        say(f"{len(document['unknown_nodes'])} of its nodes are not in this structure and are ignored")


_COLUMNS = (
    TableColumn("mode", "mode"),
    TableColumn("f [Hz]", "frequency_hz", ".4f"),
    TableColumn("theirs", "other_mode"),
    TableColumn("f [Hz]", "other_frequency_hz", ".4f"),
    TableColumn("difference [%]", "relative_error", ".3f", 100.0),
    TableColumn("MAC", "mac", ".4f"),
    TableColumn("MAC of rotations", "rotations_mac", ".4f"),
)
