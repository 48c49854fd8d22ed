"""The structure in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go

from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.report.view.page import member_text
from jackettwin.response.sensors import Sensor, sensor_positions
from jackettwin.structure import Assembly

QUANTITIES = ("wall thickness", "outer diameter", "Young's modulus", "density")
_UNITS = {
    "wall thickness": ("mm", 1e3),
    "outer diameter": ("m", 1.0),
    "Young's modulus": ("GPa", 1e-9),
    "density": ("kg/m³", 1.0),
}
MUD = "#8B5A2B"


def structure_3d(
    assembly: Assembly, sensors: Sequence[Sensor] = (), *, colour: str = "wall thickness"
) -> go.Figure:
    """Draw members coloured by a quantity of ``QUANTITIES``, sensors, masses, mud line and sea level."""
    sea = assembly.structure.sea_level_z_m
    points = assembly.mesh.coordinates - [0.0, 0.0, sea]
    lines = segments(assembly, points)
    values = {name: np.repeat(np.log10(_member_values(assembly, name)), 3) for name in QUANTITIES}
    bars = {name: _colour_bar(assembly, name) for name in QUANTITIES}
    member = go.Scatter3d(
        x=lines[:, 0],
        y=lines[:, 1],
        z=lines[:, 2],
        mode="lines",
        name="members",
        showlegend=False,
        line={"color": values[colour], "width": 6, "coloraxis": "coloraxis"},
        text=np.repeat(member_text(assembly), 3),
        hovertemplate="%{text}<extra></extra>",
    )
    others = [_masses(assembly), *_sensor_traces(assembly, sensors), *_levels(assembly, points)]
    figure = go.Figure([member, *others])
    buttons = [
        {
            "label": name,
            "method": "update",
            "args": [
                {"line.color": [values[name]]},
                {f"coloraxis.{key}": value for key, value in bars[name].items()},
                [0],
            ],
        }
        for name in QUANTITIES
    ]
    return style.finish(
        figure,
        height=780,
        scene=scene_of(points, ticks=True),
        coloraxis={
            "colorscale": "Cividis",
            "colorbar": {"title": {"side": "right"}, "len": 0.6, "thickness": 16},
        },
        updatemenus=[
            {
                "type": "buttons",
                "direction": "right",
                "buttons": buttons,
                "active": QUANTITIES.index(colour),
                "x": 0.0,
                "xanchor": "left",
                "y": 1.0,
                "yanchor": "bottom",
                "pad": {"b": 6},
                "font": {"size": 12},
            }
        ],
        legend={"orientation": "h", "x": 0.0, "y": -0.02, "yanchor": "top"},
        margin={"l": 0, "r": 0, "t": 44, "b": 44},
    ).update_layout({f"coloraxis_{key.replace('.', '_')}": value for key, value in bars[colour].items()})


def segments(assembly: Assembly, points: FloatArray) -> FloatArray:
    """Return (3·n_elements, 3): start, end and a gap of every element."""
    mesh = assembly.mesh
    gap = np.full((mesh.start.size, 3), np.nan)
    return np.stack([points[mesh.start], points[mesh.end], gap], axis=1).reshape(-1, 3).astype(np.float32)


def scene_of(points: FloatArray, *, ticks: bool) -> dict[str, Any]:
    """Return a scene with equal axes around points (n, 3), seen from the side without perspective."""
    low, high = points.min(axis=0), points.max(axis=0)
    pad = 0.12 * float(np.ptp(points[:, 2]))
    below, above = np.array([pad, pad, 0.2 * pad]), np.array([pad, pad, 0.6 * pad])
    ranges = [[float(a), float(b)] for a, b in zip(low - below, high + above, strict=True)]
    spans = np.array([b - a for a, b in ranges])
    names = (
        style.title("x", "m"),
        style.title("y", "m"),
        style.title("height above sea level", "m"),
    )
    axes = {
        f"{letter}axis": {
            "title": {"text": name, "font": {"size": 12}},
            "range": r,
            "visible": ticks,
            "tickfont": {"size": 11},
        }
        for letter, name, r in zip("xyz", names, ranges, strict=True)
    }
    ratio = dict(zip("xyz", spans / spans[2] * 1.65, strict=True))
    return {
        **axes,
        "aspectmode": "manual",  # equal axes: the ratios are those of the ranges
        "aspectratio": ratio,
        "camera": {"projection": {"type": "orthographic"}, "eye": {"x": 1.1, "y": -1.5, "z": 0.45}},
    }


def _member_values(assembly: Assembly, name: str) -> FloatArray:
    """Return the value of a quantity for every element."""
    mesh, members = assembly.mesh, assembly.structure.members
    factor = _UNITS[name][1]
    if name == "Young's modulus":
        return np.asarray(mesh.properties.E * factor)
    if name == "density":
        return np.asarray(mesh.properties.rho * factor)
    attribute = "thickness_m" if name == "wall thickness" else "outer_diameter_m"
    mean = [0.5 * (getattr(m.section_start, attribute) + getattr(m.section_end, attribute)) for m in members]
    return np.array(mean)[mesh.member] * factor


def _colour_bar(assembly: Assembly, name: str) -> dict[str, Any]:
    """Return the properties of a colour axis over log₁₀ of a quantity: walls span decades."""
    values = _member_values(assembly, name)
    low, high = float(values.min()), float(values.max())
    ticks = np.geomspace(low, high, 5) if high > 1.001 * low else np.array([low])
    margin = 0.01 if ticks.size == 1 else 0.0
    return {
        "cmin": float(np.log10(low)) - margin,
        "cmax": float(np.log10(high)) + margin,
        "colorbar.title.text": style.title(name, _UNITS[name][0]),
        "colorbar.tickvals": np.log10(ticks).tolist(),
        "colorbar.ticktext": [f"{tick:.3g}" if tick < 1000 else f"{tick:.0f}" for tick in ticks],
    }


def _masses(assembly: Assembly) -> go.Scatter3d:
    structure = assembly.structure
    at = np.array(
        [np.subtract(structure.nodes[m.node], [0, 0, structure.sea_level_z_m]) for m in structure.masses]
    ).reshape(-1, 3)
    return go.Scatter3d(
        x=at[:, 0],
        y=at[:, 1],
        z=at[:, 2],
        mode="markers",
        name="point mass",
        marker={"size": 9, "color": style.INK},
        showlegend=len(at) > 0,
        text=[f"{m.node}: {m.mass_kg / 1e3:.1f} t" for m in structure.masses],
        hovertemplate="%{text}<extra></extra>",
    )


def _sensor_traces(assembly: Assembly, sensors: Sequence[Sensor]) -> list[go.Scatter3d]:
    if not sensors:
        return []
    at = sensor_positions(assembly, sensors)
    reach = 0.06 * float(np.ptp(assembly.mesh.coordinates[:, 2]))
    directions = np.array([np.asarray(s.direction) / np.linalg.norm(s.direction) for s in sensors])
    lines = np.stack([at, at + reach * directions, np.full_like(at, np.nan)], axis=1).reshape(-1, 3)
    return [
        go.Scatter3d(
            x=lines[:, 0],
            y=lines[:, 1],
            z=lines[:, 2],
            mode="lines+markers",
            name="sensor and its direction",
            line={"color": style.VERMILLION, "width": 5},
            marker={
                "size": np.tile([5.0, 3.0, 0.0], len(sensors)),
                "color": style.VERMILLION,
                "symbol": ["square", "diamond", "square"] * len(sensors),
            },
            text=np.repeat([s.channel for s in sensors], 3),
            hovertemplate="%{text}<extra></extra>",
        )
    ]


def _levels(assembly: Assembly, points: FloatArray) -> list[go.Scatter3d]:
    reach = 0.12 * float(np.ptp(points[:, 2]))
    (x0, y0, bottom), (x1, y1, _) = points.min(axis=0), points.max(axis=0)
    x = [x0 - reach, x1 + reach, x1 + reach, x0 - reach, x0 - reach]
    y = [y0 - reach, y0 - reach, y1 + reach, y1 + reach, y0 - reach]
    return [
        go.Scatter3d(
            x=x,
            y=y,
            z=[z] * 5,
            mode="lines",
            name=name,
            surfaceaxis=2,
            surfacecolor=style.rgba(colour, 0.12),
            line={"color": colour, "width": 3, "dash": dash},
            hovertemplate=f"{name}<extra></extra>",
        )
        for name, z, colour, dash in (
            ("sea level", 0.0, style.BLUE, "solid"),
            ("mud line", float(bottom), MUD, "dash"),
        )
        if bottom < 0.0 or name == "mud line"
    ]
