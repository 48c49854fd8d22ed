"""Parameters through time: what was known after each day, and the slope through all days."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import timedelta

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.report.figures import style
from jackettwin.soil import parameter_words
from jackettwin.study import Followed

_DAY_MS = 86_400_000
"""A day on a time axis [ms]."""
_FEW_DAYS = 10
"""Days up to which each has its own tick: an axis in hours says nothing of days."""


def parameters_through_time(followed: Followed, names: Sequence[str]) -> go.Figure:
    """Draw parameters of the model after each day with their 90 % intervals, and the fitted slope."""
    units = [followed.units[name] for name in names]
    titles = [
        parameter_words(n) if u == "-" else style.title(parameter_words(n), u)
        for n, u in zip(names, units, strict=True)
    ]
    figure = make_subplots(
        rows=len(names), cols=1, shared_xaxes=True, vertical_spacing=0.24 / len(names), subplot_titles=titles
    )
    figure.update_annotations(x=0.0, xanchor="left", font={"size": 13})
    for row, name in enumerate(names, start=1):
        _points(figure, followed, name, row)
        if followed.drift is not None and name in followed.stiffness:
            _line(figure, followed, name, row)
    figure.update_yaxes(type="log", dtick="D2", tickformat=".1~g")  # whole numbers: no decade may be in view
    by_day = followed.moments == "day"
    form = "%d %b\n%Y" if by_day else "%H:%M\n%d %b %Y"
    figure.update_xaxes(type="date", tickformat=form, row=len(names), col=1, title="time (UTC)")
    if by_day and len(followed.days) <= _FEW_DAYS:
        half = timedelta(hours=15)  # with one day alone the axis would hold no midnight, and no date
        ends = [followed.days[0].time_utc - half, followed.days[-1].time_utc + half]
        figure.update_xaxes(dtick=_DAY_MS, range=ends)
    return style.finish(
        figure,
        height=110 + 170 * len(names),
        legend={**style.LEGEND_ABOVE, "y": 1.0, "yref": "container", "yanchor": "top"},
    )


def _points(figure: go.Figure, followed: Followed, name: str, row: int) -> None:
    median = np.array([day.median[name] for day in followed.days])
    low, high = np.array([day.interval_90[name] for day in followed.days]).T
    figure.add_scatter(
        x=[day.time_utc for day in followed.days],
        y=median,
        error_y={"type": "data", "symmetric": False, "array": high - median, "arrayminus": median - low},
        mode="markers",
        marker={"size": 8, "color": style.law_look(followed.law).colour},
        name=f"known after the {followed.moments}, 90 %",
        legendgroup="points",
        showlegend=row == 1,
        row=row,
        col=1,
    )


def _line(figure: go.Figure, followed: Followed, name: str, row: int) -> None:
    if followed.drift is None:
        return
    times = [day.time_utc for day in followed.days]
    median, low, high = followed.drift.line(name, followed.days_since_first).T
    colour = style.GREY
    figure.add_scatter(
        x=[*times, *times[::-1]],
        y=[*high, *low[::-1]],
        fill="toself",
        fillcolor=style.rgba(colour, 0.2),
        mode="lines",  # of few days the band's corners would be drawn as points
        line={"width": 0},
        hoverinfo="skip",
        name="slope through all, 90 %",
        legendgroup="line",
        showlegend=row == 1,
        row=row,
        col=1,
    )
    figure.add_scatter(
        x=times,
        y=median,
        mode="lines",
        line={"color": colour, "width": 2},
        showlegend=False,
        legendgroup="line",
        name="slope through all",
        row=row,
        col=1,
    )
