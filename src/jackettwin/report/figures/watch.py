"""Figures of monitored modes: unexplained variation, evidence, and the pattern of a change by cause."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from textwrap import wrap

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.change import Alarm, MonitoredTable, verdict_words
from jackettwin.intervals import NORMAL_90
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import words
from jackettwin.watching import CLEAR

_CAUSE_WIDTH = 18
"""Letters per line of a cause's name at its alarm."""
_SHOWN_IN = {"frequency": (100.0, "%"), "damping": (100.0, "%"), "angle": (180.0 / np.pi, "°")}
"""Display units of changes of each kind."""
_SYMBOLS = ("diamond-open", "square-open", "triangle-up-open")
_COLOURS = (style.BLUE, style.GREEN, style.ORANGE)


def leading(watched: MonitoredTable) -> int:
    """Return the index of the quantity in which the first alarm is clearest, or of the first quantity."""
    if not watched.alarms:
        return 0
    change = watched.alarms[0].change
    return int(np.argmax(np.where(change.members, change.by_mode, -1.0)))


def frequencies(watched: MonitoredTable) -> tuple[int, ...]:
    """Return the indices of frequencies and directions, or all if there are none."""
    chosen = tuple(i for i, (kind, _) in enumerate(watched.watch.quantities) if kind != "damping")
    return chosen or tuple(range(len(watched.watch.quantities)))


def unexplained_through_time(watched: MonitoredTable, chosen: Sequence[int]) -> go.Figure:
    """Draw daily residuals of some quantities after the effects of conditions, with band and alarms."""
    figure = make_subplots(rows=len(chosen), cols=1, shared_xaxes=True, vertical_spacing=0.03)
    for row, i in enumerate(chosen, start=1):
        _line(figure, watched, i, row)
        for number in range(len(watched.alarms)):
            _mark(figure, watched, number, i, row, named=row == 1 and number == 0)
        kind = watched.watch.quantities[i][0]
        figure.update_yaxes(
            title=style.title(_named(watched, i).replace(", ", ",<br>"), _SHOWN_IN[kind][1]), row=row, col=1
        )
    figure.update_xaxes(title="time (UTC)", row=len(chosen), col=1)
    return style.finish(figure, height=max(340, 150 * len(chosen) + 80))


def _named(watched: MonitoredTable, i: int) -> str:
    """Return the label of a quantity in figures."""
    kind, mode = watched.watch.quantities[i]
    return (
        words(watched.watch.labels[mode])
        + {"frequency": "", "damping": ", damping", "angle": ", direction"}[kind]
    )


def _line(figure: go.Figure, watched: MonitoredTable, i: int, row: int) -> None:
    times = [watched.table.time(look.day) for look in watched.looks]
    scale = _SHOWN_IN[watched.watch.quantities[i][0]][0]
    rest = scale * np.array([look.rest[i] for look in watched.looks])
    half = scale * NORMAL_90 * np.array([look.rest_std[i] for look in watched.looks])
    seen = np.isfinite(rest) & np.isfinite(half)
    kept = [t for t, good in zip(times, seen, strict=True) if good]
    place = {"row": row, "col": 1, "showlegend": row == 1}
    figure.add_scatter(
        x=[*kept, *kept[::-1]], y=[*half[seen], *-half[seen][::-1]], fill="toself",
        fillcolor=style.rgba(style.GREY, 0.2), line={"width": 0}, hoverinfo="skip",
        name="90 % if unchanged", legendgroup="band", **place,
    )  # fmt: skip
    figure.add_scatter(
        x=kept, y=rest[seen], mode="markers", marker={"size": 4, "color": style.BLUE},
        name="day's mean", legendgroup="days", **place,
    )  # fmt: skip


def _mark(figure: go.Figure, watched: MonitoredTable, number: int, i: int, row: int, *, named: bool) -> None:
    change, document, table = watched.alarms[number].change, watched.documents[number], watched.table
    low, high = (table.time(day) for day in change.began_interval_90)
    at = datetime.fromisoformat(document["time_utc"])
    figure.add_vrect(x0=low, x1=high, fillcolor=style.ORANGE, opacity=0.25, line_width=0, row=row, col=1)
    figure.add_vline(x=at, line={"color": style.VERMILLION, "width": 2}, row=row, col=1)
    if named:
        now = document["verdicts"][-1]
        said = verdict_words(now) if now["probability"] >= CLEAR else "cause not clear"
        figure.add_annotation(
            x=at, y=1.0, yref="y domain", xanchor="left", yanchor="top", xshift=6, showarrow=False,
            bgcolor="white", align="left", text="<br>".join(wrap(said, _CAUSE_WIDTH)), row=row, col=1,
        )  # fmt: skip
    if change.kind == "scatter" or not change.members[i]:
        return
    end = table.time(watched.looks[-1].day)
    size = _SHOWN_IN[watched.watch.quantities[i][0]][0] * change.size[i]
    figure.add_scatter(
        x=[table.time(change.began), end], y=[size] * 2, mode="lines",
        line={"color": style.VERMILLION, "width": 2}, name="change found", legendgroup="change",
        showlegend=named, row=row, col=1,
    )  # fmt: skip


def evidence_through_time(watched: MonitoredTable) -> go.Figure:
    """Draw ln R over time and the threshold."""
    times = [watched.table.time(look.day) for look in watched.looks]
    figure = go.Figure()
    figure.add_scatter(x=times, y=[look.log_r for look in watched.looks], mode="lines",
                       line={"color": style.BLUE}, name="ln R")  # fmt: skip
    figure.add_scatter(x=[times[0], times[-1]], y=[watched.watch.log_threshold] * 2, mode="lines",
                       line={"color": style.VERMILLION, "dash": "dash"}, name="alarm")  # fmt: skip
    figure.update_yaxes(title="evidence for a change, ln R [-]")
    figure.update_xaxes(title="time (UTC)")
    return style.finish(figure, height=320)


def explained_shares(watched: MonitoredTable) -> go.Figure:
    """Draw the shares of each quantity's variance over the baseline by condition."""
    keys = watched.watch.quantities
    labels = [_named(watched, i) for i in range(len(keys))]
    names = list(dict.fromkeys(name for key in keys for name in watched.explained[key]))
    figure = go.Figure()
    for name in names:
        share = [100.0 * max(watched.explained[key].get(name, 0.0), 0.0) for key in keys]
        figure.add_bar(y=labels, x=share, name=name, orientation="h")
    figure.update_xaxes(title=style.title("share of the variance", "%"))
    figure.update_layout(barmode="stack")
    return style.finish(figure, height=max(300, 34 * len(keys) + 130))


def change_pattern(watched: MonitoredTable, alarm: Alarm) -> go.Figure:
    """Draw the change of each quantity with its 90 % interval, and the predictions of likely causes."""
    keys = watched.watch.quantities
    change = alarm.change
    kinds = [kind for kind in _SHOWN_IN if any(key[0] == kind for key in keys)]
    of_kind = [[i for i, key in enumerate(keys) if key[0] == kind] for kind in kinds]
    height = 34 * len(keys) + 90 * len(kinds) + 60
    figure = make_subplots(
        rows=len(kinds), cols=1, vertical_spacing=70 / height, row_heights=[len(own) + 1 for own in of_kind]
    )
    for row, (kind, chosen) in enumerate(zip(kinds, of_kind, strict=True), start=1):
        names = [words(watched.watch.labels[keys[i][1]]) for i in chosen]
        place = {"row": row, "col": 1, "showlegend": row == 1}
        scale, unit = (100.0, "%") if change.kind == "scatter" else _SHOWN_IN[kind]
        figure.add_scatter(
            x=[scale * change.size[i] for i in chosen], y=names,
            error_x={"type": "data", "array": [scale * NORMAL_90 * change.size_std[i] for i in chosen]},
            mode="markers", marker={"size": 10, "color": style.VERMILLION}, name="seen, 90 %",
            legendgroup="seen", **place,
        )  # fmt: skip
        for (cause, step), symbol, colour in zip(alarm.patterns.items(), _SYMBOLS, _COLOURS, strict=False):
            figure.add_scatter(
                x=scale * step[chosen], y=names, mode="markers", name=cause, legendgroup=cause,
                marker={"size": 12, "symbol": symbol, "color": colour, "line": {"width": 2}}, **place,
            )  # fmt: skip
        what = "noise" if change.kind == "scatter" else {"angle": "direction"}.get(kind, kind)
        figure.update_xaxes(title=style.title(f"change of {what}", unit), row=row, col=1)
    return style.finish(figure, height=height)
