"""Common style of all figures: colours, markers, axis titles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import plotly.graph_objects as go

# Okabe & Ito 2008: distinct for all common forms of colour blindness.
ORANGE, SKY, GREEN = "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILLION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
INK, GREY, PALE, GRID = "#222222", "#767676", "#BDBDBD", "#E4E4E4"
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"


class Appearance(NamedTuple):
    """Colour, marker and dash of one item, each sufficient to distinguish it."""

    colour: str
    symbol: str
    dash: str


_LAWS = {
    "kelvin-voigt": Appearance(ORANGE, "square", "dash"),
    "zener": Appearance(SKY, "diamond", "dot"),
    "maxwell-3": Appearance(PURPLE, "triangle-up", "solid"),
    "springpot": Appearance(GREEN, "cross", "dashdot"),
}
"""Appearance of support laws; laws of other packages are grey."""
_KINDS = {
    "fore_aft": (BLUE, "circle"),
    "side_side": (VERMILLION, "square"),
    "torsion": (GREEN, "diamond"),
    "heave": (PURPLE, "triangle-up"),
}
_UNNAMED = tuple(
    zip(
        (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, INK),
        ("circle", "square", "diamond", "triangle-up", "cross", "x", "star"),
        strict=True,
    )
)
"""Appearance of modes of unknown kind, by number."""
_DASHES = ("solid", "dash", "dot", "dashdot")
_VARIANTS = ("", "-open", "-open-dot", "-dot")


def law_look(law: str) -> Appearance:
    """Return the appearance of a support law, the same on the whole page."""
    return _LAWS.get(law, Appearance(GREY, "x", "longdash"))


def mode_look(label: str) -> Appearance:
    """Return the appearance of a mode by its label ``kind_number``: colour by kind, fill and dash by number.

    ``mode_3``, of unknown kind, is coloured by number; a label without number is grey.
    """
    kind, _, number = label.rpartition("_")
    order = int(number) if number.isdigit() else 1
    if kind == "mode" and number.isdigit():
        turn, place = divmod(order - 1, len(_UNNAMED))
        colour, symbol = _UNNAMED[place]
        return Appearance(colour, symbol + _VARIANTS[turn % 4], _DASHES[turn % 4])
    colour, symbol = _KINDS.get(kind, (GREY, "x"))
    return Appearance(colour, symbol + _VARIANTS[(order - 1) % 4], _DASHES[(order - 1) % 4])


def direction_colour(direction: tuple[float, float, float]) -> str:
    """Return the colour of a channel: along x as fore-aft modes, along y as side-side modes."""
    along = max(range(3), key=lambda i: abs(direction[i]))
    return (BLUE, VERMILLION, PURPLE)[along] if any(direction) else GREY


def title(quantity: str, unit: str) -> str:
    """Return an axis title: quantity and unit.

    >>> title("frequency", "Hz")
    'frequency [Hz]'
    """
    return f"{quantity} [{unit}]"


def rgba(colour: str, alpha: float) -> str:
    """Return a ``#RRGGBB`` colour with an opacity."""
    r, g, b = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({r},{g},{b},{alpha:g})"


def label_lines(
    figure: go.Figure, marks: Sequence[tuple[float, str, str]], limits: tuple[float, float]
) -> None:
    """Write (x, text, colour) vertically above the axes, spread where lines are close."""
    low, high = limits
    gap = 0.027 * (high - low)  # a line of text in the narrowest figure, 520 px between its axes
    placed: list[float] = []
    for x, text, colour in sorted(marks):
        at = max(x, placed[-1] + gap) if placed else x
        placed.append(at)
        figure.add_annotation(
            x=x,
            y=1.0,
            yref="paper",
            ax=at,
            axref="x",
            ay=-16,
            text="",
            showarrow=True,
            arrowhead=0,
            arrowwidth=1,
            arrowcolor=colour,
        )
        figure.add_annotation(
            x=at,
            y=1.0,
            yref="paper",
            yshift=16,
            yanchor="bottom",
            xanchor="center",
            showarrow=False,
            textangle=-90,
            text=text,
            font={"size": 12, "color": colour},
        )


def _template() -> go.layout.Template:
    axis = {
        "showline": True,
        "linecolor": GREY,
        "linewidth": 1,
        "gridcolor": GRID,
        "zeroline": False,
        "ticks": "outside",
        "ticklen": 4,
        "tickcolor": GREY,
        "automargin": True,
        "title": {"standoff": 8},
    }
    flat = {"backgroundcolor": "white", "gridcolor": GRID, "linecolor": GREY, "zeroline": False}
    return go.layout.Template(
        layout={
            "font": {"family": FONT, "size": 13, "color": INK},
            "paper_bgcolor": "white",
            "plot_bgcolor": "white",
            "colorway": [BLUE, VERMILLION, GREEN, ORANGE, SKY, PURPLE, INK],
            "xaxis": axis,
            "yaxis": axis,
            "scene": {"xaxis": flat, "yaxis": flat, "zaxis": flat},
            "hoverlabel": {"font": {"family": FONT, "size": 12}, "namelength": -1},
            "legend": {"font": {"size": 12}},
        }
    )


LEGEND_ABOVE: dict[str, Any] = {
    "orientation": "h",
    "x": 0.0,
    "xanchor": "left",
    "y": 1.02,
    "yanchor": "bottom",
}
"""Position of the legend: outside the axes, so that it covers no data."""
LEGEND_BELOW: dict[str, Any] = {**LEGEND_ABOVE, "y": -0.13, "yanchor": "top"}


def finish(figure: go.Figure, *, height: int, **layout: Any) -> go.Figure:
    """Give a figure the house style."""
    margin = {"l": 70, "r": 24, "t": 64, "b": 54}  # above: buttons, and below them the legend
    figure.update_layout(
        template=_template(),
        height=height,
        margin=layout.pop("margin", margin),
        legend=layout.pop("legend", LEGEND_ABOVE),
        **layout,
    )
    return figure
