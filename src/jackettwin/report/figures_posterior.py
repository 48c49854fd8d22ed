"""What the data leave open: posteriors, whose damping it is, which law, profiles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.report import style
from jackettwin.report.numbers import words
from jackettwin.twin.result import MeasuredMode
from jackettwin.updating import Parameter, Update
from jackettwin.updating.budget import SOURCES, Budget
from jackettwin.updating.update import Uncertainty

_SOURCE_LOOKS = {
    "structure": (style.GREY, ""),
    "soil": (style.ORANGE, "/"),
    "rotor": (style.BLUE, "x"),
    "water": (style.SKY, "."),
}
_BINS = 24
_POINTS = 300
_PRIOR_DRAWS = 20_000
_LN10 = np.log(10.0)
_DELTA_90 = 2.706
"""χ² of one degree of freedom below which a profile's 90 % interval lies."""


def corner(update: Update, known: Uncertainty) -> go.Figure:
    """Draw the posterior of every parameter (diagonal, with the prior) and of every pair, logarithmic."""
    parameters, z = update.problem.parameters, known.log_theta / _LN10
    n = len(parameters)
    figure = make_subplots(rows=n, cols=n, horizontal_spacing=0.02, vertical_spacing=0.02)
    colour = style.law_look(update.law).colour
    some = z[:: max(1, len(z) // _POINTS)]
    best = np.log10(update.best.theta)
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
                x=[best[j]],
                y=[best[i]],
                mode="markers",
                name="best solution",
                showlegend=(i, j) == (1, 0),
                marker={
                    "symbol": "x",
                    "size": 10,
                    "color": style.INK,
                    "line": {"width": 1.5, "color": "white"},
                },
                hovertemplate="best solution<extra></extra>",
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
        name="before the data",
        showlegend=i == 0,
        line={"color": style.GREY, "width": 1.5},
        hoverinfo="skip",
        **cell,
    )
    for q in np.quantile(z, [0.05, 0.95]):
        figure.add_vline(x=q, line={"color": style.INK, "width": 1, "dash": "dot"}, **cell)


def _corner_axes(figure: go.Figure, parameters: Sequence[Parameter], z: FloatArray) -> None:
    n = len(parameters)
    for i in range(n):
        for j in range(n):
            cell = {"row": i + 1, "col": j + 1}
            if j > i:
                figure.update_xaxes(visible=False, **cell)
                figure.update_yaxes(visible=False, **cell)
                continue
            figure.update_xaxes(range=_reach(z[:, j]), showticklabels=i == n - 1, **cell)
            if j == i:
                figure.update_yaxes(
                    showticklabels=False, ticks="", showgrid=False, rangemode="tozero", **cell
                )
            else:
                figure.update_yaxes(range=_reach(z[:, i]), showticklabels=j == 0, **cell)
        unit = parameters[i].unit
        title = {"text": style.title(f"log₁₀<br>{parameters[i].name}<br>", unit), "font": {"size": 11}}
        figure.update_xaxes(title=title, row=n, col=i + 1)
        if i > 0:
            figure.update_yaxes(title=title, row=i + 1, col=1)
    figure.update_xaxes(nticks=4, tickangle=0, tickfont_size=11)
    figure.update_yaxes(nticks=4, tickfont_size=11)


def _reach(z: FloatArray) -> tuple[float, float]:
    return float(z.min()) - 0.1, float(z.max()) + 0.1


def damping_budget(measured: Sequence[MeasuredMode], budget: Budget) -> go.Figure:
    """Draw each source's part of each mode's damping with its 90 % interval, and the measured ratio."""
    figure = go.Figure()
    names = [words(m.label) for m in measured]
    interval = budget.damping_ratio_interval_90
    for s in modelled_sources(budget):
        source = SOURCES[s]
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
        y=100.0 * budget.damping_ratio.sum(axis=1),
        mode="markers",
        name="sum of the sources",
        marker={"color": style.INK, "symbol": "diamond-open", "size": 11, "line": {"width": 2}},
        hovertemplate="%{y:.2f} %<extra>sum</extra>",
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


def modelled_sources(budget: Budget) -> list[int]:
    """Return the positions in ``SOURCES`` of those that damp any mode; the others are not modelled."""
    n = budget.damping_ratio.shape[1]
    return [s for s in range(n) if np.nanmax(np.abs(budget.damping_ratio[:, s])) > 0.0]


def law_comparison(probability: Mapping[str, float]) -> go.Figure:
    """Draw the probability of each law, all equally likely before the data."""
    figure = go.Figure()
    for law, value in probability.items():
        figure.add_bar(
            x=[law],
            y=[100.0 * value],
            name=law,
            marker={"color": style.law_look(law).colour, "line": {"color": style.INK, "width": 0.8}},
            text=f"{100.0 * value:.0f} %" if value > 0.005 else f"{100.0 * value:.1g} %",
            textposition="auto",
            insidetextanchor="middle",
            insidetextfont={"color": style.INK},
            showlegend=False,
            hovertemplate="%{y:.1f} %<extra></extra>",
        )
    figure.add_hline(
        y=100.0 / len(probability),
        line={"color": style.INK, "width": 1.4, "dash": "dash"},
        name="before the data",
        showlegend=True,
    )
    return style.finish(
        figure,
        height=360,
        showlegend=True,
        xaxis={"title": {"text": "law"}, "type": "category"},
        yaxis={"title": {"text": style.title("probability", "%")}, "range": [0.0, 100.0], "dtick": 25.0},
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
