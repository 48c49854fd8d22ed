"""Textbook figures: viscoelastic laws beside their models, free decay, a frequency between its limits."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from gallery import schematics
from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.soil.laws.viscoelastic import Law
from jackettwin.updating import Locus


def creep_and_relaxation(laws: Mapping[str, tuple[schematics.Drawing, Law]]) -> go.Figure:
    """Draw models, their relaxation and their creep in three rows (thesis figure 4.2)."""
    letters = "ABCDEFGHI"
    n = len(laws)
    titles = [f"{letters[i]}  {name}" for i, name in enumerate(laws)]
    titles += [f"{letters[n + i]}  relaxation" for i in range(n)] + [
        f"{letters[2 * n + i]}  creep" for i in range(n)
    ]
    figure = make_subplots(
        rows=3, cols=n, subplot_titles=titles, vertical_spacing=0.12, horizontal_spacing=0.09
    )
    t = np.linspace(1e-4, 5.0, 200)
    for col, (drawing, law) in enumerate(laws.values(), start=1):
        schematics.add(figure, drawing, row=1, col=col)
        figure.update_yaxes(range=[-1.0, 1.0], row=1, col=col)
        for row, values, colour in ((2, law.relaxation(t), style.VERMILLION), (3, law.creep(t), style.BLUE)):
            figure.add_scatter(
                x=t,
                y=values,
                mode="lines",
                row=row,
                col=col,
                showlegend=False,
                line={"color": colour, "width": 2.2},
                hovertemplate="t/τ %{x:.2f}<br>%{y:.3f}<extra></extra>",
            )
            figure.update_xaxes(title_text=style.title("t/τ", "-"), row=row, col=col)
        figure.update_yaxes(title_text=style.title("σ/(E ε₀)", "-"), range=[-0.05, 1.1], row=2, col=col)
        figure.update_yaxes(title_text=style.title("E ε/σ₀", "-"), rangemode="tozero", row=3, col=col)
    return style.finish(figure, height=760)


def free_decay(
    t: FloatArray, displacement: FloatArray, *, frequency_hz: float, damping_ratio: float
) -> go.Figure:
    """Draw a free decay with the envelope of one mode (thesis figure 5.4)."""
    figure = go.Figure()
    figure.add_scatter(
        x=t,
        y=displacement,
        mode="lines",
        name="displacement",
        line={"color": style.BLUE, "width": 1.1},
        hovertemplate="%{x:.1f} s<br>%{y:.4f} m<extra></extra>",
    )
    envelope = abs(displacement[0]) * np.exp(-damping_ratio * 2.0 * np.pi * frequency_hz * t)
    for sign in (1.0, -1.0):
        figure.add_scatter(
            x=t,
            y=sign * envelope,
            mode="lines",
            showlegend=sign > 0,
            name=f"envelope of f {frequency_hz:.4f} Hz, ζ {100 * damping_ratio:.2f} %",
            line={"color": style.VERMILLION, "dash": "dash", "width": 1.5},
            hoverinfo="skip",
        )
    return style.finish(
        figure,
        height=420,
        xaxis={"title": {"text": style.title("time", "s")}},
        yaxis={"title": {"text": style.title("displacement", "m")}},
    )


def frequency_along(locus: Locus, branch: int, limits: tuple[float, float]) -> go.Figure:
    """Draw a mode's frequency over a parameter between two known limits (thesis figure 8.1)."""
    figure, p, values = go.Figure(), locus.parameter, locus.values
    mode = locus.modes[branch]
    figure.add_scatter(
        x=values,
        y=locus.frequency_hz[:, branch],
        mode="lines",
        name=f"f of mode {mode}",
        line={"color": style.BLUE, "width": 2.4},
        showlegend=False,
        hovertemplate=f"{p.name} %{{x:.3g}} {p.unit}<br>%{{y:.4f}} Hz<extra></extra>",
    )
    for level, dash, name in zip(limits, ("dash", "dot"), ("→ 0", "→ ∞"), strict=True):
        figure.add_scatter(
            x=values[[0, -1]],
            y=[level, level],
            mode="lines",
            name=f"reference, {p.name} {name}: {level:.4f} Hz",
            line={"color": style.INK, "width": 1.4, "dash": dash},
            hovertemplate="%{y:.6f} Hz<extra></extra>",
        )
    return style.finish(
        figure,
        height=440,
        xaxis={
            "title": {"text": style.title(p.name, p.unit)},
            "type": "log",
            "exponentformat": "power",
            "dtick": 1,
        },
        yaxis={"title": {"text": style.title(f"natural frequency, mode {mode}", "Hz")}},
    )
