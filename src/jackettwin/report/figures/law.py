"""Figures of support laws: storage and loss, creep and relaxation, a load cycle, free vibration of a mass."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.response import FreeVibration
from jackettwin.soil import Law, LawCurves

_COLOURS = (style.BLUE, style.VERMILLION, style.GREEN, style.PURPLE, style.ORANGE, style.SKY)
_DASHES = ("solid", "dash", "dot", "dashdot", "longdash", "longdashdot")

_BELOW = style.LEGEND_BELOW | {"y": -0.22}
_MARGIN = {"l": 70, "r": 24, "t": 64, "b": 110}


def _line(i: int, x: FloatArray, y: FloatArray, name: str, *, first: bool = True) -> go.Scatter:
    return go.Scatter(
        x=x,
        y=y,
        mode="lines",
        name=name,
        legendgroup=name,
        showlegend=first,
        line={"color": _COLOURS[i % 6], "dash": _DASHES[(i + i // 6) % 6], "width": 2.2},
        hovertemplate=f"{name}<br>%{{x:.4g}}, %{{y:.4g}}<extra></extra>",
    )


def moduli(laws: Mapping[str, LawCurves]) -> go.Figure:
    """Draw storage, loss and loss factor over frequency."""
    titles = ("storage, Re D", "loss, Im D", "loss factor, Im D/Re D")
    figure = make_subplots(rows=1, cols=3, subplot_titles=titles, horizontal_spacing=0.09)
    for i, (name, law) in enumerate(laws.items()):
        values = (law.stiffness.real, law.stiffness.imag, law.loss_factor)
        for col, y in enumerate(values, start=1):
            # a spring has no loss, which a logarithmic axis cannot show
            shown = np.where(np.isfinite(y) & (y > 0.0), y, np.nan)
            figure.add_trace(_line(i, law.frequency_hz, shown, name, first=col == 1), row=1, col=col)
    figure.update_xaxes(
        type="log", dtick=1, exponentformat="power", title_text=style.title("frequency", "Hz")
    )
    figure.update_yaxes(type="log", exponentformat="power")
    for col, unit in enumerate(("N/m", "N/m", "-"), start=1):
        figure.update_yaxes(
            title_text=style.title(("storage", "loss", "loss factor")[col - 1], unit), col=col
        )
    return style.finish(figure, height=440, showlegend=True, legend=_BELOW, margin=_MARGIN)


def transients(laws: Mapping[str, LawCurves]) -> go.Figure:
    """Draw creep and relaxation over time (thesis figure 4.2)."""
    titles = ("relaxation: force under a unit displacement", "creep: displacement under a unit force")
    figure = make_subplots(rows=1, cols=2, subplot_titles=titles, horizontal_spacing=0.12)
    for i, (name, law) in enumerate(laws.items()):
        for col, y in ((1, law.relaxation), (2, law.creep)):
            figure.add_trace(_line(i, law.time_s, y, name, first=col == 1), row=1, col=col)
    figure.update_xaxes(type="log", exponentformat="power", title_text=style.title("time", "s"))
    figure.update_yaxes(exponentformat="power", rangemode="tozero")
    figure.update_yaxes(title_text=style.title("force", "N/m"), col=1)
    figure.update_yaxes(title_text=style.title("displacement", "m/N"), col=2)
    return style.finish(figure, height=440, showlegend=True, legend=_BELOW, margin=_MARGIN)


def cycle(laws: Mapping[str, Law], frequency_hz: float) -> go.Figure:
    """Draw a cycle of harmonic motion of unit amplitude (thesis figure 4.1); its area is the energy lost."""
    figure = go.Figure()
    rotating = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 200))
    for i, (name, law) in enumerate(laws.items()):
        force = (law.stiffness(2j * np.pi * frequency_hz) * rotating).real
        figure.add_trace(_line(i, rotating.real, force, name))
    figure.update_xaxes(title_text=style.title("displacement / amplitude", "-"))
    figure.update_yaxes(title_text=style.title("force / amplitude", "N/m"), exponentformat="power")
    return style.finish(figure, height=420, showlegend=True)


def let_go(motions: Mapping[str, FreeVibration]) -> go.Figure:
    """Draw the free vibration of a mass on each law from rest (thesis figure 3.2)."""
    figure = go.Figure()
    for i, (name, motion) in enumerate(motions.items()):
        figure.add_trace(_line(i, motion.time_s, motion.displacement, name))
    figure.update_xaxes(title_text=style.title("time", "s"))
    figure.update_yaxes(title_text=style.title("displacement / initial displacement", "-"))
    return style.finish(figure, height=420, showlegend=True)
