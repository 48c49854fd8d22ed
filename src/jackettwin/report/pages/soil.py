"""The page on the ground of a foundation: curves, head, capacity, pushover."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go

from jackettwin.report.figures import style
from jackettwin.report.pages.page import Block, PageSection, Plot, Text, write_page
from jackettwin.report.table import Table, TableColumn
from jackettwin.report.tables.numbers import quantity
from jackettwin.version import __version__

_SHOWN = 6
"""Number of depths whose curves are drawn."""
_NAMES = ("x", "y", "z", "rx", "ry", "rz")
_PUSHED = (
    TableColumn("load [MN]", "load_n", ".3f", 1e-6),
    TableColumn("head [mm]", "head_m", ".1f", 1e3),
    TableColumn("rotation [mrad]", "rotation_rad", ".2f", 1e3),
    TableColumn("largest moment [MN·m]", "largest_moment_nm", ".2f", 1e-6),
)
_ZERO = 1e-9
"""Entries below this share of the root of the product of their diagonal entries are rounding errors."""


def write_soil_page(document: Mapping[str, Any], path: Path) -> Path:
    """Write one self-contained HTML file from the document of ``jackettwin soil``; return its path.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    sections = [PageSection("Head", _head(document))]
    if document["curves"] is not None:
        sections.append(PageSection("Capacity", _capacity(document)))
        sections.append(PageSection("Curves", _curves(document["curves"])))
    if document["warnings"]:
        sections.append(PageSection("Warnings", (Text(tuple(document["warnings"]), "warnings"),)))
    pile = document["pile"]
    return write_page(
        sections,
        path,
        title=f"A pile of {document['foundation']}",
        subtitle=f"a pile {pile['length_m']:g} m long, {pile['outer_diameter_m']:g} m wide"
        f" · jackettwin {__version__}",
    )


def _head(document: Mapping[str, Any]) -> tuple[Block, ...]:
    """Return stiffness and loss of the pile head by matrix entry, without zero off-diagonal entries."""
    stiffness, loss = (np.asarray(document[key]) for key in ("head_stiffness", "head_loss"))
    own = np.sqrt(np.abs(np.diag(stiffness)))
    there = np.triu(np.abs(stiffness) > _ZERO * np.outer(own, own))
    rows = tuple(
        (
            f"{_NAMES[i]}, {_NAMES[j]}" if i != j else _NAMES[i],
            *(
                quantity(float(one[i, j]), ("N/m", "N", "N·m/rad")[int(i > 2) + int(j > 2)], digits=4)
                for one in (stiffness, loss)
            ),
        )
        for i, j in zip(*np.nonzero(there), strict=True)
    )
    caption = (
        f"Impedance of the pile head at {document['frequency_hz']:g} Hz, by matrix entry; the matrix is "
        "symmetric, and entries that are not listed are zero."
    )
    columns = ("entry", "stiffness (real part)", "loss (imaginary part)")
    return (Table(caption, columns, rows),)


def _capacity(document: Mapping[str, Any]) -> tuple[Block, ...]:
    capacity, pushed = document["capacity"], document["pushover"]
    rows = (
        ("compression", capacity["axial_compression_n"]),
        ("of the shaft", capacity["shaft_n"]),
        ("of the shaft inside, unplugged", capacity["inner_shaft_n"]),
        ("of the tip", capacity["tip_n"]),
        ("tension", capacity["axial_tension_n"]),
        (f"lateral, head moved by {capacity['lateral_displacement_limit_m']:.2f} m", capacity["lateral_n"]),
    )
    caption = f"How far does the head move? A lateral load {pushed['arm_m']:g} m above it, in steps."
    return (
        Table(
            "Which loads can the pile bear? Ultimate capacity.",
            ("", "[MN]"),
            tuple((name, f"{1e-6 * v:.2f}") for name, v in rows),
        ),
        Plot("pushover", caption, _pushover(pushed), fits=True),
        pushover_table(pushed, "The same in numbers."),
    )


def pushover_table(pushed: Mapping[str, Any], caption: str) -> Table:
    """Return the pushover, one row per step."""
    steps = zip(*(pushed[str(column.value)] for column in _PUSHED), strict=True)
    rows = [dict(zip((str(column.value) for column in _PUSHED), step, strict=True)) for step in steps]
    return Table(caption, _PUSHED, rows, text_columns=0, folded=True)


def _pushover(pushed: Mapping[str, Any]) -> go.Figure:
    figure = go.Figure()
    figure.add_scatter(
        x=1e3 * np.append(0.0, pushed["head_m"]),
        y=1e-6 * np.append(0.0, pushed["load_n"]),
        mode="lines+markers",
        line={"color": style.BLUE},
        name="lateral load",
    )
    figure.update_xaxes(title=style.title("displacement of the head", "mm"))
    figure.update_yaxes(title=style.title("load", "MN"))
    return style.finish(figure, height=360)


def _curves(curves: Mapping[str, Any]) -> tuple[Block, ...]:
    stations = curves["stations"]
    rows = tuple(
        (
            f"{one['depth_m']:.2f}",
            *(f"{1e-3 * one[key]['capacity']:.4g}" for key in ("py", "tz")),
            *(f"{1e-6 * one[key]['initial_stiffness']:.4g}" for key in ("py", "tz")),
        )
        for one in stations
    )
    return (
        Table(
            "Which curves are used?",
            ("reaction", "kind", "what it is"),
            tuple((one["reaction"].replace("_", ", "), one["name"], one["words"]) for one in curves["kinds"]),
            text_columns=3,
        ),
        Plot(
            "py",
            "How does the ground resist lateral displacement? p-y curves at some depths.",
            _drawn(stations, "py"),
            fits=True,
        ),
        Plot("tz", "And along the shaft? t-z curves.", _drawn(stations, "tz"), fits=True),
        Table(
            "Every station.",
            ("depth [m]", "p_u [kN/m]", "t_max [kN/m]", "p-y stiffness [MN/m²]", "t-z stiffness [MN/m²]"),
            rows,
            text_columns=0,
            folded=True,
        ),
        Table(
            "Tip: reaction against displacement.",
            ("z [mm]", "q [MN]"),
            tuple(
                (f"{1e3 * z:.2f}", f"{1e-6 * q:.3f}")
                for z, q in zip(curves["qz"]["y_m"], curves["qz"]["reaction"], strict=True)
            ),
            text_columns=0,
            folded=True,
        ),
    )


def _drawn(stations: list[Mapping[str, Any]], key: str) -> go.Figure:
    figure = go.Figure()
    some = stations[1 :: max(1, (len(stations) - 1) // _SHOWN)][:_SHOWN]
    colours = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE, style.SKY)
    for colour, one in zip(colours, some, strict=False):
        figure.add_scatter(
            x=1e3 * one[key]["y_m"],
            y=1e-3 * one[key]["reaction"],
            mode="lines",
            line={"color": colour},
            name=f"{one['depth_m']:.1f} m",
        )
    figure.update_xaxes(title=style.title("displacement", "mm"))
    figure.update_yaxes(title=style.title("reaction", "kN/m"))
    return style.finish(figure, height=420)
