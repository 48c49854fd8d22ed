"""Figures of an identification: stabilisation diagrams, intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.identification import Identification, ModalEstimate, Spectrum
from jackettwin.intervals import log_interval_90
from jackettwin.report.figures import style
from jackettwin.report.tables import numbers
from jackettwin.report.tables.numbers import words

_STEP = 2.4
"""Distance of the bars above the poles, in model orders."""
_FEWEST_LINES = 20
"""Spectral lines below which a spectrum is too coarse to draw behind poles."""
_BEHIND = 3
"""Number of singular values behind the poles: two rise together where two modes are close."""


class _PoleClass(NamedTuple):
    """Appearance of one class of poles."""

    name: str
    colour: str
    symbol: str
    size: int


_CLASSES = (
    _PoleClass("unstable", style.PALE, "x-thin-open", 4),
    _PoleClass("stable in frequency", style.SKY, "circle-open", 5),
    _PoleClass("stable in frequency, damping and shape", style.INK, "circle", 4),
)


def stabilisation(
    found: Identification, names: Sequence[str], *, band: tuple[float, float] | None = None
) -> go.Figure:
    """Draw poles of every model order over frequency with the singular values; accepted modes as lines.

    Parameters
    ----------
    names : sequence of str
        Label of each of ``found.modes`` (``""`` for one the model lacks).
    band : (low, high) [Hz], optional
        Only these frequencies.
    """
    s = found.stabilisation
    low, high = band or (0.0, _upper(found))
    inside = (s.frequency_hz >= low) & (s.frequency_hz <= high)
    figure = go.Figure()
    _background(figure, found.spectrum, low, high)
    unstable, frequency_only = ~s.stable_frequency, s.stable_frequency & ~s.stable
    for look, chosen in zip(_CLASSES, (unstable, frequency_only, s.stable), strict=True):
        spread = None if look.name != _CLASSES[-1].name else s.frequency_std_hz
        _poles(figure, found, s.frequency_hz, chosen & inside, look, spread)
    modes = [(n, m) for n, m in zip(names, found.modes, strict=True) if low <= m.frequency_hz <= high]
    _lines(figure, [(n, m.frequency_hz, frequency_interval(m), m) for n, m in modes], (low, high))
    return _order_axes(figure, style.title("frequency", "Hz"), (low, high))


def stabilisation_damping(found: Identification, names: Sequence[str]) -> go.Figure:
    """Draw poles of every model order over damping, those of each mode in its colour.

    Since the intervals of the modes overlap, they are bars above the poles, at the ends of the modes' lines.
    """
    s = found.stabilisation
    limits = (0.0, _damping_limit(found))
    zeta = 100.0 * s.damping_ratio
    top = max(found.settings.orders, default=0)
    figure = go.Figure()
    _poles(figure, found, zeta, s.cluster < 0, _CLASSES[0]._replace(name="no mode's pole"), None)
    marks: list[tuple[str, float, tuple[float, float] | None, ModalEstimate]] = []
    for k, (name, mode) in enumerate(zip(names, found.modes, strict=True)):
        look = style.mode_look(name)
        text = words(name) if name else f"{mode.frequency_hz:.3f} Hz"
        own = _PoleClass(text, look.colour, look.symbol, 5)
        _poles(figure, found, zeta, s.cluster == k, own, None)
        _bar(figure, mode, top + _STEP * (k + 1), look)
        marks.append((name, 100.0 * mode.damping_ratio, None, mode))
    _lines(figure, marks, limits)
    _order_axes(figure, style.title("damping ratio", "%"), limits)
    highest = top + _STEP * (len(found.modes) + 1)
    return figure.update_layout(yaxis={"range": [0.0, highest], "tickvals": list(range(0, top + 1, 10))})


def _bar(figure: go.Figure, mode: ModalEstimate, y: float, look: style.Appearance) -> None:
    """Draw the 90 % interval of a mode's damping as a bar."""
    bounds = damping_interval(mode)
    if bounds is None:
        return
    figure.add_scatter(
        x=[100.0 * bounds[0], 100.0 * mode.damping_ratio, 100.0 * bounds[1]],
        y=[y, y, y],
        mode="lines+markers",
        line={"color": look.colour, "width": 3},
        marker={
            "color": look.colour,
            "symbol": ["line-ns", "circle", "line-ns"],
            "size": [9, 7, 9],
            "line": {"width": 2, "color": look.colour},
        },
        hovertemplate=f"ζ {numbers.interval(bounds, 100.0, 2)} %<extra>90 %</extra>",
        showlegend=False,
    )


def damping_against_frequency(found: Identification, names: Sequence[str]) -> go.Figure:
    """Draw stable poles as damping over frequency (thesis figure 6.2), with the accepted modes on top."""
    s = found.stabilisation
    figure = go.Figure()
    for name, chosen, colour, size in (
        ("other pole", ~s.stable, style.PALE, 3),
        ("stable pole", s.stable, style.GREY, 4),
    ):
        figure.add_scatter(
            x=s.frequency_hz[chosen],
            y=100.0 * s.damping_ratio[chosen],
            mode="markers",
            name=name,
            marker={"color": colour, "size": size, "symbol": "circle" if size == 4 else "x-thin-open"},
            customdata=s.order[chosen],
            hovertemplate="order %{customdata}<br>f %{x:.4f} Hz<br>ζ %{y:.2f} %<extra></extra>",
        )
    for label, mode in zip(names, found.modes, strict=True):
        look = style.mode_look(label)
        low_high = damping_interval(mode)
        error = None if low_high is None else _asymmetric(100.0 * mode.damping_ratio, low_high, 100.0)
        figure.add_scatter(
            x=[mode.frequency_hz],
            y=[100.0 * mode.damping_ratio],
            mode="markers",
            error_y=error,
            name=words(label) if label else f"not in the model, {mode.frequency_hz:.3f} Hz",
            marker={
                "color": look.colour,
                "symbol": look.symbol,
                "size": 11,
                "line": {"width": 2, "color": look.colour},
            },
            hovertemplate="f %{x:.4f} Hz<br>ζ %{y:.2f} %<extra></extra>",
        )
    return style.finish(
        figure,
        height=520,
        xaxis={"title": {"text": style.title("frequency", "Hz")}, "range": [0.0, _upper(found)]},
        yaxis={"title": {"text": style.title("damping ratio", "%")}, "range": [0.0, _damping_limit(found)]},
        margin={"l": 70, "r": 24, "t": 104, "b": 54},
    )


def intervals(modes: Sequence[tuple[str, ModalEstimate]]) -> go.Figure:
    """Draw each mode's frequency (relative to its value) and damping with 90 % intervals."""
    figure = make_subplots(rows=1, cols=2, horizontal_spacing=0.06, shared_yaxes=True)
    names = [
        f"{words(label) if label else 'not in the model'}, {mode.frequency_hz:.4f} Hz"
        for label, mode in modes
    ]
    for name, (label, mode) in zip(names, modes, strict=True):
        look = style.mode_look(label)
        marker = {
            "color": look.colour,
            "symbol": look.symbol,
            "size": 10,
            "line": {"width": 2, "color": look.colour},
        }
        f, zeta = frequency_interval(mode), damping_interval(mode)
        relative = None if f is None else tuple(100.0 * (v / mode.frequency_hz - 1.0) for v in f)
        figure.add_scatter(
            x=[0.0],
            y=[name],
            mode="markers",
            marker=marker,
            row=1,
            col=1,
            showlegend=False,
            error_x=None if relative is None else _asymmetric(0.0, relative, 1.0),
            hovertemplate=f"{numbers.interval(f, 1.0, 4)} Hz<extra>90 %</extra>",
        )
        figure.add_scatter(
            x=[100.0 * mode.damping_ratio],
            y=[name],
            mode="markers",
            marker=marker,
            row=1,
            col=2,
            showlegend=False,
            error_x=None if zeta is None else _asymmetric(100.0 * mode.damping_ratio, zeta, 100.0),
            hovertemplate=f"{numbers.interval(zeta, 100.0, 2)} %<extra>90 %</extra>",
        )
    figure.update_xaxes(title_text=style.title("frequency around its estimate", "%"), row=1, col=1)
    figure.update_xaxes(title_text=style.title("damping ratio", "%"), rangemode="tozero", row=1, col=2)
    figure.update_yaxes(autorange="reversed", type="category")
    return style.finish(figure, height=150 + 34 * len(modes), margin={"l": 180, "r": 24, "t": 16, "b": 54})


def frequency_interval(mode: ModalEstimate) -> tuple[float, float] | None:
    """Return the 90 % interval of the frequency [Hz], if any uncertainty is known."""
    if mode.frequency_interval_90 is not None or mode.frequency_std_hz is None:
        return mode.frequency_interval_90
    return log_interval_90(mode.frequency_hz, mode.frequency_std_hz / mode.frequency_hz)


def damping_interval(mode: ModalEstimate) -> tuple[float, float] | None:
    """Return the 90 % interval of the damping ratio, if any uncertainty is known."""
    if mode.damping_ratio_interval_90 is not None or mode.damping_ratio_std is None:
        return mode.damping_ratio_interval_90
    return log_interval_90(mode.damping_ratio, mode.damping_ratio_std / mode.damping_ratio)


def _asymmetric(value: float, low_high: tuple[float, ...], scale: float) -> dict[str, object]:
    low, high = (scale * v for v in low_high)
    return {
        "type": "data",
        "symmetric": False,
        "array": [high - value],
        "arrayminus": [value - low],
        "thickness": 1.6,
    }


def _background(figure: go.Figure, spectrum: Spectrum, low: float, high: float) -> None:
    f = spectrum.frequencies_hz
    keep = (f >= max(low, float(f[1]))) & (f <= high)
    if keep.sum() < _FEWEST_LINES:
        return
    for k, values in enumerate(spectrum.singular_values[:_BEHIND]):
        figure.add_scatter(
            x=f[keep],
            y=values[keep],
            yaxis="y2",
            mode="lines",
            name=f"singular value {k + 1}",
            line={"color": style.rgba(style.ORANGE, 0.9 / (k + 1)), "width": 1.3 if k == 0 else 0.9},
            hovertemplate="%{x:.4f} Hz<br>%{y:.3g} 1/Hz<extra></extra>",
        )


def _poles(
    figure: go.Figure,
    found: Identification,
    x: FloatArray,
    chosen: BoolArray,
    look: _PoleClass,
    spread: FloatArray | None,
) -> None:
    s = found.stabilisation
    bars = None
    if spread is not None:
        faint = style.rgba(style.GREY, 0.4)
        bars = {
            "type": "data",
            "array": np.nan_to_num(spread[chosen]),
            "thickness": 0.6,
            "width": 0,
            "color": faint,
        }
    figure.add_scatter(
        x=x[chosen],
        y=s.order[chosen],
        mode="markers",
        name=look.name,
        error_x=bars,
        marker={"color": look.colour, "symbol": look.symbol, "size": look.size, "line": {"width": 1}},
        customdata=np.column_stack([s.frequency_hz[chosen], 100.0 * s.damping_ratio[chosen]]),
        hovertemplate="order %{y}<br>f %{customdata[0]:.4f} Hz<br>ζ %{customdata[1]:.2f} %<extra></extra>",
    )


def _lines(
    figure: go.Figure,
    marks: Sequence[tuple[str, float, tuple[float, float] | None, ModalEstimate]],
    limits: tuple[float, float],
) -> None:
    """Draw the accepted modes as lines behind the poles, their 90 % intervals as bands."""
    texts = []
    for label, x, interval_90, mode in marks:
        look = style.mode_look(label)
        if interval_90 is not None:
            figure.add_vrect(*interval_90, fillcolor=look.colour, opacity=0.12, line_width=0, layer="below")
        figure.add_vline(x=x, line={"color": look.colour, "width": 1.4, "dash": look.dash}, layer="below")
        texts.append((x, words(label) if label else f"{mode.frequency_hz:.3f} Hz", look.colour))
    style.label_lines(figure, texts, limits)


def _order_axes(figure: go.Figure, title: str, limits: tuple[float, float]) -> go.Figure:
    return style.finish(
        figure,
        height=600,
        xaxis={"title": {"text": title}, "range": limits},
        yaxis={"title": {"text": style.title("model order", "-")}, "rangemode": "tozero"},
        yaxis2={
            "title": {"text": style.title("singular values", "1/Hz")},
            "overlaying": "y",
            "side": "right",
            "type": "log",
            "showgrid": False,
            "exponentformat": "power",
            "dtick": 1,
        },
        margin={"l": 70, "r": 80, "t": 110, "b": 84},
        legend=style.LEGEND_BELOW,
    )


def _upper(found: Identification) -> float:
    highest = max((m.frequency_hz for m in found.modes), default=found.settings.highest_frequency_hz)
    return min(found.settings.highest_frequency_hz, 1.35 * highest)


def _damping_limit(found: Identification) -> float:
    highest = max((m.damping_ratio for m in found.modes), default=0.05)
    return 100.0 * min(0.2, 2.0 * highest)
