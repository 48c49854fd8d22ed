"""MAC between identified shapes, their complexity, and intervals as records are added."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.identification import Identification, ModalEstimate, mac
from jackettwin.identification.many_records.convergence import Step
from jackettwin.identification.mode_shapes import mpc
from jackettwin.report.figures import style
from jackettwin.report.tables.numbers import words

_COLUMNS = 4
_LABEL_FROM = 0.05
"""Smallest MAC that is printed in its cell."""


def mac_matrix(found: Identification, names: Sequence[str]) -> go.Figure:
    """Draw the MAC between all modes; large values off the diagonal are modes the sensors cannot separate."""
    labels = [_label(name, mode) for name, mode in zip(names, found.modes, strict=True)]
    shapes = np.array([mode.mode_shape for mode in found.modes])
    values = mac(shapes, shapes)
    figure = go.Figure(
        go.Heatmap(
            x=labels,
            y=labels,
            z=values,
            zmin=0.0,
            zmax=1.0,
            colorscale=[[0.0, "#ffffff"], [1.0, style.BLUE]],
            text=[["" if v < _LABEL_FROM else f"{v:.2f}" for v in row] for row in values],
            texttemplate="%{text}",
            hovertemplate="%{y}<br>%{x}<br>MAC %{z:.3f}<extra></extra>",
            colorbar={"title": {"text": style.title("MAC", "-")}},
            xgap=1,
            ygap=1,
        )
    )
    figure.update_xaxes(title_text="mode", tickangle=-45, type="category", constrain="domain")
    figure.update_yaxes(
        title_text="mode", autorange="reversed", type="category", scaleanchor="x", constrain="domain"
    )
    size = 180 + 44 * len(labels)
    return style.finish(figure, height=size, margin={"l": 160, "r": 24, "t": 16, "b": 140})


def complexity(found: Identification, names: Sequence[str]) -> go.Figure:
    """Draw every mode's shape as SSI found it in the complex plane: a real shape lies on a line."""
    n = len(found.modes)
    rows = -(-n // _COLUMNS)
    titles = [
        f"{_label(name, mode)}<br>MPC {float(mpc((mode.unrefined or mode).mode_shape)):.2f}"
        for name, mode in zip(names, found.modes, strict=True)
    ]
    figure = make_subplots(
        rows=rows, cols=min(_COLUMNS, n), subplot_titles=titles, vertical_spacing=0.36 / rows
    )
    for k, (name, mode) in enumerate(zip(names, found.modes, strict=True)):
        at = {"row": k // _COLUMNS + 1, "col": k % _COLUMNS + 1}
        colour = style.mode_look(name).colour
        for channel, value in zip(found.channels, (mode.unrefined or mode).mode_shape, strict=True):
            figure.add_scatter(
                x=[0.0, value.real],
                y=[0.0, value.imag],
                mode="lines+markers",
                line={"color": colour, "width": 1.6},
                marker={"size": [0, 6], "color": colour},
                showlegend=False,
                hovertemplate=f"{channel.name}<br>%{{x:.3f}} + %{{y:.3f}} i<extra></extra>",
                **at,
            )
    figure.update_xaxes(range=[-1.15, 1.15], dtick=1, title_text=style.title("real part", "-"))
    figure.update_yaxes(range=[-1.15, 1.15], dtick=1, title_text=style.title("imaginary part", "-"))
    figure.update_annotations(font_size=12)
    return style.finish(figure, height=80 + 290 * rows, margin={"l": 50, "r": 24, "t": 60, "b": 40})


def interval_history(histories: Sequence[tuple[str, Sequence[Step]]]) -> go.Figure:
    """Draw damping ratios with their 90 % intervals after 1, 2, 4, … records.

    Parameters
    ----------
    histories : sequence of (label, steps)
    """
    figure = go.Figure()
    numbers = sorted({step.n_records for _, steps in histories for step in steps})
    for label, steps in histories:
        look = style.mode_look(label)
        n = [step.n_records for step in steps]
        zeta = np.array([100.0 * step.damping_ratio for step in steps])
        bounds = 100.0 * np.array([step.damping_ratio_interval_90 for step in steps])
        figure.add_scatter(
            x=n,
            y=zeta,
            mode="lines+markers",
            name=words(label) if label else "not in the model",
            line={"color": look.colour, "dash": look.dash, "width": 1.4},
            marker={"color": look.colour, "symbol": look.symbol, "size": 9},
            error_y={
                "type": "data",
                "symmetric": False,
                "array": bounds[:, 1] - zeta,
                "arrayminus": zeta - bounds[:, 0],
                "thickness": 1.4,
            },
            hovertemplate="%{x} records<br>ζ %{y:.2f} %<extra></extra>",
        )
    return style.finish(
        figure,
        height=460,
        xaxis={
            "title": {"text": style.title("records fused", "-")},
            "type": "log",
            "tickvals": numbers,
            "range": np.log10([0.93 * numbers[0], 1.07 * numbers[-1]]).tolist(),
        },
        yaxis={"title": {"text": style.title("damping ratio", "%")}, "rangemode": "tozero"},
        margin={"l": 70, "r": 24, "t": 104, "b": 54},
    )


def _label(name: str, mode: ModalEstimate) -> str:
    return f"{words(name) if name else 'not in the model'}, {mode.frequency_hz:.3f} Hz"
