"""Mode shapes in space, moving."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go

from gallery.structure_3d import scene_of, segments
from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.report.figures import style
from jackettwin.report.figures.measured_shapes import animated
from jackettwin.response.sensors import Sensor, observation_matrix, sensor_positions
from jackettwin.structure import Assembly

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


def mode_shapes_3d(assembly: Assembly, shapes: Sequence[Shape], sensors: Sequence[Sensor] = ()) -> go.Figure:
    """Draw modes side by side, each turning through one cycle of Re(φ e^{iθ}), θ by button or slider."""
    sea = assembly.structure.sea_level_z_m
    points = assembly.mesh.coordinates - [0.0, 0.0, sea]
    height = float(np.ptp(points[:, 2]))
    H = observation_matrix(assembly, tuple(sensors))
    places = sensor_positions(assembly, sensors)
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


def _still(assembly: Assembly, points: FloatArray, motion: _Drawn, *, first: bool) -> list[go.Scatter3d]:
    rest = segments(assembly, points)
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
        ghost = segments(assembly, points + motion.undamped)
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
    now = segments(assembly, points + np.real(motion.damped * turn))
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
        scene = scene_of(points, ticks=False)
        scene["domain"] = {"x": [i / n, (i + 1) / n], "y": [0.0, 0.9]}
        scenes[f"scene{i + 1 if i else ''}"] = scene
        notes.append(
            {
                "text": shape.title,
                "x": (i + 0.5) / n,
                "y": 0.91,
                "xref": "paper",
                "yref": "paper",
                "showarrow": False,
                "xanchor": "center",
                "yanchor": "bottom",
                "align": "center",
                "font": {"color": style.mode_look(shape.label).colour, "size": 13},
            }
        )
    return animated(figure, height=680, annotations=notes, **scenes)
