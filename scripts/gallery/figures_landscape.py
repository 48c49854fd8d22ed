"""What the cost looks like around a solution, and how poles move with the support."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import scientific, words

_BRIGHTEST = 0.9
"""This share of a cost surface lies below the brightest colour."""


@dataclass(frozen=True)
class Curve:
    """Cost over one parameter: factor on its value and the cost there."""

    law: str
    parameter: str
    value: float
    unit: str
    factor: FloatArray
    cost: FloatArray


@dataclass(frozen=True)
class Locus:
    """Poles of modes (n_values, n_modes) as a parameter is swept; the solution's poles (n_modes,)."""

    law: str
    parameter: str
    unit: str
    labels: tuple[str, ...]
    values: FloatArray
    poles: ComplexArray
    poles_here: ComplexArray


def sensitivity(curves: Sequence[Curve]) -> go.Figure:
    """Draw the cost as each parameter moves by ±50 %, one panel a law with a legend of its own."""
    laws = list(dict.fromkeys(curve.law for curve in curves))
    columns = min(len(laws), 2)
    rows = -(-len(laws) // columns)
    figure = make_subplots(
        rows=rows,
        cols=columns,
        subplot_titles=laws,
        horizontal_spacing=0.3,
        vertical_spacing=0.2,
    )
    for panel, law in enumerate(laws):
        place = {"row": panel // columns + 1, "col": panel % columns + 1}
        legend = "legend" if panel == 0 else f"legend{panel + 1}"
        for i, curve in enumerate(c for c in curves if c.law == law):
            figure.add_trace(_sensitivity_curve(curve, i).update(legend=legend), **place)
        x, y = (figure.get_subplot(**place)[axis].domain for axis in (0, 1))
        beside = {"x": x[1] + 0.01, "xanchor": "left", "y": y[1], "yanchor": "top", "font": {"size": 12}}
        figure.update_layout({legend: beside})
    figure.update_xaxes(title_text=style.title("change", "%"))
    figure.update_yaxes(title_text=style.title("cost", "-"), exponentformat="power")
    first = figure.layout.legend.to_plotly_json()
    return style.finish(
        figure, height=110 + 270 * rows, legend=first, margin={"l": 70, "r": 170, "t": 46, "b": 54}
    )


def _sensitivity_curve(curve: Curve, i: int) -> go.Scatter:
    """Return the i-th curve of a law: parameters look alike by their place in a law."""
    colours = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE, style.SKY)
    dashes = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
    return go.Scatter(
        x=100.0 * (curve.factor - 1.0),
        y=curve.cost,
        mode="lines",
        name=curve.parameter,
        line={"color": colours[i % 6], "dash": dashes[(i + i // 6) % 6], "width": 2.2},
        customdata=[scientific(v) for v in curve.factor * curve.value],
        hovertemplate=f"{curve.parameter} = %{{customdata}} {curve.unit} (%{{x:+.0f}} %)"
        "<br>cost %{y:.4g}<extra></extra>",
    )


def cost_surface(
    x: FloatArray,
    y: FloatArray,
    cost: FloatArray,
    *,
    names: tuple[str, str],
    units: tuple[str, str],
    points: Sequence[tuple[str, float, float]] = (),
    height: int = 560,
) -> go.Figure:
    """Draw log₁₀ of the cost (n_y, n_x) over two parameters, with solutions marked."""
    level = np.round(np.log10(np.maximum(cost, 1e-16)), 3)
    # most colours for what is low: a ridge of a few sets would take them all
    top = float(np.quantile(level[np.isfinite(level)], _BRIGHTEST))
    figure = go.Figure(
        go.Contour(
            x=x,
            y=y,
            z=level,
            colorscale="Cividis",
            zmin=float(np.nanmin(level)),
            zmax=top,
            ncontours=32,
            line={"width": 0.5, "color": "rgba(0,0,0,0.35)"},
            colorbar={
                "title": {"text": style.title("log₁₀ of the cost, capped", "-"), "side": "right"},
                "thickness": 16,
            },
            hovertemplate=f"{names[0]} %{{x:.3g}} {units[0]}<br>{names[1]} %{{y:.3g}} {units[1]}<br>"
            "log₁₀ cost %{z:.2f}<extra></extra>",
        )
    )
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
            hovertemplate=f"{names[0]} %{{x:.3g}} {units[0]}<br>{names[1]} %{{y:.3g}} {units[1]}"
            f"<extra>{name}</extra>",
        )
    log = {"type": "log", "exponentformat": "power", "dtick": 1}
    narrow = {"type": "log", "exponentformat": "power"}
    decades = [np.log10(axis[-1] / axis[0]) for axis in (x, y)]
    return style.finish(
        figure,
        height=height,
        xaxis={
            "title": {"text": style.title(names[0], units[0])},
            **(log if decades[0] > 2.0 else narrow),
            "range": list(np.log10(x[[0, -1]])),
        },
        yaxis={
            "title": {"text": style.title(names[1], units[1])},
            **(log if decades[1] > 2.0 else narrow),
            "range": list(np.log10(y[[0, -1]])),
        },
    )


def root_locus(locus: Locus) -> go.Figure:
    """Draw the poles of each mode in the upper left half plane, limits and solution marked."""
    n = len(locus.labels)
    columns = min(n, 3)
    rows = -(-n // columns)
    figure = make_subplots(
        rows=rows,
        cols=columns,
        subplot_titles=[words(label) for label in locus.labels],
        horizontal_spacing=0.09,
        vertical_spacing=0.3 / rows,
    )
    for j in range(n):
        cell = {"row": j // columns + 1, "col": j % columns + 1}
        for trace in _locus_traces(locus, j):
            figure.add_trace(trace.update(showlegend=j == 0 and trace.name is not None), **cell)
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


def _locus_traces(locus: Locus, j: int) -> list[go.Scatter]:
    """Return the path of one mode, its two ends and the solution."""
    path, look, here = locus.poles[:, j], style.mode_look(locus.labels[j]), locus.poles_here[j]
    text = [f"{locus.parameter} = {scientific(v)} {locus.unit}" for v in locus.values]
    traces = [
        go.Scatter(
            x=path.real,
            y=path.imag,
            mode="lines+markers",
            line={"color": look.colour, "width": 1.6},
            marker={"size": 4, "color": look.colour},
            customdata=np.column_stack([np.abs(path) / (2.0 * pi), -100.0 * path.real / np.abs(path)]),
            text=text,
            hovertemplate="%{text}<br>f %{customdata[0]:.4f} Hz<br>ζ %{customdata[1]:.2f} %<extra></extra>",
        )
    ]
    followed = np.flatnonzero(np.isfinite(path))
    if followed.size:
        ends = ((followed[0], "circle-open", "lower limit"), (followed[-1], "square-open", "upper limit"))
        traces += [
            go.Scatter(
                x=[path[at].real],
                y=[path[at].imag],
                mode="markers",
                name=f"{locus.parameter} at its {limit}",
                marker={"symbol": symbol, "size": 11, "color": style.INK, "line": {"width": 2}},
                hovertemplate=f"{text[at]}<extra></extra>",
            )
            for at, symbol, limit in ends
        ]
    edge = {"width": 1, "color": style.INK}
    traces.append(
        go.Scatter(
            x=[here.real],
            y=[here.imag],
            mode="markers",
            name="solution",
            marker={"symbol": "triangle-up", "size": 13, "color": style.VERMILLION, "line": edge},
            hovertemplate=f"f {abs(here) / (2 * pi):.4f} Hz, ζ {-100 * here.real / abs(here):.2f} %"
            "<extra>solution</extra>",
        )
    )
    return traces


def frequency_against_parameter(
    values: FloatArray, frequency_hz: FloatArray, limits: tuple[float, float], *, parameter: str, unit: str
) -> go.Figure:
    """Draw a natural frequency over a support parameter between its two limits (thesis figure 8.1)."""
    figure = go.Figure()
    figure.add_scatter(
        x=values,
        y=frequency_hz,
        mode="lines",
        name="f₁",
        line={"color": style.BLUE, "width": 2.4},
        showlegend=False,
        hovertemplate=f"{parameter} %{{x:.3g}} {unit}<br>%{{y:.4f}} Hz<extra></extra>",
    )
    for level, dash, name in zip(limits, ("dash", "dot"), ("→ 0", "→ ∞"), strict=True):
        figure.add_scatter(
            x=values[[0, -1]],
            y=[level, level],
            mode="lines",
            name=f"reference, {parameter} {name}: {level:.4f} Hz",
            line={"color": style.INK, "width": 1.4, "dash": dash},
            hovertemplate="%{y:.6f} Hz<extra></extra>",
        )
    return style.finish(
        figure,
        height=440,
        xaxis={
            "title": {"text": style.title(parameter, unit)},
            "type": "log",
            "exponentformat": "power",
            "dtick": 1,
        },
        yaxis={"title": {"text": style.title("natural frequency f₁", "Hz")}},
    )
