"""Pictures of theories that no command's page shows."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import plotly.graph_objects as go

from jackettwin import assemble, build_system, read_structure, read_support
from jackettwin.fatigue import ENVIRONMENTS, read_curve
from jackettwin.loads import airy_wave, regular_wave
from jackettwin.response.superelement.accuracy import default_band_hz, reduced_modes
from jackettwin.response.superelement.craig_bampton import superelement
from jackettwin.sensing.latent_forces import LatentForce
from jackettwin.sensing.wind_forces import gust_corner
from jackettwin.structure import Rayleigh
from jackettwin.structure.cut import at_interface

_BLUE, _VERMILLION, _GREEN, _INK = "#0072B2", "#D55E00", "#009E73", "#222222"
_DASHES = ("solid", "dash", "dot")


def _figure(x: str, y: str) -> go.Figure:
    figure = go.Figure()
    grid = {"gridcolor": "#E4E4E4", "linecolor": "#767676", "ticks": "outside", "zeroline": False}
    figure.update_layout(
        width=740,
        height=430,
        margin={"l": 70, "r": 20, "t": 20, "b": 55},
        plot_bgcolor="white",
        font={"size": 14, "color": _INK},
        legend={"x": 0.98, "xanchor": "right", "y": 0.98, "bgcolor": "rgba(255,255,255,0.8)"},
        xaxis={"title": x, **grid},
        yaxis={"title": y, **grid},
    )
    return figure


def sn_curves() -> go.Figure:
    """Draw the T curve of tubular joints in its three environments."""
    figure = _figure("cycles to failure, N [-]", "stress range Δσ [MPa]")
    ranges_mpa = np.geomspace(8.0, 600.0, 200)
    for environment, dash, colour in zip(ENVIRONMENTS, _DASHES, (_BLUE, _GREEN, _VERMILLION), strict=True):
        curve = read_curve("T", environment)
        figure.add_scatter(
            x=curve.cycles_to_failure(1e6 * ranges_mpa),
            y=ranges_mpa,
            name=f"T, {environment.replace('-', ' ')}",
            line={"dash": dash, "color": colour, "width": 2.5},
        )
    figure.update_xaxes(type="log", exponentformat="power", dtick=1)
    figure.update_yaxes(type="log", tickvals=[10, 20, 50, 100, 200, 500])
    return figure


def wave_theories() -> go.Figure:
    """Draw the crest of one steep wave by three theories: H 12 m, T 11 s, in 30 m of water."""
    wave = {"height": 12.0, "period": 11.0, "depth": 30.0}
    figure = _figure("time from the crest [s]", "surface elevation η [m]")
    t = np.linspace(-5.5, 5.5, 241)
    origin = np.zeros((1, 2))
    theories: dict[str, Any] = {
        "linear (Airy)": airy_wave(**wave),
        "stream function": regular_wave("stream-function", **wave),
        "Stokes, fifth order": regular_wave("stokes-5", **wave),
    }
    looks = zip(("dot", "solid", "dash"), (_INK, _BLUE, _VERMILLION), strict=True)
    for name, (dash, colour) in zip(theories, looks, strict=True):
        eta = theories[name].elevation(origin, t)[:, 0]
        figure.add_scatter(x=t, y=eta, name=name, line={"dash": dash, "color": colour, "width": 2.5})
    return figure


def superelement_error() -> go.Figure:
    """Draw how the worst pole's error falls with the number of inner coordinates, damped and plain."""
    whole = read_structure("jacket15")
    foundation, tower = at_interface(whole)
    held = read_support("kelvin-voigt:k=2.5e9,c=7.6e8", whole)
    steel = Rayleigh.minimum(0.0055, 0.183)
    full, base = (build_system(assemble(part), held, rayleigh=steel) for part in (whole, foundation))
    band = default_band_hz(full)
    figure = _figure("internal coordinates N [-]", "largest relative error of a pole in the band [-]")
    numbers = (4, 8, 12, 16, 20, 24, 32)
    for damped, name, colour, dash in (
        (False, "plain Craig–Bampton", _VERMILLION, "dash"),
        (True, "with the feet's damping in its basis", _BLUE, "solid"),
    ):
        worst = []
        for number in numbers:
            element = superelement(base, number=number, band_hz=band, damped=damped)
            modes = reduced_modes(element, full, assemble(tower), band_hz=band)
            worst.append(float(np.max(np.abs(modes.reduced / modes.full - 1.0))))
        figure.add_scatter(
            x=numbers,
            y=worst,
            name=name,
            mode="lines+markers",
            line={"color": colour, "dash": dash, "width": 2.5},
            marker={"size": 8, "symbol": "square" if damped else "circle-open"},
        )
    figure.update_yaxes(type="log", exponentformat="power", dtick=1)
    figure.update_layout(legend_y=0.6)
    return figure


def utilisations() -> go.Figure:
    """Draw the utilisation of every member of the shipped jacket under its own weight."""
    command = "check jacket15 --json".split()
    said = subprocess.run([sys.executable, "-m", "jackettwin", *command], capture_output=True, check=False)
    rows = [row for row in json.loads(said.stdout)["members"] if row["part"] == "jacket"]
    structure = read_structure("jacket15")
    figure = _figure("utilisation Uₘ [-]", "height above the mud line [m]")
    middle_m = {
        member.name: 0.5 * (structure.nodes[member.start][2] + structure.nodes[member.end][2])
        for member in structure.members
    }
    for kind, colour, symbol in (("leg", _BLUE, "circle"), ("brace", _VERMILLION, "square")):
        chosen = [row for row in rows if row["member"].startswith(kind)]
        figure.add_scatter(
            x=[row["utilisation"] for row in chosen],
            y=[middle_m[row["member"]] for row in chosen],
            name=f"{kind}s",
            mode="markers",
            marker={"color": colour, "symbol": symbol, "size": 8},
        )
    figure.add_vline(x=1.0, line={"dash": "dash", "color": _INK})
    figure.update_xaxes(rangemode="tozero")
    return figure


def latent_densities() -> go.Figure:
    """Draw what virtual sensing expects of wind and sea: the density of each force, at one level."""
    figure = _figure("frequency [Hz]", "density over variance [1/Hz]")
    frequency_hz = np.geomspace(1e-3, 1.0, 400)
    corner, peak = gust_corner(10.0), 2.0 * np.pi * 0.1
    drawn = (
        ("gusts at 10 m/s", "gust", corner, 1.0, _BLUE, "solid"),
        ("as a rotor averages them", "disc", 0.62 * corner, 12.0, _BLUE, "dash"),
        ("quick gusts", "gust", 25.0 * corner, 1.0, _BLUE, "dot"),
        ("sea of 10 s, long waves", "wave", peak, 1.5, _GREEN, "solid"),
        ("its shorter waves", "wave", 1.7 * peak, 1.5, _GREEN, "dash"),
        ("its shortest", "wave", 2.9 * peak, 1.5, _GREEN, "dot"),
    )
    none = np.empty(0)
    for name, kind, rate, tail, colour, dash in drawn:
        density = LatentForce(name, none, none, kind, rate, tail=tail).density(2.0 * np.pi * frequency_hz)
        figure.add_scatter(x=frequency_hz, y=density, name=name, line={"color": colour, "dash": dash})
    figure.update_xaxes(type="log", exponentformat="power", dtick=1)
    figure.update_yaxes(type="log", exponentformat="power", dtick=1, range=[-4.0, 5.5])
    return figure


DRAWN: dict[str, Callable[[], go.Figure]] = {
    "fatigue": sn_curves,
    "loads": wave_theories,
    "superelement": superelement_error,
    "member_checks": utilisations,
    "virtual_sensing": latent_densities,
}
"""Every picture drawn here, under the name of the page of docs/theory that shows it."""
