"""Modes tracked over records: each record beside the fused estimate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.identification import FusedMode
from jackettwin.intervals import NORMAL_90, QUANTILES
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import words

MOST_POINTS = 1000
"""Number of records above which medians of neighbours are drawn."""
_ROW = 170


@dataclass(frozen=True)
class _Points:
    """Values of one mode over records with intervals and labels."""

    x: FloatArray
    y: FloatArray
    low: FloatArray
    high: FloatArray
    names: list[str]


def tracks(modes: Sequence[tuple[str, FusedMode]], records: Sequence[str]) -> go.Figure:
    """Draw f and ζ of every mode in every record with 90 % intervals; a band for all records together.

    Parameters
    ----------
    modes : sequence of (label, mode), at least one
    records : names of all records, in their order
    """
    n = len(modes)
    figure = make_subplots(
        rows=n, cols=2, shared_xaxes=True, vertical_spacing=0.16 / n, horizontal_spacing=0.1
    )
    for row, (label, mode) in enumerate(modes, start=1):
        seen = mode.sightings
        std = np.sqrt(np.diagonal(seen.log_covariance, axis1=1, axis2=2))
        names = [records[r] for r in seen.record]
        sides = (
            (seen.frequency_hz, std[:, 0], 1.0, mode.frequency_interval_90),
            (seen.damping_ratio, std[:, 1], 100.0, mode.damping_ratio_interval_90),
        )
        for col, (value, log_std, scale, (low, high)) in enumerate(sides, start=1):
            reach = np.exp(NORMAL_90 * np.nan_to_num(log_std))
            points = _Points(
                np.asarray(seen.record + 1.0),
                scale * value,
                scale * value / reach,
                scale * value * reach,
                names,
            )
            _draw(figure, label, _thinned(points), row=row, col=col)
            colour = style.rgba(style.mode_look(label).colour, 0.25)
            if mode.uncertainty_known:
                figure.add_hrect(
                    y0=scale * low, y1=scale * high, fillcolor=colour, line_width=0, row=row, col=col
                )
        figure.update_yaxes(title_text=f"{words(label)}<br>{style.title('f', 'Hz')}", row=row, col=1)
        figure.update_yaxes(title_text=style.title("ζ", "%"), rangemode="tozero", row=row, col=2)
    figure.update_xaxes(title_text=style.title("record, in the order given", "-"), row=n)
    return style.finish(
        figure, height=90 + _ROW * n, showlegend=False, margin={"l": 90, "r": 24, "t": 24, "b": 54}
    )


def _thinned(points: _Points) -> _Points:
    """Return medians of neighbours with the range of nine in ten, if there are too many points."""
    if len(points.x) <= MOST_POINTS:
        return points
    parts = np.array_split(np.arange(len(points.x)), MOST_POINTS // 2)
    low, high = np.array([np.quantile(points.y[part], QUANTILES[::2]) for part in parts]).T
    x, y = (np.array([np.median(values[part]) for part in parts]) for values in (points.x, points.y))
    names = [f"{points.names[part[0]]} to {points.names[part[-1]]}" for part in parts]
    return _Points(x, y, low, high, names)


def _draw(figure: go.Figure, label: str, points: _Points, *, row: int, col: int) -> None:
    look = style.mode_look(label)
    figure.add_scatter(
        x=points.x,
        y=points.y,
        mode="markers",
        name=words(label),
        marker={"color": look.colour, "size": 6 if len(points.x) < MOST_POINTS // 2 else 3},
        error_y={
            "type": "data",
            "symmetric": False,
            "array": points.high - points.y,
            "arrayminus": points.y - points.low,
            "thickness": 1.0,
            "width": 0,
            "color": style.rgba(look.colour, 0.5),
        },
        customdata=points.names,
        hovertemplate="%{customdata}<br>%{y:.4g}<extra>" + words(label) + "</extra>",
        row=row,
        col=col,
    )
