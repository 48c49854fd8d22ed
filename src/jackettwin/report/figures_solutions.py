"""Every solution of every law on one map: its place between the bounds, and how far its valley reaches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.report import style
from jackettwin.report.numbers import scientific
from jackettwin.updating import Parameter, Update
from jackettwin.updating.solutions import Solution

_SYMBOLS = ("circle", "square", "diamond", "triangle-up", "cross", "x", "star")
_ROW, _EDGE = 46, 150
"""Heights [px] of one parameter, and of what stands above and below all of them."""
_INTERVAL = 14
"""Width [px] of the band of a posterior."""


def solution_map(updates: Sequence[Update]) -> go.Figure:
    """Draw each solution's parameters between their bounds, valleys as lines, the posterior as bands."""
    counts = [len(u.problem.parameters) for u in updates]
    figure = make_subplots(
        rows=len(updates),
        cols=1,
        shared_xaxes=True,
        row_heights=counts,
        vertical_spacing=min(0.12, 34.0 / (_EDGE + _ROW * sum(counts))),
        subplot_titles=[u.law for u in updates],
    )
    named: set[str] = set()
    for row, update in enumerate(updates, start=1):
        for trace in [*_interval(update), *_solutions(update)]:
            trace.update(showlegend=trace.name is not None and trace.name not in named)
            named.add(trace.name or "")
            figure.add_trace(trace, row=row, col=1)
        figure.update_yaxes(
            tickvals=list(range(counts[row - 1])),
            ticktext=[_label(p) for p in update.problem.parameters],
            range=[counts[row - 1] - 0.5, -0.5],
            showgrid=False,
            title={"text": "parameter"},
            row=row,
            col=1,
        )
    figure.update_xaxes(range=[-3.0, 103.0], showticklabels=False)
    figure.update_xaxes(
        title={"text": style.title("place between the bounds, logarithmic", "%")},
        showticklabels=True,
        row=len(updates),
        col=1,
    )
    height = _EDGE + _ROW * sum(counts) + 34 * len(updates)
    top = style.LEGEND_ABOVE | {"y": 1.0 + 40.0 / height}
    return style.finish(figure, height=height, legend=top, margin={"l": 70, "r": 24, "t": 92, "b": 54})


def _label(p: Parameter) -> str:
    unit = "" if p.unit == "-" else f" {p.unit}"
    return f"{p.name}<br><sub>{scientific(p.low, 2)} … {scientific(p.high, 2)}{unit}</sub>"


def _place(parameters: Sequence[Parameter], theta: FloatArray) -> FloatArray:
    """Return where parameter vectors (..., d) lie between the bounds, in per cent."""
    low, high = (np.log([getattr(p, side) for p in parameters]) for side in ("low", "high"))
    return np.asarray(100.0 * (np.log(theta) - low) / (high - low))


def _interval(update: Update) -> list[go.Scatter]:
    """Return the posterior's 90 % intervals as bands behind everything."""
    if update.uncertainty is None:
        return []
    ends = _place(update.problem.parameters, update.uncertainty.interval_90.T)
    return [
        go.Scatter(
            x=_broken(ends[0], ends[1]),
            y=np.repeat(np.arange(len(ends[0])), 3),
            mode="lines",
            name="posterior, 90 %",
            line={"color": style.PALE, "width": _INTERVAL},
            hoverinfo="skip",
        )
    ]


def _solutions(update: Update) -> list[go.Scatter]:
    """Return the valley and the place of each solution, those with a locked damper hollow."""
    traces = []
    n = len(update.solutions)
    for i, s in enumerate(update.solutions):
        # the cheapest on the parameter's own line, the others beside it
        y = np.arange(len(s.theta)) + (0.0 if n == 1 else 0.56 * (i / (n - 1) - 0.5))
        colour = style.VERMILLION if s.locked_damper else style.BLUE
        ends = _place(update.problem.parameters, s.extent.T)
        traces += [
            go.Scatter(
                x=_broken(ends[0], ends[1]),
                y=np.repeat(y, 3),
                mode="lines",
                line={"color": colour, "width": 2},
                hoverinfo="skip",
            ),
            go.Scatter(
                x=_place(update.problem.parameters, s.theta),
                y=y,
                mode="markers",
                name=f"solution {i + 1}{', damper locked' if s.locked_damper else ''}",
                marker={
                    "symbol": _SYMBOLS[i % len(_SYMBOLS)] + ("-open" if s.locked_damper else ""),
                    "size": 11,
                    "color": colour,
                    "line": {"width": 2 if s.locked_damper else 1},
                },
                customdata=_told(update, s),
                hovertemplate="%{customdata}<extra></extra>",
            ),
        ]
    return traces


def _told(update: Update, s: Solution) -> list[str]:
    return [
        f"{p.name} = {scientific(float(value))} {p.unit}<br>valley {scientific(float(low))} … "
        f"{scientific(float(high))}<br>cost {scientific(s.cost)}, {s.found} starts"
        for p, value, (low, high) in zip(update.problem.parameters, s.theta, s.extent, strict=True)
    ]


def _broken(low: FloatArray, high: FloatArray) -> list[float | None]:
    """Return the abscissae of one line a parameter, interrupted in between."""
    return [x for ends in zip(low, high, strict=True) for x in (float(ends[0]), float(ends[1]), None)]
