"""A record in time and in frequency."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.identification import ModalEstimate, Spectrum
from jackettwin.quantities import quantity
from jackettwin.records import Channel, Record
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import words

_BINS = 900
"""Number of minimum-maximum pairs drawn per channel, which exceeds the pixels of a screen."""


def time_series(record: Record, *, channels: Sequence[str] | None = None) -> go.Figure:
    """Draw every channel over time, one row each; long ones as the envelope of ``_BINS`` bins."""
    rows = (
        [record.channel_names.index(n) for n in channels]
        if channels is not None
        else range(len(record.channels))
    )
    chosen = [(record.channels[i], record.data[i]) for i in rows]
    n = len(chosen)
    figure = make_subplots(rows=n, cols=1, shared_xaxes=True, vertical_spacing=min(0.02, 0.5 / max(n, 1)))
    for row, (channel, y) in enumerate(chosen, start=1):
        t, shown = envelope(y, record.sample_rate_hz)
        unit = plain(channel.unit)
        figure.add_scatter(
            x=t,
            y=shown,
            mode="lines",
            row=row,
            col=1,
            name=channel.name,
            showlegend=False,
            line={"width": 0.8, "color": style.direction_colour(channel.direction)},
            hovertemplate=f"%{{x:.2f}} s<br>%{{y:.4g}} {unit}<extra>{channel.name}</extra>",
        )
        symbol = quantity(channel.quantity).symbol
        figure.update_yaxes(
            title_text=style.title(symbol, unit), title_font_size=12, nticks=4, row=row, col=1
        )
        axis = str(row) if row > 1 else ""
        figure.add_annotation(
            text=place(channel).replace(", ", "<br>"),
            xref="paper",
            yref=f"y{axis} domain",
            x=1.01,
            y=0.5,
            xanchor="left",
            align="left",
            showarrow=False,
            font={"size": 12, "color": style.direction_colour(channel.direction)},
        )
    figure.update_xaxes(title_text=style.title("time from the start of the record", "s"), row=n, col=1)
    return style.finish(figure, height=100 + 92 * n, margin={"l": 86, "r": 110, "t": 34, "b": 54})


def envelope(y: FloatArray, sample_rate_hz: float) -> tuple[FloatArray, FloatArray]:
    """Return (time, value) for drawing a signal: all samples, or the extremes of each bin in their order.

    A bin with a missing sample is drawn as a gap.
    """
    if y.size <= 4 * _BINS:
        return np.arange(y.size) / sample_rate_hz, y
    size = int(np.ceil(y.size / _BINS))
    padded = np.pad(y, (0, -y.size % size), mode="edge").reshape(-1, size)
    gap = np.isnan(padded).any(axis=1)
    filled = np.where(np.isnan(padded), 0.0, padded)
    ends = np.sort(np.stack([filled.argmin(axis=1), filled.argmax(axis=1)], axis=1), axis=1)
    values = np.take_along_axis(filled, ends, axis=1)
    values[gap] = np.nan
    t = (np.arange(len(padded))[:, None] * size + ends) / sample_rate_hz
    return t.ravel(), values.ravel()


def spectra(
    spectrum: Spectrum,
    channels: Sequence[Channel],
    modes: Sequence[tuple[str, ModalEstimate]],
    fit: Spectrum | None = None,
) -> go.Figure:
    """Draw power spectral densities above, singular values below; ``modes`` are (label, estimate).

    ``fit`` is the spectrum of the identified modes; its first two singular values are drawn.
    """
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.07, row_heights=[0.55, 0.45])
    f = spectrum.frequencies_hz
    keep = (f > 0.0) & (f <= _upper(f, modes))
    units = {plain(channel.unit) for channel in channels}
    unit = f"({next(iter(units))})²/Hz" if len(units) == 1 else "unit²/Hz"
    for channel, density, dash in zip(channels, spectrum.density, _dashes(channels), strict=True):
        figure.add_scatter(
            x=f[keep],
            y=density[keep],
            mode="lines",
            name=place(channel),
            row=1,
            col=1,
            line={
                "width": 1.3,
                "color": style.direction_colour(channel.direction),
                "dash": dash,
            },
            hovertemplate=f"%{{x:.4f}} Hz<br>%{{y:.3g}} {unit}<extra>{channel.name}</extra>",
        )
    greys = np.linspace(0, 190, min(4, len(spectrum.singular_values)))
    for k, (level, values) in enumerate(zip(greys, spectrum.singular_values, strict=False), start=1):
        shade = int(level)
        figure.add_scatter(
            x=f[keep],
            y=values[keep],
            mode="lines",
            row=2,
            col=1,
            name=f"singular value {k}",
            showlegend=False,
            line={"width": 1.6 if k == 1 else 1.1, "color": f"rgb({shade},{shade},{shade})"},
            hovertemplate="%{x:.4f} Hz<br>%{y:.3g} 1/Hz<extra>singular value " + str(k) + "</extra>",
        )
    limits = (0.0, _upper(f, modes))
    if fit is not None:
        _fit(figure, fit)
    _mark(figure, modes, limits)
    figure.update_yaxes(type="log", exponentformat="power", dtick=2)
    figure.update_yaxes(title_text=style.title("PSD", unit), row=1, col=1)
    figure.update_yaxes(title_text=style.title("singular values", "1/Hz"), row=2, col=1)
    figure.update_xaxes(range=limits)
    figure.update_xaxes(title_text=style.title("frequency", "Hz"), row=2, col=1)
    return style.finish(
        figure,
        height=760,
        margin={"l": 86, "r": 24, "t": 110, "b": 110},
        legend=style.LEGEND_BELOW | {"y": -0.1},
    )


def _dashes(channels: Sequence[Channel]) -> list[str]:
    """Return a dash for each channel, by height if all are known, else in turn within a direction."""
    dashes = ("solid", "dash", "dot", "dashdot")
    heights = [channel.height_m for channel in channels if channel.height_m is not None]
    if len(heights) == len(channels):
        levels = sorted(set(heights), reverse=True)
        return [dashes[levels.index(height) % 4] for height in heights]
    turn: Counter[str] = Counter()
    out = []
    for channel in channels:
        colour = style.direction_colour(channel.direction)
        out.append(dashes[turn[colour] % 4])
        turn[colour] += 1
    return out


def _fit(figure: go.Figure, fit: Spectrum) -> None:
    for k, values in enumerate(fit.singular_values[:2], start=1):
        figure.add_scatter(
            x=fit.frequencies_hz,
            y=values,
            mode="lines",
            row=2,
            col=1,
            name="identified modes only",
            legendgroup="fit",
            showlegend=k == 1,
            line={"width": 2.2 if k == 1 else 1.6, "color": style.rgba(style.ORANGE, 0.85)},
            hovertemplate="%{x:.4f} Hz<br>%{y:.3g} 1/Hz<extra>modes alone, " + str(k) + "</extra>",
        )


def _upper(f: FloatArray, modes: Sequence[tuple[str, ModalEstimate]]) -> float:
    highest = max((mode.frequency_hz for _, mode in modes), default=float(f[-1]))
    return min(float(f[-1]), 1.6 * highest)


def _mark(figure: go.Figure, modes: Sequence[tuple[str, ModalEstimate]], limits: tuple[float, float]) -> None:
    marks = []
    for label, mode in modes:
        look = style.mode_look(label)
        line = {"color": look.colour, "width": 1.2, "dash": "dash"}
        figure.add_vline(x=mode.frequency_hz, line=line, layer="below", row="all", col=1)
        text = words(label) if label else f"{mode.frequency_hz:.3f} Hz"
        marks.append((mode.frequency_hz, text, look.colour))
    style.label_lines(figure, marks, limits)


def place(channel: Channel) -> str:
    """Return the label of a channel: name and position."""
    where = (
        f", {channel.height_m:g} m"
        if channel.height_m is not None
        else f", {channel.node}"
        if channel.node
        else ""
    )
    return f"{channel.name}{where}"


def plain(unit: str) -> str:
    """Return a unit as printed: ``m/s²``."""
    return unit.replace("^2", "²").replace("^3", "³")
