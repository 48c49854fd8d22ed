"""Textbook figures: regimes of damping, viscoelastic laws, free decay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from gallery import schematics
from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.soil.laws.viscoelastic import Law
from jackettwin.updating import Locus


def damping_regimes(ratios: Sequence[tuple[str, float]]) -> go.Figure:
    """Draw free vibration from rest at x₀ for several damping ratios (thesis figure 3.2)."""
    cycles = np.linspace(0.0, 5.0, 600)
    figure = go.Figure()
    for (name, zeta), colour, dash in zip(
        ratios, (style.BLUE, style.VERMILLION, style.GREEN), _DASHES, strict=False
    ):
        figure.add_scatter(
            x=cycles,
            y=free_vibration(zeta, 2.0 * np.pi, cycles),
            mode="lines",
            name=f"{name}, ζ = {zeta:g}",
            line={"color": colour, "dash": dash, "width": 2.2},
            hovertemplate="%{x:.2f} periods<br>x/x₀ %{y:.3f}<extra></extra>",
        )
    return style.finish(
        figure,
        height=400,
        xaxis={"title": {"text": style.title("time over undamped period, t/T", "-")}},
        yaxis={"title": {"text": style.title("displacement, x/x₀", "-")}},
    )


def stress_strain(elastic: Law, lossy: Law, frequency_hz: float) -> go.Figure:
    """Draw one cycle of harmonic loading of two laws (thesis figure 4.1)."""
    figure = make_subplots(
        rows=1, cols=2, subplot_titles=("(a) elastic", "(b) viscoelastic"), horizontal_spacing=0.1
    )
    for col, law in ((1, elastic), (2, lossy)):
        rotating = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 200))
        strain, stress = rotating.real, (law.stiffness(2j * np.pi * frequency_hz) * rotating).real
        figure.add_scatter(
            x=strain,
            y=stress,
            mode="lines",
            row=1,
            col=col,
            showlegend=False,
            line={"color": style.BLUE, "width": 2.2},
            fill="toself" if col == 2 else None,
            fillcolor=style.rgba(style.BLUE, 0.12),
            hovertemplate="ε/ε₀ %{x:.2f}<br>σ/(Eε₀) %{y:.2f}<extra></extra>",
        )
    figure.update_xaxes(title_text=style.title("strain, ε/ε₀", "-"))
    figure.update_yaxes(title_text=style.title("stress, σ/(E ε₀)", "-"))
    return style.finish(figure, height=400)


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


_DASHES = ("solid", "dash", "dot")


def free_vibration(
    zeta: float, omega: float, t: FloatArray, *, x0: float = 1.0, v0: float = 0.0
) -> FloatArray:
    """Return x(t) of ẍ + 2ζω ẋ + ω² x = 0: under-, critically and overdamped, thesis (3.6)–(3.8)."""
    decay = np.exp(-zeta * omega * t)
    if zeta < 1.0:
        wd = omega * np.sqrt(1.0 - zeta**2)
        return np.asarray(decay * (x0 * np.cos(wd * t) + (v0 + zeta * omega * x0) / wd * np.sin(wd * t)))
    if zeta == 1.0:
        return np.asarray(decay * (x0 + (v0 + omega * x0) * t))
    root = omega * np.sqrt(zeta**2 - 1.0)
    slow, fast = -zeta * omega + root, -zeta * omega - root
    a = (v0 - fast * x0) / (slow - fast)
    return np.asarray(a * np.exp(slow * t) + (x0 - a) * np.exp(fast * t))
