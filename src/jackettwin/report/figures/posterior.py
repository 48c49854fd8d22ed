"""Figures of posteriors and profiles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.report.figures import style
from jackettwin.soil import Parameter
from jackettwin.updating import Uncertainty, Update

_BINS = 24
_POINTS = 300
_PRIOR_DRAWS = 20_000
_LN10 = np.log(10.0)
_DELTA_90 = NORMAL_90**2
"""90 % point of χ² with one degree of freedom, which bounds a profile's interval."""


def corner(update: Update, known: Uncertainty) -> go.Figure:
    """Draw the posterior of every parameter (diagonal, with the prior) and of every pair, logarithmic."""
    parameters, z = update.problem.parameters, known.log_theta / _LN10
    n = len(parameters)
    figure = make_subplots(rows=n, cols=n, horizontal_spacing=0.02, vertical_spacing=0.02)
    colour = style.law_look(update.law).colour
    some = z[:: max(1, len(z) // _POINTS)]
    middle = np.log10(known.median)
    prior = _prior_draws(update)
    for i in range(n):
        _histogram(figure, z[:, i], prior[:, i], i, colour)
        for j in range(i):
            cell = {"row": i + 1, "col": j + 1}
            figure.add_scatter(
                x=some[:, j],
                y=some[:, i],
                mode="markers",
                name="draws from the posterior",
                showlegend=(i, j) == (1, 0),
                marker={"size": 3, "color": colour, "opacity": 0.5},
                hoverinfo="skip",
                **cell,
            )
            figure.add_scatter(
                x=[middle[j]],
                y=[middle[i]],
                mode="markers",
                name="medians",
                showlegend=(i, j) == (1, 0),
                marker={
                    "symbol": "x",
                    "size": 10,
                    "color": style.INK,
                    "line": {"width": 1.5, "color": "white"},
                },
                hovertemplate="medians<extra></extra>",
                **cell,
            )
    _corner_axes(figure, parameters, z)
    # the upper right is empty
    corner = {
        "x": 1.0,
        "xanchor": "right",
        "y": 1.0,
        "yanchor": "bottom",
        "orientation": "h",
        "itemsizing": "constant",
    }
    return style.finish(figure, height=max(400, 150 * n), legend=corner)


def _prior_draws(update: Update) -> FloatArray:
    """Return log₁₀ θ (n, d) drawn from the prior."""
    return np.asarray(update.problem.prior.draw(_PRIOR_DRAWS, np.random.default_rng(0)) / _LN10)


def _histogram(figure: go.Figure, z: FloatArray, prior: FloatArray, i: int, colour: str) -> None:
    density, edges = np.histogram(z, _BINS, density=True)
    cell = {"row": i + 1, "col": i + 1}
    figure.add_bar(
        x=0.5 * (edges[1:] + edges[:-1]),
        y=density,
        width=np.diff(edges),
        marker={"color": style.rgba(colour, 0.6), "line": {"width": 0}},
        showlegend=False,
        hoverinfo="skip",
        **cell,
    )
    before, edges = np.histogram(prior, _BINS, density=True)
    figure.add_scatter(
        x=np.repeat(edges, 2),
        y=np.concatenate([[0.0], np.repeat(before, 2), [0.0]]),
        mode="lines",
        name="prior",
        showlegend=i == 0,
        line={"color": style.GREY, "width": 1.5},
        hoverinfo="skip",
        **cell,
    )
    for q in np.quantile(z, QUANTILES[::2]):
        figure.add_vline(x=q, line={"color": style.INK, "width": 1, "dash": "dot"}, **cell)


def _corner_axes(figure: go.Figure, parameters: Sequence[Parameter], z: FloatArray) -> None:
    n = len(parameters)
    # all axes at once, which is much faster in Plotly than one by one
    axes: dict[str, dict[str, object]] = {}
    for i in range(n):
        for j in range(n):
            number = str(i * n + j + 1) if i or j else ""
            if j > i:
                axes[f"xaxis{number}"] = axes[f"yaxis{number}"] = {"visible": False}
                continue
            across: dict[str, object] = {"range": _reach(z[:, j]), "showticklabels": i == n - 1}
            up: dict[str, object] = (
                {"showticklabels": False, "ticks": "", "showgrid": False, "rangemode": "tozero"}
                if j == i
                else {"range": _reach(z[:, i]), "showticklabels": j == 0}
            )
            if i == n - 1:
                across["title"] = _corner_title(parameters[j])
            if j == 0 and i > 0:
                up["title"] = _corner_title(parameters[i])
            axes[f"xaxis{number}"] = {**across, "nticks": 4, "tickangle": 0, "tickfont": {"size": 11}}
            axes[f"yaxis{number}"] = {**up, "nticks": 4, "tickfont": {"size": 11}}
    figure.update_layout(axes)


def _corner_title(parameter: Parameter) -> dict[str, object]:
    return {"text": style.title(f"log₁₀<br>{parameter.name}<br>", parameter.unit), "font": {"size": 11}}


def _reach(z: FloatArray) -> tuple[float, float]:
    return float(z.min()) - 0.1, float(z.max()) + 0.1


def profiles(update: Update, known: Uncertainty) -> go.Figure:
    """Draw the increase of χ², minimised over the other parameters, as each one varies in its bounds."""
    figure = go.Figure()
    dashes = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")
    colours = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE, style.SKY)
    for i, p in enumerate(known.profiles):
        parameter = update.problem.parameters[i]
        span = np.log(parameter.high / parameter.low)
        figure.add_scatter(
            x=100.0 * np.log(p.values / parameter.low) / span,
            y=p.cost - update.best.cost,
            mode="lines+markers",
            name=p.name,
            line={"color": colours[i % 6], "dash": dashes[i % 6]},
            marker={"size": 5},
            customdata=p.values,
            hovertemplate=f"%{{customdata:.3g}} {parameter.unit}<br>Δχ² %{{y:.2f}}<extra>{p.name}</extra>",
        )
    figure.add_hline(
        y=_DELTA_90,
        line={"color": style.GREY, "width": 1.2, "dash": "dash"},
        annotation_text="90 %",
    )
    return style.finish(
        figure,
        height=400,
        xaxis={"title": {"text": style.title("position between the bounds, logarithmic", "%")}},
        yaxis={
            "title": {"text": style.title("increase of χ², minimised over the others", "-")},
            "range": [-0.3, 12.3],
        },
    )
