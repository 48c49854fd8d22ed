"""The page on the ground of a foundation: curves, head, capacity, pushover."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.report import style
from jackettwin.report.page import Block, PageSection, PageTable, Plot, Text, write_page
from jackettwin.version import __version__

_SHOWN = 6
"""Depths whose curves are drawn."""
_NAMES = ("x", "y", "z", "rx", "ry", "rz")


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
        title=f"The ground of {document['foundation']}",
        subtitle=f"a pile {pile['length_m']:g} m long, {pile['outer_diameter_m']:g} m wide"
        f" · jackettwin {__version__}",
    )


def _head(document: Mapping[str, Any]) -> tuple[Block, ...]:
    f = document["frequency_hz"]
    return tuple(
        PageTable(
            f"{title} of the pile's head at {f:g} Hz [N/m, N, N·m/rad].",
            ("", *_NAMES),
            tuple(
                (name, *(f"{v:.4g}" for v in row))
                for name, row in zip(_NAMES, np.asarray(document[key]), strict=True)
            ),
        )
        for title, key in (
            ("Stiffness: the real part of the impedance", "head_stiffness"),
            ("Loss: its imaginary part", "head_loss"),
        )
    )


def _capacity(document: Mapping[str, Any]) -> tuple[Block, ...]:
    capacity, pushed = document["capacity"], document["pushover"]
    rows = (
        ("compression", capacity["axial_compression_n"]),
        ("of the shaft", capacity["shaft_n"]),
        ("of the tip", capacity["tip_n"]),
        ("tension", capacity["axial_tension_n"]),
        (f"lateral, head moved by {capacity['lateral_displacement_limit_m']:.2f} m", capacity["lateral_n"]),
    )
    columns = (pushed["load_n"], pushed["head_m"], pushed["rotation_rad"], pushed["largest_moment_nm"])
    table = tuple(
        (f"{1e-6 * load:.3f}", f"{1e3 * head:.1f}", f"{1e3 * turn:.2f}", f"{1e-6 * moment:.2f}")
        for load, head, turn, moment in zip(*columns, strict=True)
    )
    caption = f"A lateral load {pushed['arm_m']:g} m above the free head, step by step."
    return (
        PageTable("Ultimate loads.", ("", "[MN]"), tuple((name, f"{1e-6 * v:.2f}") for name, v in rows)),
        Plot("pushover", caption, _pushover(pushed)),
        PageTable(
            "The same in numbers.",
            ("load [MN]", "head [mm]", "rotation [mrad]", "largest moment [MN·m]"),
            table,
            text_columns=0,
            folded=True,
        ),
    )


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
        Plot("curves", "Reaction per metre of pile at some depths.", _drawn(stations)),
        PageTable(
            "Every station.",
            ("depth [m]", "p_u [kN/m]", "t_max [kN/m]", "p-y stiffness [MN/m²]", "t-z stiffness [MN/m²]"),
            rows,
            text_columns=0,
            folded=True,
        ),
        PageTable(
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


def _drawn(stations: list[Mapping[str, Any]]) -> go.Figure:
    figure = make_subplots(rows=1, cols=2, subplot_titles=("p-y", "t-z"))
    some = stations[1 :: max(1, (len(stations) - 1) // _SHOWN)][:_SHOWN]
    colours = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE, style.SKY)
    for colour, one in zip(colours, some, strict=False):
        for column, key in enumerate(("py", "tz"), start=1):
            figure.add_scatter(
                x=1e3 * one[key]["y_m"],
                y=1e-3 * one[key]["reaction"],
                mode="lines",
                line={"color": colour},
                name=f"{one['depth_m']:.1f} m",
                legendgroup=f"{one['depth_m']:.1f}",
                showlegend=column == 1,
                row=1,
                col=column,
            )
    figure.update_xaxes(title=style.title("displacement", "mm"))
    figure.update_yaxes(title=style.title("reaction", "kN/m"))
    return style.finish(figure, height=420)
