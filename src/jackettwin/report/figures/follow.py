"""Parameters through time: their values after each day, and the slope over all days."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.soil import parameter_words
from jackettwin.study import Followed

_DAY_MS = 86_400_000
"""A day on a time axis [ms]."""
_FEW_DAYS = 10
"""Number of days up to which each has its own tick."""


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
        if followed.drift is not None and not followed.changes and name in followed.stiffness:
            _line(figure, followed, name, row)
    figure.update_yaxes(type="log", dtick="D2", tickformat=".1~g")  # there may be no decade in view
    by_day = followed.moments == "day"
    form = "%d %b\n%Y" if by_day else "%H:%M\n%d %b %Y"
    figure.update_xaxes(type="date", tickformat=form, row=len(names), col=1, title="time (UTC)")
    if by_day and len(followed.days) <= _FEW_DAYS:
        half = timedelta(hours=15)  # with a single day the axis would contain no midnight, and no date
        ends = [followed.days[0].time_utc - half, followed.days[-1].time_utc + half]
        figure.update_xaxes(dtick=_DAY_MS, range=ends)
    return style.finish(
        figure,
        height=110 + 170 * len(names),
        legend={**style.LEGEND_ABOVE, "y": 1.0, "yref": "container", "yanchor": "top"},
    )


def stiffness_in_time(followed: Followed) -> go.Figure:
    """Draw the ratio of each day's stiffness to the first day's: as known then, as known now, expected."""
    figure, colour = go.Figure(), style.law_look(followed.law).colour
    dates = [datetime.fromisoformat(date).replace(hour=12, tzinfo=UTC) for date in followed.smoothed]
    by_now = np.array([level.relative for level in followed.smoothed.values()])
    _band(figure, dates, by_now, colour, "by all days")
    known = [day for day in followed.days if day.relative is not None]
    then = np.array([day.relative for day in known])
    figure.add_scatter(
        x=[day.time_utc for day in known],
        y=then[:, 1],
        error_y={"type": "data", "symmetric": False, "array": then[:, 2] - then[:, 1],
                 "arrayminus": then[:, 1] - then[:, 0], "thickness": 0.6, "width": 0},
        mode="markers",
        marker={"size": 4, "color": style.GREY},
        name="known on the day, 90 %",
    )  # fmt: skip
    most = max(min(followed.ahead), followed.days_since_first[-1])  # at most as far as the past
    shown = {days: level for days, level in followed.ahead.items() if days <= most}
    ahead = [known[-1].time_utc + timedelta(days=days) for days in shown]
    expected = np.array([then[-1], *(level.relative for level in shown.values())])
    _band(figure, [known[-1].time_utc, *ahead], expected, style.GREY, "expected", dash="dot")
    figure.update_yaxes(title="stiffness relative to the first day")
    figure.update_xaxes(type="date", title="time (UTC)")
    return style.finish(figure, height=420, legend=style.LEGEND_ABOVE)


def _band(
    figure: go.Figure,
    times: Sequence[datetime],
    spans: FloatArray,
    colour: str,
    name: str,
    dash: str = "solid",
) -> None:
    low, middle, high = spans.T
    figure.add_scatter(
        x=[*times, *times[::-1]], y=[*high, *low[::-1]], fill="toself", fillcolor=style.rgba(colour, 0.2),
        mode="lines", line={"width": 0}, hoverinfo="skip", name=f"{name}, 90 %", showlegend=False,
    )  # fmt: skip
    figure.add_scatter(
        x=list(times), y=middle, mode="lines", line={"color": colour, "width": 2, "dash": dash},
        name=f"{name}, 90 %",
    )  # fmt: skip


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
        mode="lines",  # otherwise the corners of a band of few days are drawn as points
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
