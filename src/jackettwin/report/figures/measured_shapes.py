"""Animated mode shapes at the sensors, without a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import plotly.graph_objects as go

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array
from jackettwin.identification import ModalEstimate
from jackettwin.records import Channel
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import frequency, percent, words

_FRAMES = 24
_SWAY = 0.16
"""Largest drawn displacement, as a share of the height of the sensors."""
_COLUMNS = 3
_LEAST_SIZE = 0.1
"""Drawn height if all sensors are at the same height [m]."""


@dataclass(frozen=True)
class SensorLayout:
    """Positions of the sensors in ascending order, and the channels at each.

    Attributes
    ----------
    height : (n_places,)
        Height above sea level [m].
    place : (n_channels,) int
        Index of each channel's position.
    direction : (n_channels, 3)
    """

    height: FloatArray
    place: Int64Array
    direction: FloatArray

    @classmethod
    def of(cls, channels: Sequence[Channel]) -> SensorLayout:
        """Return the positions of the channels, all of which must have a height."""
        heights = [float(c.height_m) for c in channels if c.height_m is not None]
        order = sorted(set(heights))
        along_x = (1.0, 0.0, 0.0)
        direction: FloatArray = np.array([c.direction if any(c.direction) else along_x for c in channels])
        return cls(np.array(order), np.array([order.index(height) for height in heights]), direction)

    def motion(self, shape: ComplexArray) -> ComplexArray:
        """Return the displacement of every place, (n_places, 3), largest entry 1."""
        out = np.zeros((len(self.height), 3), dtype=complex)
        np.add.at(out, self.place, shape[:, None] * self.direction)
        return np.asarray(out / np.abs(out).max())


def measured_shapes_3d(channels: Sequence[Channel], modes: Sequence[tuple[str, ModalEstimate]]) -> go.Figure:
    """Draw measured modes, animated through one cycle of Re(φ e^{iθ}), with a button and a slider for θ.

    Parameters
    ----------
    modes : sequence of (label, mode)
        Labels may be empty.
    """
    places = SensorLayout.of(channels)
    size = max(float(np.ptp(places.height)), _LEAST_SIZE)
    figure = go.Figure()
    for i, (label, mode) in enumerate(modes):
        scene = f"scene{i + 1 if i else ''}"
        figure.add_trace(
            _line(places, np.zeros((len(places.height), 3)), "", first=i == 0).update(scene=scene)
        )
        figure.add_trace(_line(places, _now(places, mode, size, 0.0), label or "mode").update(scene=scene))
    moving = list(range(1, 2 * len(modes), 2))
    frames = []
    for k in range(_FRAMES):
        theta = 2.0 * np.pi * k / _FRAMES
        lines = [_line(places, _now(places, mode, size, theta), "mode") for _, mode in modes]
        data = [go.Scatter3d(x=line.x, y=line.y, z=line.z) for line in lines]
        frames.append(go.Frame(name=f"{360 * k // _FRAMES}", data=data, traces=moving))
    figure.frames = frames
    return _lay_out(figure, places, size, modes)


def _now(places: SensorLayout, mode: ModalEstimate, size: float, theta: float) -> FloatArray:
    turned = places.motion(mode.mode_shape) * np.exp(1j * theta)
    return np.asarray(turned.real * _SWAY * size)


def _line(places: SensorLayout, shift: FloatArray, label: str, *, first: bool = False) -> go.Scatter3d:
    colour = style.mode_look(label).colour if label else style.PALE
    return go.Scatter3d(
        x=shift[:, 0],
        y=shift[:, 1],
        z=places.height + shift[:, 2],
        mode="lines+markers",
        line={"color": colour, "width": 6 if label else 3},
        marker={"color": colour, "size": 4 if label else 3},
        hoverinfo="skip",
        name="at rest",
        showlegend=first,
    )


def _lay_out(
    figure: go.Figure, places: SensorLayout, size: float, modes: Sequence[tuple[str, ModalEstimate]]
) -> go.Figure:
    n_columns = min(len(modes), _COLUMNS)
    n_rows = -(-len(modes) // n_columns)
    wide = {"range": [-1.3 * _SWAY * size, 1.3 * _SWAY * size], "showticklabels": False}
    scenes, notes = {}, []
    for i, (label, mode) in enumerate(modes):
        row, column = divmod(i, n_columns)
        top = 1.0 - row / n_rows
        scenes[f"scene{i + 1 if i else ''}"] = {
            "xaxis": {**wide, "title": {"text": "x"}},
            "yaxis": {**wide, "title": {"text": "y"}},
            "zaxis": {
                "title": {"text": style.title("height", "m")},
                "showticklabels": column == 0,
            },
            "aspectmode": "manual",
            "aspectratio": {"x": 0.5, "y": 0.5, "z": 1.2},
            "camera": {"eye": {"x": 1.35, "y": 1.35, "z": 0.45}},
            "domain": {
                "x": [column / n_columns, (column + 1) / n_columns],
                "y": [top - 1.0 / n_rows, top - 0.1 / n_rows],
            },
        }
        name = words(label) if label else "mode"
        numbers = f"{frequency(mode.frequency_hz)} Hz  ζ {percent(mode.damping_ratio)} %"
        notes.append(
            {
                "text": f"<b>{name}</b>  {numbers}",
                "x": (column + 0.5) / n_columns,
                "y": top - 0.1 / n_rows,
                "xref": "paper",
                "yref": "paper",
                "showarrow": False,
                "xanchor": "center",
                "yanchor": "bottom",
                "font": {"color": style.mode_look(label or "mode").colour, "size": 13},
            }
        )
    return animated(figure, height=110 + 380 * n_rows, annotations=notes, **scenes)


def animated(figure: go.Figure, *, height: int, **layout: Any) -> go.Figure:
    """Add frames (one per phase in degrees), button, slider and house style to a figure."""
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
        height=height,
        updatemenus=[play],
        sliders=[slider],
        margin={"l": 0, "r": 0, "t": 60, "b": 84},
        legend={"orientation": "h", "x": 0.0, "y": 1.03, "yanchor": "bottom"},
        **layout,
    )
