"""Figures of the cost around a solution, the paths of searches, and poles as functions of a parameter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import scientific, words
from jackettwin.soil import Parameter
from jackettwin.updating import CostCurve, CostSurface, Locus, SearchPath

_BRIGHTEST = 0.9
"""Share of a cost surface below the brightest colour."""
_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE, style.SKY)
_DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
_ENDS = {"solution": style.GREEN, "plateau": style.PURPLE, "stalled": style.VERMILLION}
"""Colour of a search's path, by the kind of its end."""


def cost_curves(curves: Sequence[CostCurve]) -> go.Figure:
    """Draw the cost as each parameter varies by ±50 % (thesis figures 8.5, 8.6)."""
    figure = go.Figure()
    for i, curve in enumerate(curves):
        p = curve.parameter
        figure.add_scatter(
            x=100.0 * (curve.factor - 1.0),
            y=curve.cost,
            mode="lines",
            name=p.name,
            line={"color": _COLOURS[i % 6], "dash": _DASHES[(i + i // 6) % 6], "width": 2.2},
            customdata=[scientific(v) for v in curve.factor * curve.value],
            hovertemplate=f"{p.name} = %{{customdata}} {p.unit} (%{{x:+.0f}} %)"
            "<br>cost %{y:.4g}<extra></extra>",
        )
    figure.update_xaxes(title_text=style.title("change", "%"))
    figure.update_yaxes(title_text=style.title("cost", "-"), type="log", exponentformat="power")
    return style.finish(figure, height=380, showlegend=True)


def cost_surface(
    surface: CostSurface,
    points: Sequence[tuple[str, float, float]] = (),
    paths: Sequence[SearchPath] = (),
    axes: tuple[int, int] = (0, 1),
) -> go.Figure:
    """Draw log₁₀ of the cost over two parameters, with points and paths of searches.

    Parameters
    ----------
    points : (name, x, y) of each point
    axes : indices of the surface's parameters in the points of the paths
    """
    x, y, (first, second) = surface.x, surface.y, surface.parameters
    level = np.round(np.log10(np.maximum(surface.cost, 1e-16)), 3)
    known = level[np.isfinite(level)]
    # most colours are used for low costs: otherwise a ridge of a few sets would use them all
    low, top = (float(known.min()), float(np.quantile(known, _BRIGHTEST))) if known.size else (-1.0, 0.0)
    hover = f"{first.name} %{{x:.3g}} {first.unit}<br>{second.name} %{{y:.3g}} {second.unit}"
    figure = go.Figure(
        go.Contour(
            x=x,
            y=y,
            z=level,
            colorscale="Cividis",
            zmin=low,
            zmax=top,
            ncontours=32,
            line={"width": 0.5, "color": "rgba(0,0,0,0.35)"},
            colorbar={
                "title": {"text": style.title("log₁₀ of the cost, capped", "-"), "side": "right"},
                "thickness": 16,
            },
            hovertemplate=f"{hover}<br>log₁₀ cost %{{z:.2f}}<extra></extra>",
        )
    )
    for trace in _ways(paths, axes):
        figure.add_trace(trace)
    symbols = ("star", "triangle-up", "square", "diamond", "cross")
    for i, (name, px, py) in enumerate(points):
        figure.add_scatter(
            x=[px],
            y=[py],
            mode="markers",
            name=name,
            marker={
                "size": 13,
                "symbol": symbols[i % 5],
                "color": style.VERMILLION,
                "line": {"width": 1.5, "color": "white"},
            },
            hovertemplate=f"{hover}<extra>{name}</extra>",
        )
    return style.finish(figure, height=580, xaxis=_logarithmic(first, x), yaxis=_logarithmic(second, y))


def _ways(paths: Sequence[SearchPath], axes: tuple[int, int]) -> list[go.Scatter]:
    """Return a line and a starting ring per path, with one legend entry for each kind of end."""
    traces, said = [], set[str]()
    for i, path in enumerate(paths, start=1):
        # the path of a simplex consists of the points at which the cost decreased
        lower = np.flatnonzero(path.cost == np.minimum.accumulate(path.cost))
        points, colour = np.vstack([path.points[lower], path.end])[:, list(axes)], _ENDS[path.fate]
        cost = np.append(path.cost[lower], path.end_cost)
        traces.append(
            go.Scatter(
                x=points[:, 0],
                y=points[:, 1],
                mode="lines+markers",
                name={"solution": "path to a solution", "plateau": "path to a plateau"}.get(
                    path.fate, "path that stalled"
                ),
                legendgroup=path.fate,
                showlegend=path.fate not in said,
                line={"color": colour, "width": 1.4},
                marker={
                    "size": [9, *[3] * (len(points) - 1)],
                    "symbol": ["circle-open", *["circle"] * (len(points) - 1)],
                    "color": colour,
                    "line": {"width": 2, "color": colour},
                },
                text=[f"path {i}<br>cost {value:.3g}" for value in cost],
                hovertemplate="%{text}<extra></extra>",
            )
        )
        said.add(path.fate)
    return traces


def _logarithmic(p: Parameter, values: FloatArray) -> dict[str, Any]:
    axis: dict[str, Any] = {
        "title": {"text": style.title(p.name, p.unit)},
        "type": "log",
        "exponentformat": "power",
        "range": list(np.log10(values[[0, -1]])),
    }
    return axis | ({"dtick": 1} if np.log10(values[-1] / values[0]) > 2.0 else {})


def root_locus(locus: Locus, labels: Sequence[str]) -> go.Figure:
    """Draw the poles of each mode in the upper left half plane, with the limits and the explored point."""
    n = len(labels)
    columns = min(n, 3)
    rows = -(-n // columns)
    figure = make_subplots(
        rows=rows,
        cols=columns,
        subplot_titles=[
            f"{words(label)} (mode {mode})" for label, mode in zip(labels, locus.modes, strict=True)
        ],
        horizontal_spacing=0.09,
        vertical_spacing=0.3 / rows,
    )
    said = set[str]()
    for j, label in enumerate(labels):
        cell = {"row": j // columns + 1, "col": j % columns + 1}
        for trace in _locus_traces(locus, j, label):
            trace.showlegend = trace.name is not None and trace.name not in said
            said |= {trace.name}
            figure.add_trace(trace, **cell)
        figure.update_xaxes(title_text=style.title("Re λ", "rad/s"), **cell)
        figure.update_yaxes(title_text=style.title("Im λ", "rad/s"), **cell)
    figure.update_xaxes(nticks=4, tickangle=0, title_font_size=12, tickfont_size=11)
    figure.update_yaxes(nticks=6, title_font_size=12, tickfont_size=11)
    return style.finish(
        figure,
        height=110 + 320 * rows,
        legend=style.LEGEND_ABOVE | {"y": 1.0 + 0.1 / rows},
        margin={"l": 70, "r": 24, "t": 84, "b": 54},
    )


def _locus_traces(locus: Locus, j: int, label: str) -> list[go.Scatter]:
    """Return the path of one mode, its two ends and the point from which it was tracked."""
    path, look, p = locus.poles[:, j], style.mode_look(label), locus.parameter
    text = [f"{p.name} = {scientific(v)} {'' if p.unit == '-' else p.unit}" for v in locus.values]
    traces = [
        go.Scatter(
            x=path.real,
            y=path.imag,
            mode="lines+markers",
            line={"color": look.colour, "width": 1.6},
            marker={"size": 3, "color": look.colour},
            customdata=np.column_stack([locus.frequency_hz[:, j], 100.0 * locus.damping_ratio[:, j]]),
            text=text,
            hovertemplate="%{text}<br>f %{customdata[0]:.4f} Hz<br>ζ %{customdata[1]:.2f} %<extra></extra>",
        )
    ]
    followed = np.flatnonzero(np.isfinite(path))
    if not followed.size:
        return traces
    marks = (
        (followed[0], "circle-open", style.INK, f"{p.name} at its lower end"),
        (followed[-1], "square-open", style.INK, f"{p.name} at its upper end"),
        (locus.origin, "triangle-up", style.VERMILLION, "explored point"),
    )
    for at, symbol, colour, name in marks:
        traces.append(
            go.Scatter(
                x=[path[at].real],
                y=[path[at].imag],
                mode="markers",
                name=name,
                marker={
                    "symbol": symbol,
                    "size": 11,
                    "color": colour,
                    "line": {"width": 1.6, "color": style.INK},
                },
                hovertemplate=f"{text[at]}<br>f {locus.frequency_hz[at, j]:.4f} Hz, "
                f"ζ {100 * locus.damping_ratio[at, j]:.2f} %<extra>{name}</extra>",
            )
        )
    return traces


def sensitivities(
    names: Sequence[str], labels: Sequence[str], frequency: FloatArray, damping: FloatArray
) -> go.Figure:
    """Draw the change of frequencies and damping ratios due to an increase of each parameter by one per cent.

    Parameters
    ----------
    frequency : (n_modes, n_parameters) ∂ ln f/∂ ln θ
    damping : (n_modes, n_parameters) ∂ζ/∂ ln θ
    """
    figure = make_subplots(
        rows=1, cols=2, subplot_titles=("frequency", "damping ratio"), horizontal_spacing=0.12
    )
    for i, name in enumerate(names):
        for col, values in ((1, frequency[:, i]), (2, 100.0 * damping[:, i])):
            figure.add_bar(
                x=[words(label) for label in labels],
                y=values,
                name=name,
                legendgroup=name,
                showlegend=col == 1,
                marker={"color": _COLOURS[i % 6], "pattern": {"shape": ("", "/", ".", "x", "-", "+")[i % 6]}},
                hovertemplate=f"%{{x}}<br>{name}: %{{y:.3g}}<extra></extra>",
                row=1,
                col=col,
            )
    # short: the axis is 260 px high
    figure.update_yaxes(title_text=style.title("Δf per 1 % of parameter", "%"), row=1, col=1)
    figure.update_yaxes(title_text=style.title("Δζ per 1 % of parameter", "0.01 %"), row=1, col=2)
    return style.finish(figure, height=400, barmode="group", margin={"l": 70, "r": 24, "t": 84, "b": 54})
