"""What the data leave open: posteriors, whose damping it is, which law, profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.report import style
from jackettwin.report.numbers import words
from jackettwin.twin.result import MeasuredMode
from jackettwin.updating import Parameter, Update
from jackettwin.updating.budget import SOURCES, Budget
from jackettwin.updating.update import Uncertainty

FloatArray = npt.NDArray[np.float64]

_SOURCE_LOOKS = {
    "structure": (style.GREY, ""),
    "soil": (style.ORANGE, "/"),
    "rotor": (style.BLUE, "x"),
    "water": (style.SKY, "."),
}
_BINS = 24
_POINTS = 500
_DELTA_90 = 2.706
"""χ² of one degree of freedom below which a profile's 90 % interval lies."""


def corner(update: Update, known: Uncertainty) -> go.Figure:
    """Draw the posterior of every parameter (diagonal) and of every pair, on logarithmic axes."""
    parameters, z = update.problem.parameters, known.log_theta / np.log(10.0)
    n = len(parameters)
    figure = make_subplots(rows=n, cols=n, horizontal_spacing=0.02, vertical_spacing=0.02)
    colour = style.law_look(update.law).colour
    some = z[:: max(1, len(z) // _POINTS)]
    for i in range(n):
        _histogram(figure, z[:, i], i, colour)
        for j in range(i):
            figure.add_scattergl(
                x=some[:, j],
                y=some[:, i],
                mode="markers",
                marker={"size": 3, "color": colour, "opacity": 0.5},
                hoverinfo="skip",
                row=i + 1,
                col=j + 1,
            )
            best = np.log10(update.best.theta)
            figure.add_scatter(
                x=[best[j]],
                y=[best[i]],
                mode="markers",
                marker={"symbol": "x", "size": 9, "color": style.INK},
                hovertemplate="best solution<extra></extra>",
                row=i + 1,
                col=j + 1,
            )
    _corner_axes(figure, parameters, z)
    return style.finish(figure, height=max(360, 150 * n), showlegend=False)


def _histogram(figure: go.Figure, z: FloatArray, i: int, colour: str) -> None:
    counts, edges = np.histogram(z, _BINS)
    figure.add_bar(
        x=0.5 * (edges[1:] + edges[:-1]),
        y=counts,
        width=np.diff(edges),
        marker={"color": style.rgba(colour, 0.6), "line": {"width": 0}},
        hoverinfo="skip",
        row=i + 1,
        col=i + 1,
    )
    for q in np.quantile(z, [0.05, 0.95]):
        figure.add_vline(x=q, line={"color": style.INK, "width": 1, "dash": "dot"}, row=i + 1, col=i + 1)


def _corner_axes(figure: go.Figure, parameters: Sequence[Parameter], z: FloatArray) -> None:
    n = len(parameters)
    for i in range(n):
        for j in range(n):
            if j > i:
                figure.update_xaxes(visible=False, row=i + 1, col=j + 1)
                figure.update_yaxes(visible=False, row=i + 1, col=j + 1)
                continue
            span = (float(z[:, j].min()) - 0.1, float(z[:, j].max()) + 0.1)
            figure.update_xaxes(range=span, showticklabels=i == n - 1, row=i + 1, col=j + 1)
            figure.update_yaxes(showticklabels=j == 0 and i > 0, row=i + 1, col=j + 1)
        unit = parameters[i].unit
        name = f"log₁₀<br>{parameters[i].name}<br>"
        figure.update_xaxes(title={"text": style.title(name, unit), "font": {"size": 11}}, row=n, col=i + 1)
        if i > 0:
            figure.update_yaxes(
                title={"text": style.title(name, unit), "font": {"size": 11}}, row=i + 1, col=1
            )


def damping_budget(measured: Sequence[MeasuredMode], budget: Budget) -> go.Figure:
    """Draw each source's part of each mode's damping with its 90 % interval, and the measured ratio."""
    figure = go.Figure()
    names = [words(m.label) for m in measured]
    interval = budget.damping_ratio_interval_90
    for s, source in enumerate(SOURCES[: budget.damping_ratio.shape[1]]):
        colour, pattern = _SOURCE_LOOKS[source]
        bars = None
        if interval is not None:
            bars = {
                "type": "data",
                "symmetric": False,
                "array": 100.0 * np.maximum(interval[:, s, 1] - budget.damping_ratio[:, s], 0.0),
                "arrayminus": 100.0 * np.maximum(budget.damping_ratio[:, s] - interval[:, s, 0], 0.0),
                "thickness": 1.4,
                "width": 4,
            }
        figure.add_bar(
            x=names,
            y=100.0 * budget.damping_ratio[:, s],
            name=source,
            offsetgroup=source,
            error_y=bars,
            marker={
                "color": colour,
                "line": {"color": style.INK, "width": 0.8},
                "pattern": {"shape": pattern},
            },
            hovertemplate=f"%{{y:.3f}} %<extra>{source}</extra>",
        )
    figure.add_scatter(
        x=names,
        y=[None if m.damping_ratio is None else 100.0 * m.damping_ratio for m in measured],
        mode="markers",
        name="measured, all sources",
        marker={"color": style.INK, "symbol": "line-ew-open", "size": 26, "line": {"width": 2}},
        hovertemplate="%{y:.2f} %<extra>measured</extra>",
    )
    return style.finish(
        figure,
        height=420,
        barmode="group",
        xaxis={"title": {"text": "mode"}, "type": "category"},
        yaxis={"title": {"text": style.title("damping ratio", "%")}, "rangemode": "tozero"},
    )


def law_comparison(probability: Mapping[str, float]) -> go.Figure:
    """Draw the probability of each law, all equally likely before the data."""
    figure = go.Figure()
    for law, value in probability.items():
        figure.add_bar(
            x=[law],
            y=[100.0 * value],
            name=law,
            marker={"color": style.law_look(law).colour, "line": {"color": style.INK, "width": 0.8}},
            hovertemplate="%{y:.1f} %<extra></extra>",
        )
    figure.add_hline(
        y=100.0 / len(probability),
        line={"color": style.GREY, "width": 1.2, "dash": "dash"},
    )
    return style.finish(
        figure,
        height=340,
        showlegend=False,
        xaxis={"title": {"text": "law"}, "type": "category"},
        yaxis={"title": {"text": style.title("probability", "%")}, "rangemode": "tozero"},
    )


def profiles(update: Update, known: Uncertainty) -> go.Figure:
    """Draw the least χ² over the other parameters as each goes through its bounds, above the best."""
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
        xaxis={"title": {"text": style.title("place between the bounds, logarithmic", "%")}},
        yaxis={
            "title": {"text": style.title("least χ² above the best", "-")},
            "range": [-0.3, 12.3],
        },
    )
