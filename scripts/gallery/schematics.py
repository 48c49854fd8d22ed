"""Drawn models: springs, dashpots, masses, ground."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.structure import Assembly

Point = tuple[float, float]
_GAP = np.full((1, 2), np.nan)


class Label(NamedTuple):
    """Words at a place of a drawing."""

    text: str
    x: float
    y: float


class Drawing(NamedTuple):
    """Strokes (n, 2), broken by NaN, and labels."""

    strokes: FloatArray
    labels: tuple[Label, ...] = ()


def spring(a: Point, b: Point, *, width: float = 0.16) -> FloatArray:
    """Return a zigzag from ``a`` to ``b``."""
    t = np.concatenate([[0.0, 0.2], np.linspace(0.23, 0.77, 10), [0.8, 1.0]])
    n = np.zeros(t.size)
    n[2:-2] = 0.5 * np.tile([1.0, -1.0], 5)
    return _between(a, b, t, n, width)


def dashpot(a: Point, b: Point, *, width: float = 0.2) -> FloatArray:
    """Return a cylinder open towards ``b`` with its piston."""
    cup = _between(a, b, np.array([0.0, 0.38, np.nan]), np.zeros(3), width)
    walls = _between(
        a, b, np.array([0.66, 0.38, 0.38, 0.66, np.nan]), np.array([0.5, 0.5, -0.5, -0.5, 0.0]), width
    )
    piston = _between(
        a, b, np.array([0.55, 0.55, np.nan, 0.55, 1.0]), np.array([0.36, -0.36, 0, 0, 0]), width
    )
    return np.vstack([cup, walls, piston])


def ground(at: Point, *, along: Point = (0.0, 1.0), size: float = 0.9) -> FloatArray:
    """Return a hatched line through ``at``, the hatching to the left of ``along``."""
    u = np.asarray(along, dtype=np.float64)
    n = np.array([-u[1], u[0]])
    p = np.asarray(at, dtype=np.float64)
    strokes = [p - 0.5 * size * u, p + 0.5 * size * u, _GAP]
    for s in np.linspace(-0.5, 0.4, 7):
        start = p + s * size * u
        strokes += [start, start + 0.1 * size * (n + u), _GAP]
    return np.vstack([np.reshape(stroke, (-1, 2)) for stroke in strokes])


def box(x: float, y: float, w: float, h: float) -> FloatArray:
    """Return a rectangle by its lower left corner."""
    return np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]])


def line(*points: Point) -> FloatArray:
    """Return a polyline."""
    return np.array(points, dtype=np.float64)


def joined(*strokes: FloatArray) -> FloatArray:
    """Return strokes as one, with gaps between."""
    return np.vstack([part for stroke in strokes for part in (stroke, _GAP)])


def maxwell_element(names: tuple[str, str] = ("k", "c")) -> Drawing:
    """Draw a spring and a dashpot in series."""
    strokes = joined(spring((0, 0), (1, 0)), dashpot((1, 0), (2, 0)))
    return Drawing(strokes, (Label(names[0], 0.5, 0.25), Label(names[1], 1.5, 0.25)))


def kelvin_voigt_element(names: tuple[str, str] = ("k", "c")) -> Drawing:
    """Draw a spring beside a dashpot."""
    strokes = joined(
        line((0, 0), (0.4, 0)),
        line((0.4, -0.35), (0.4, 0.35)),
        spring((0.4, 0.35), (1.6, 0.35)),
        dashpot((0.4, -0.35), (1.6, -0.35)),
        line((1.6, -0.35), (1.6, 0.35)),
        line((1.6, 0), (2, 0)),
    )
    return Drawing(strokes, (Label(names[0], 1.0, 0.6), Label(names[1], 1.0, -0.68)))


def zener_element(names: tuple[str, str, str] = ("k₀", "k₁", "c")) -> Drawing:
    """Draw a spring beside a Maxwell branch."""
    strokes = joined(
        line((0, 0), (0.2, 0)),
        line((0.2, -0.35), (0.2, 0.35)),
        spring((0.2, 0.35), (1.8, 0.35)),
        spring((0.2, -0.35), (1.0, -0.35)),
        dashpot((1.0, -0.35), (1.8, -0.35)),
        line((1.8, -0.35), (1.8, 0.35)),
        line((1.8, 0), (2, 0)),
    )
    labels = (Label(names[0], 1.0, 0.6), Label(names[1], 0.6, -0.68), Label(names[2], 1.4, -0.68))
    return Drawing(strokes, labels)


def sdof(element: Drawing) -> Drawing:
    """Draw a mass on an element, a force on it, its displacement."""
    mass = box(2.0, -0.55, 0.9, 1.1)
    force = np.vstack([line((2.9, 0), (3.6, 0)), _GAP, line((3.48, 0.07), (3.6, 0), (3.48, -0.07))])
    motion = np.vstack(
        [
            line((2.45, 0.7), (2.45, 0.95)),
            _GAP,
            line((2.45, 0.85), (2.95, 0.85)),
            _GAP,
            line((2.85, 0.91), (2.95, 0.85), (2.85, 0.79)),
        ]
    )
    strokes = joined(ground((0, 0), size=1.4), element.strokes, mass, force, motion)
    labels = (*element.labels, Label("m", 2.45, 0.0), Label("f(t)", 3.3, 0.18), Label("x(t)", 3.12, 0.9))
    return Drawing(strokes, labels)


def pile_springs(depths: Sequence[float] = (-0.6, -1.3, -2.0, -2.7, -3.4)) -> Drawing:
    """Draw a pile with a spring and a dashpot at each depth, vertical ones at the tip."""
    tip = (0.0, min(depths) - 0.4)
    strokes = [line((0.35, 1.0), (0.0, 0.0)), line((-2.2, 0.0), (2.6, 0.0)), line((0.0, 0.0), tip)]
    for y in depths:
        strokes += [
            line((0, y), (0.3, y)),
            line((0.3, y - 0.16), (0.3, y + 0.16)),
            spring((0.3, y + 0.16), (1.6, y + 0.16), width=0.12),
            dashpot((0.3, y - 0.16), (1.6, y - 0.16), width=0.16),
            ground((1.6, y), along=(0, -1), size=0.55),
        ]
        strokes += [line((-0.06, y), (0.06, y))]
    x, y = tip
    strokes += [
        line((-0.2, y), (0.2, y)),
        spring((-0.2, y), (-0.2, y - 0.8), width=0.12),
        dashpot((0.2, y), (0.2, y - 0.8), width=0.16),
        ground((0, y - 0.8), along=(1, 0), size=-0.9),
    ]
    labels = (
        Label("jacket leg", 0.75, 0.75),
        Label("mud line", -1.8, 0.14),
        Label("pile", -0.35, -0.95),
        Label("k(z), c(z)", 2.15, depths[0]),
        Label("k, c of the tip", -1.1, y - 0.4),
    )
    return Drawing(joined(*strokes), labels)


def on_supports(assembly: Assembly, element: Drawing) -> Drawing:
    """Draw a structure's elevation with an element under and beside each outer foot."""
    structure, mesh = assembly.structure, assembly.mesh
    points = mesh.coordinates[:, [0, 2]]
    members = np.stack([points[mesh.start], points[mesh.end], np.full((mesh.start.size, 2), np.nan)], axis=1)
    feet = np.array([[structure.nodes[node][i] for i in (0, 2)] for node in structure.reaction_nodes])
    size, strokes = 7.0, [members.reshape(-1, 2)]
    for x in (feet[:, 0].min(), feet[:, 0].max()):
        foot = np.array([x, feet[:, 1].min()])
        side = np.sign(x) or 1.0
        down = element.strokes[:, ::-1] * [1.0, -1.0] * size + foot
        out = element.strokes * [side, 1.0] * size + foot
        strokes += [
            down,
            out,
            ground((x, foot[1] - 2 * size), along=(1, 0), size=-10.0),
            ground((x + side * 2 * size, foot[1]), along=(0, -side), size=10.0),
        ]
    return Drawing(joined(*strokes))


def draw(drawings: Sequence[tuple[str, Drawing]], *, height: int) -> go.Figure:
    """Return drawings side by side under their titles."""
    n = len(drawings)
    figure = make_subplots(rows=1, cols=n, subplot_titles=[name for name, _ in drawings])
    for i, (_, drawing) in enumerate(drawings):
        add(figure, drawing, row=1, col=i + 1)
    return style.finish(figure, height=height, margin={"l": 20, "r": 20, "t": 46, "b": 20})


def add(figure: go.Figure, drawing: Drawing, *, row: int, col: int) -> None:
    """Add a drawing to a cell, true to scale and without axes."""
    figure.add_scatter(
        x=drawing.strokes[:, 0],
        y=drawing.strokes[:, 1],
        mode="lines",
        row=row,
        col=col,
        line={"color": style.INK, "width": 1.6},
        hoverinfo="skip",
        showlegend=False,
    )
    place: dict[str, Any] = {"row": row, "col": col}
    for label in drawing.labels:
        figure.add_annotation(
            text=label.text, x=label.x, y=label.y, showarrow=False, font={"size": 15}, **place
        )
    anchor = next(figure.select_yaxes(**place)).anchor
    figure.update_xaxes(visible=False, **place)
    figure.update_yaxes(visible=False, scaleanchor=anchor, **place)


def _between(a: Point, b: Point, t: FloatArray, n: FloatArray, width: float) -> FloatArray:
    """Return points at shares ``t`` of the way from a to b, ``n`` widths to its left."""
    start, way = np.asarray(a, dtype=np.float64), np.subtract(b, a).astype(np.float64)
    normal = np.array([-way[1], way[0]]) / np.linalg.norm(way)
    return np.asarray(start + t[:, None] * way + (width * n)[:, None] * normal)
