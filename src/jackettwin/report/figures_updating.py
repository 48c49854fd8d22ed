"""Measured against updated: frequencies, damping, what no support explains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from jackettwin.report import style
from jackettwin.report.numbers import known, log_interval_95, words
from jackettwin.twin.result import DampingExcess, MeasuredMode
from jackettwin.updating import Update
from jackettwin.updating.solutions import LOCKED_DAMPER


def frequency_errors(measured: Sequence[MeasuredMode], updates: Sequence[Update]) -> go.Figure:
    """Draw updated against measured frequencies: differences in per cent, the measured 95 % as bars."""
    figure = go.Figure()
    shown = [(i, m) for i, m in enumerate(measured) if known(m.frequency_hz)]
    spans = [_relative_span(m.frequency_hz, m.frequency_std_hz) for _, m in shown]
    figure.add_scatter(
        x=[k + _offset(0, len(updates)) for k in range(len(shown))],
        y=[0.0] * len(shown),
        mode="markers",
        name="measured, 95 %",
        marker=_marker(style.MEASURED),
        error_y=_bars(spans),
        hovertemplate="%{customdata:.4f} Hz<extra>measured</extra>",
        customdata=[m.frequency_hz for _, m in shown],
    )
    for j, update in enumerate(updates):
        f = update.modes.frequency_hz
        figure.add_scatter(
            x=[k + _offset(j + 1, len(updates)) for k in range(len(shown))],
            y=[100.0 * (f[i] / float(m.frequency_hz or np.nan) - 1.0) for i, m in shown],
            mode="markers",
            name=update.law,
            marker=_marker(style.law_look(update.law)),
            customdata=[f[i] for i, _ in shown],
            hovertemplate=f"%{{customdata:.4f}} Hz (%{{y:+.2f}} %)<extra>{update.law}</extra>",
        )
    names = [_name(m, fitted=m.fits_frequency) for _, m in shown]
    return _by_mode(figure, names, style.title("f updated − f measured", "% of measured"))


def damping_comparison(measured: Sequence[MeasuredMode], updates: Sequence[Update]) -> go.Figure:
    """Draw measured and updated damping ratios; modes whose damping was not fitted say so."""
    figure = go.Figure()
    shown = [m for m in measured if known(m.damping_ratio)]
    spans = [_span(m.damping_ratio, m.damping_ratio_std) for m in shown]
    places = [k + _offset(0, len(updates)) for k, m in enumerate(measured) if known(m.damping_ratio)]
    figure.add_scatter(
        x=places,
        y=[100.0 * float(m.damping_ratio or 0.0) for m in shown],
        mode="markers",
        name="measured, 95 %",
        marker=_marker(style.MEASURED),
        error_y=_bars(spans),
        hovertemplate="%{y:.2f} %<extra>measured</extra>",
    )
    for j, update in enumerate(updates):
        figure.add_scatter(
            x=[k + _offset(j + 1, len(updates)) for k in range(len(measured))],
            y=100.0 * update.modes.damping_ratio,
            mode="markers",
            name=update.law,
            marker=_marker(style.law_look(update.law)),
            hovertemplate=f"%{{y:.2f}} %<extra>{update.law}</extra>",
        )
    names = [_name(m, fitted=m.fits_damping) for m in measured]
    figure = _by_mode(figure, names, style.title("damping ratio", "%"))
    return figure.update_yaxes(rangemode="tozero")


def damped_undamped(measured: Sequence[MeasuredMode], updates: Sequence[Update]) -> go.Figure:
    """Draw how far undamped frequencies lie from damped ones; past the dashed lines a damper is locked."""
    figure = go.Figure()
    names = [words(m.label) for m in measured]
    for update in updates:
        look = style.law_look(update.law)
        damped, undamped = update.modes.frequency_hz, update.modes.undamped_hz
        figure.add_bar(
            x=names,
            y=100.0 * (undamped / damped - 1.0),
            name=update.law,
            marker={
                "color": look.colour,
                "line": {"color": style.INK, "width": 0.8},
                "pattern": {"shape": _PATTERNS.get(update.law, ".")},
            },
            customdata=np.column_stack([damped, undamped]),
            hovertemplate="damped %{customdata[0]:.4f} Hz<br>undamped %{customdata[1]:.4f} Hz<br>%{y:+.2f} %"
            f"<extra>{update.law}</extra>",
        )
    limit = 100.0 * LOCKED_DAMPER
    for level in (limit, -limit):
        figure.add_hline(y=level, line={"color": style.VERMILLION, "width": 1.2, "dash": "dash"})
    figure.add_hline(y=0.0, line={"color": style.GREY, "width": 1})
    figure.add_annotation(
        x=1.0,
        xref="paper",
        xanchor="right",
        y=-limit,
        yanchor="top",
        showarrow=False,
        text="beyond: locked damper",
        font={"size": 11, "color": style.VERMILLION},
    )
    return style.finish(
        figure,
        height=420,
        barmode="group",
        xaxis={"title": {"text": "mode"}, "type": "category"},
        yaxis={"title": {"text": style.title("f undamped − f damped", "% of damped")}},
    )


def damping_excess(law: str, rows: Sequence[DampingExcess]) -> go.Figure:
    """Draw measured damping beside what the updated support gives, and the rotor."""
    names = [words(row.label) for row in rows]
    spans = [_span(row.measured, row.measured_std) for row in rows]
    figure = go.Figure()
    figure.add_bar(
        x=names,
        y=[100.0 * row.support for row in rows],
        name=f"steel and support ({law})",
        offsetgroup="model",
        marker={
            "color": style.law_look(law).colour,
            "line": {"color": style.INK, "width": 0.8},
            "pattern": {"shape": "/"},
        },
        hovertemplate="%{y:.2f} %<extra>steel and support</extra>",
    )
    if any(row.rotor > 1e-6 for row in rows):
        figure.add_bar(
            x=names,
            y=[100.0 * row.rotor for row in rows],
            base=[100.0 * row.support for row in rows],
            name="rotor's dashpot",
            offsetgroup="model",
            marker={
                "color": style.BLUE,
                "line": {"color": style.INK, "width": 0.8},
                "pattern": {"shape": "x"},
            },
            customdata=[100.0 * row.rotor for row in rows],
            hovertemplate="%{customdata:.2f} %<extra>rotor</extra>",
        )
    figure.add_bar(
        x=names,
        y=[100.0 * row.measured for row in rows],
        name="measured, 95 %",
        offsetgroup="measured",
        error_y=_bars(spans),
        marker={"color": style.PALE, "line": {"color": style.INK, "width": 0.8}},
        hovertemplate="%{y:.2f} %<extra>measured</extra>",
    )
    return style.finish(
        figure,
        height=400,
        barmode="group",
        bargap=0.45,
        xaxis={"title": {"text": "mode"}, "type": "category"},
        yaxis={"title": {"text": style.title("damping ratio", "%")}, "rangemode": "tozero"},
    )


_PATTERNS = {"kelvin-voigt": "", "zener": "/", "maxwell-3": "x", "springpot": "-"}


def _name(mode: MeasuredMode, *, fitted: bool) -> str:
    return words(mode.label) + ("" if fitted else "<br><i>not fitted</i>")


def _by_mode(figure: go.Figure, names: list[str], title: str) -> go.Figure:
    figure.add_hline(y=0.0, line={"color": style.GREY, "width": 1}, layer="below")
    for k in range(1, len(names)):
        figure.add_vline(x=k - 0.5, line={"color": style.GRID, "width": 1}, layer="below")
    return style.finish(
        figure,
        height=440,
        xaxis={
            "title": {"text": "mode"},
            "tickvals": list(range(len(names))),
            "ticktext": names,
            "range": [-0.5, len(names) - 0.5],
            "showgrid": False,
        },
        yaxis={"title": {"text": title}},
    )


def _offset(j: int, n_laws: int) -> float:
    """Return where the measured value (0) and the laws (1, 2 …) stand about a mode's place."""
    return min(0.14, 0.7 / max(n_laws, 1)) * (j - 0.5 * n_laws)


def _marker(look: style.Look) -> dict[str, object]:
    return {"color": look.colour, "symbol": look.symbol, "size": 10, "line": {"width": 1, "color": style.INK}}


def _span(value: float | None, std: float | None) -> tuple[float, float] | None:
    """Return how far the 95 % interval reaches (up, down) from a ratio, in per cent."""
    if value is None or std is None or not known(value) or value <= 0.0:
        return None
    low, high = log_interval_95(value, std)
    return 100.0 * (high - value), 100.0 * (value - low)


def _relative_span(value: float | None, std: float | None) -> tuple[float, float] | None:
    span = _span(value, std)
    return None if span is None or value is None else (span[0] / value, span[1] / value)


def _bars(spans: Sequence[tuple[float, float] | None]) -> dict[str, object] | None:
    if not any(spans):
        return None
    up, down = zip(*(span or (0.0, 0.0) for span in spans), strict=True)
    return {"type": "data", "symmetric": False, "array": up, "arrayminus": down, "thickness": 1.6, "width": 5}
