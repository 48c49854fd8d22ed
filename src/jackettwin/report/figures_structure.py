"""The structure and its mode shapes, in space and in elevation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from jackettwin.report import style
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure import Assembly

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

QUANTITIES = ("wall thickness", "outer diameter", "Young's modulus", "density")
_UNITS = {
    "wall thickness": ("mm", 1e3),
    "outer diameter": ("m", 1.0),
    "Young's modulus": ("GPa", 1e-9),
    "density": ("kg/m³", 1.0),
}
_FRAMES = 24
_SWAY = 0.10
"""Largest drawn displacement of a mode shape, as a share of the structure's height."""


@dataclass(frozen=True)
class Shape:
    """A mode to draw.

    Attributes
    ----------
    title : str
    label : str
        ``fore_aft_1`` …; sets the colour.
    damped : (assembly.n_dof,) complex
    undamped : (assembly.n_dof,) or None
        Drawn dotted at its largest.
    measured : (n_sensors,) complex or None
        Drawn as arrows at the sensors, scaled to the damped shape.
    """

    title: str
    label: str
    damped: ComplexArray
    undamped: FloatArray | None = None
    measured: ComplexArray | None = None


def structure_3d(
    assembly: Assembly, sensors: Sequence[Sensor] = (), *, colour: str = "wall thickness"
) -> go.Figure:
    """Draw members coloured by a quantity of ``QUANTITIES``, sensors, masses, mud line and sea level."""
    sea = assembly.structure.sea_level_z_m
    points = assembly.mesh.coordinates - [0.0, 0.0, sea]
    lines = _segments(assembly, points)
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
        text=np.repeat(_member_text(assembly), 3),
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
        scene=_scene(points, ticks=True),
        coloraxis={
            "colorscale": style.SCALE,
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


def mode_shapes_3d(assembly: Assembly, shapes: Sequence[Shape], sensors: Sequence[Sensor] = ()) -> go.Figure:
    """Draw modes side by side, each turning through one cycle of Re(φ e^{iθ}), θ by button or slider."""
    sea = assembly.structure.sea_level_z_m
    points = assembly.mesh.coordinates - [0.0, 0.0, sea]
    height = float(np.ptp(points[:, 2]))
    H = observation_matrix(assembly, tuple(sensors))
    places = sensor_points(assembly, sensors)
    drawn = [_Drawn.of(assembly, shape, H, _SWAY * height) for shape in shapes]
    figure = go.Figure()
    for i, (shape, motion) in enumerate(zip(shapes, drawn, strict=True)):
        scene = f"scene{i + 1 if i else ''}"
        for trace in _still(assembly, points, motion, first=i == 0):
            figure.add_trace(trace.update(scene=scene))
        for trace in _moving(assembly, points, motion, shape.label, sensors, places, 0.0, first=i == 0):
            figure.add_trace(trace.update(scene=scene))
    moving = [k for k, trace in enumerate(figure.data) if trace.meta == "moving"]
    frames = []
    for k in range(_FRAMES):
        theta = 2.0 * np.pi * k / _FRAMES
        data: list[go.Scatter3d] = []
        for shape, motion in zip(shapes, drawn, strict=True):
            data += [
                _geometry(trace)
                for trace in _moving(
                    assembly, points, motion, shape.label, sensors, places, theta, first=False
                )
            ]
        frames.append(go.Frame(name=f"{360 * k // _FRAMES}", data=data, traces=moving))
    figure.frames = frames
    return _lay_out(figure, shapes, points)


def sensor_points(assembly: Assembly, sensors: Sequence[Sensor]) -> FloatArray:
    """Return (n_sensors, 3) positions [m], z above the sea level."""
    structure = assembly.structure
    x, y, _ = structure.nodes[structure.top_node]
    places = [
        np.subtract(structure.nodes[s.node], [0.0, 0.0, structure.sea_level_z_m])
        if s.node is not None
        else np.array([x, y, float(s.height_m or 0.0)])
        for s in sensors
    ]
    return np.array(places).reshape(-1, 3)


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
        lines = _segments(assembly, points)
        suffix = str(i + 1) if i else ""
        axes = {"xaxis": f"x{suffix}", "yaxis": f"y{suffix}"}
        figure.add_scatter(
            x=lines[:, axis],
            y=lines[:, 2],
            mode="lines",
            line={"color": style.INK, "width": 1.3},
            text=np.repeat(_member_text(assembly), 3),
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
        for level, colour in ((0.0, style.BLUE), (float(points[:, 2].min()), "#8B5A2B")):
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
            x=44,
            y=level,
            xref=f"x{suffix}",
            yref=f"y{suffix}",
            showarrow=False,
            xanchor="right",
            yanchor="bottom",
            font={"size": 12},
        )


@dataclass(frozen=True)
class _Drawn:
    """A mode scaled to metres on the page: (n_nodes, 3) motions, and the measured motion of each sensor."""

    damped: ComplexArray
    undamped: FloatArray | None
    measured: ComplexArray | None

    @classmethod
    def of(cls, assembly: Assembly, shape: Shape, H: Any, sway: float) -> _Drawn:
        motion = _translations(assembly, shape.damped)
        peak = motion.ravel()[np.argmax(np.abs(motion))]
        if not np.isfinite(peak) or peak == 0.0:  # the mode was not followed: nothing moves
            return cls(np.zeros_like(motion), None, None)
        scale = sway / peak
        damped = motion * scale
        undamped = None
        if shape.undamped is not None and np.isfinite(shape.undamped).all():
            still = _translations(assembly, shape.undamped).astype(np.float64)
            same = np.real(np.vdot(still, damped))
            undamped = still * np.sign(same or 1.0) * sway / np.abs(still).max()
        measured = None
        if shape.measured is not None:
            model = (H @ shape.damped) * scale
            e = shape.measured
            measured = e * (np.vdot(e, model) / np.vdot(e, e))
        return cls(damped, undamped, measured)


def _translations(assembly: Assembly, shape: npt.NDArray[Any]) -> npt.NDArray[Any]:
    return np.asarray(assembly.expand @ shape).reshape(-1, 6)[:, :3]


def _segments(assembly: Assembly, points: FloatArray) -> FloatArray:
    """Return (3·n_elements, 3): start, end and a gap of every element."""
    mesh = assembly.mesh
    gap = np.full((mesh.start.size, 3), np.nan)
    return np.stack([points[mesh.start], points[mesh.end], gap], axis=1).reshape(-1, 3).astype(np.float32)


def _still(assembly: Assembly, points: FloatArray, motion: _Drawn, *, first: bool) -> list[go.Scatter3d]:
    rest = _segments(assembly, points)
    traces = [
        go.Scatter3d(
            x=rest[:, 0],
            y=rest[:, 1],
            z=rest[:, 2],
            mode="lines",
            hoverinfo="skip",
            line={"color": style.PALE, "width": 2},
            name="at rest",
            legendgroup="rest",
            showlegend=first,
        )
    ]
    if motion.undamped is not None:
        ghost = _segments(assembly, points + motion.undamped)
        traces.append(
            go.Scatter3d(
                x=ghost[:, 0],
                y=ghost[:, 1],
                z=ghost[:, 2],
                mode="lines",
                hoverinfo="skip",
                line={"color": style.GREY, "width": 2, "dash": "dot"},
                name="undamped, at its largest",
                legendgroup="undamped",
                showlegend=first,
            )
        )
    return traces


def _moving(
    assembly: Assembly,
    points: FloatArray,
    motion: _Drawn,
    label: str,
    sensors: Sequence[Sensor],
    places: FloatArray,
    theta: float,
    *,
    first: bool,
) -> list[go.Scatter3d]:
    turn = np.exp(1j * theta)
    now = _segments(assembly, points + np.real(motion.damped * turn))
    traces = [
        go.Scatter3d(
            x=now[:, 0],
            y=now[:, 1],
            z=now[:, 2],
            mode="lines",
            meta="moving",
            hoverinfo="skip",
            line={"color": style.mode_look(label).colour, "width": 5},
            name="damped",
            legendgroup="damped",
            showlegend=first,
        )
    ]
    if motion.measured is not None:
        directions = np.array([np.asarray(s.direction) / np.linalg.norm(s.direction) for s in sensors])
        tips = places + directions * np.real(motion.measured * turn)[:, None]
        arrows = (
            np.stack([places, tips, np.full_like(tips, np.nan)], axis=1).reshape(-1, 3).astype(np.float32)
        )
        traces.append(
            go.Scatter3d(
                x=arrows[:, 0],
                y=arrows[:, 1],
                z=arrows[:, 2],
                mode="lines+markers",
                meta="moving",
                line={"color": style.INK, "width": 4},
                marker={
                    "size": np.tile([0.0, 4.0, 0.0], len(sensors)),
                    "color": style.INK,
                    "symbol": "diamond",
                },
                hoverinfo="skip",
                name="measured at the sensors",
                legendgroup="measured",
                showlegend=first,
            )
        )
    return traces


def _geometry(trace: go.Scatter3d) -> go.Scatter3d:
    """Return only what a frame changes."""
    return go.Scatter3d(x=trace.x, y=trace.y, z=trace.z)


def _lay_out(figure: go.Figure, shapes: Sequence[Shape], points: FloatArray) -> go.Figure:
    n = len(shapes)
    scenes, notes = {}, []
    for i, shape in enumerate(shapes):
        scene = _scene(points, ticks=False)
        scene["domain"] = {"x": [i / n, (i + 1) / n], "y": [0.0, 0.92]}
        scenes[f"scene{i + 1 if i else ''}"] = scene
        notes.append(
            {
                "text": shape.title,
                "x": (i + 0.5) / n,
                "y": 0.93,
                "xref": "paper",
                "yref": "paper",
                "showarrow": False,
                "xanchor": "center",
                "yanchor": "bottom",
                "align": "center",
                "font": {"color": style.mode_look(shape.label).colour, "size": 13},
            }
        )
    turning = {"frame": {"duration": 60, "redraw": True}, "transition": {"duration": 0}, "fromcurrent": True}
    still = {"frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}, "mode": "immediate"}
    slider = {
        "active": 0,
        "x": 0.2,
        "len": 0.8,
        "y": 0.0,
        "pad": {"t": 10},
        "currentvalue": {"prefix": "phase [°]: ", "font": {"size": 12}},
        "font": {"size": 11},
        "steps": [
            {"method": "animate", "label": frame.name, "args": [[frame.name], still]}
            for frame in figure.frames
        ],
    }
    play = {
        "type": "buttons",
        "direction": "right",
        "x": 0.0,
        "xanchor": "left",
        "y": 0.0,
        "yanchor": "top",
        "pad": {"t": 28},
        "showactive": False,
        "buttons": [
            {
                "label": "▶ play",
                "method": "animate",
                "args": [[f.name for f in figure.frames] * 5, {**turning, "mode": "immediate"}],
            },
            {"label": "❚❚ stop", "method": "animate", "args": [[None], still]},
        ],
    }
    return style.finish(
        figure,
        height=680,
        annotations=notes,
        updatemenus=[play],
        sliders=[slider],
        margin={"l": 0, "r": 0, "t": 40, "b": 84},
        legend={"orientation": "h", "x": 0.0, "y": 1.0, "yanchor": "bottom"},
        **scenes,
    )


def _scene(points: FloatArray, *, ticks: bool) -> dict[str, Any]:
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


def _member_text(assembly: Assembly) -> npt.NDArray[Any]:
    p = assembly.mesh.properties
    texts = []
    for e, member in enumerate(assembly.mesh.member):
        m = assembly.structure.members[member]
        section = m.section_start
        texts.append(
            f"{m.name} ({m.part.replace('_', ' ') or 'structure'})<br>"
            f"D {section.outer_diameter_m:.3f} m, t {1e3 * section.thickness_m:.1f} mm, L {p.L[e]:.2f} m<br>"
            f"E {p.E[e] / 1e9:.0f} GPa, ρ {p.rho[e]:.0f} kg/m³"
        )
    return np.array(texts)


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
    at = sensor_points(assembly, sensors)
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
            ("mud line", float(bottom), "#8B5A2B", "dash"),
        )
        if bottom < 0.0 or name == "mud line"
    ]
