"""A textbook figure: a frequency between its limits."""

from __future__ import annotations

import plotly.graph_objects as go

from jackettwin.report.figures import style
from jackettwin.updating import Locus


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
