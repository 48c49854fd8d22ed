"""Structures in elevation, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go

from gallery.structure_3d import MUD, segments
from jackettwin.report.figures import style
from jackettwin.report.view.page import member_text
from jackettwin.structure import Assembly


def elevation(
    assemblies: Sequence[tuple[str, Assembly]], *, plane: str = "x", notes: bool = False
) -> go.Figure:
    """Draw structures side by side in the plane of ``plane`` and z, the nacelle as a larger node."""
    axis = "xyz".index(plane)
    figure = go.Figure()
    layout: dict[str, Any] = {}
    n = len(assemblies)
    for i, (name, assembly) in enumerate(assemblies):
        sea = assembly.structure.sea_level_z_m
        points = assembly.mesh.coordinates - [0.0, 0.0, sea]
        lines = segments(assembly, points)
        suffix = str(i + 1) if i else ""
        axes = {"xaxis": f"x{suffix}", "yaxis": f"y{suffix}"}
        figure.add_scatter(
            x=lines[:, axis],
            y=lines[:, 2],
            mode="lines",
            line={"color": style.INK, "width": 1.3},
            text=np.repeat(member_text(assembly), 3),
            hovertemplate="%{text}<extra></extra>",
            showlegend=False,
            **axes,
        )
        for mass in assembly.structure.masses:
            at = np.subtract(assembly.structure.nodes[mass.node], [0.0, 0.0, sea])
            figure.add_scatter(
                x=[at[axis]],
                y=[at[2]],
                mode="markers",
                marker={"size": 14, "color": style.VERMILLION},
                hovertemplate=f"point mass {mass.mass_kg / 1e3:.0f} t<extra></extra>",
                showlegend=False,
                **axes,
            )
        gap = 0.06
        width = (1.0 - gap * (n - 1)) / n
        layout[f"xaxis{suffix}"] = {
            "title": {"text": style.title(plane, "m")},
            "domain": [i * (width + gap), i * (width + gap) + width],
            "anchor": f"y{suffix}",
            "range": [-45, 45],
            "constrain": "domain",
        }
        layout[f"yaxis{suffix}"] = {
            "title": {"text": style.title("height above sea level", "m") if i == 0 else ""},
            "scaleanchor": f"x{suffix}",
            "anchor": f"x{suffix}",
            "range": [-sea - 8, 160],
            "showticklabels": i == 0,
        }
        for level, colour in ((0.0, style.BLUE), (float(points[:, 2].min()), MUD)):
            figure.add_shape(
                type="line",
                x0=-45,
                x1=45,
                y0=level,
                y1=level,
                xref=f"x{suffix}",
                yref=f"y{suffix}",
                line={"color": colour, "width": 1.2, "dash": "dash"},
                layer="below",
            )
        if name:
            figure.add_annotation(
                text=name,
                x=0.0,
                y=158,
                xref=f"x{suffix}",
                yref=f"y{suffix}",
                showarrow=False,
                yanchor="bottom",
            )
        if notes:
            _name_parts(figure, assembly, suffix)
    return style.finish(figure, height=680, **layout)


def _name_parts(figure: go.Figure, assembly: Assembly, suffix: str) -> None:
    sea = assembly.structure.sea_level_z_m
    texts = [("sea level", 0.0), ("mud line", -sea)]
    for part in dict.fromkeys(m.part for m in assembly.structure.members):
        z = [
            assembly.structure.nodes[n][2] - sea
            for m in assembly.structure.members
            if m.part == part
            for n in (m.start, m.end)
        ]
        texts.append((part.replace("_", " "), 0.5 * (min(z) + max(z)) if part != "jacket" else -0.35 * sea))
    texts += [
        ("rotor–nacelle assembly", assembly.structure.nodes[m.node][2] - sea)
        for m in assembly.structure.masses
    ]
    for text, level in texts:
        figure.add_annotation(
            text=text,
            x=1.05,
            y=level,
            xref=f"x{suffix} domain",
            yref=f"y{suffix}",
            showarrow=False,
            xanchor="left",
            font={"size": 13},
        )
