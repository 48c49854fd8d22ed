"""Axes of figures say what they show and in which unit."""

from __future__ import annotations

import re
from collections.abc import Iterator

import plotly.graph_objects as go

CATEGORIES = {"mode", "member", "law", "parameter"}
"""Axes that name things have no unit."""


def _axes(figure: go.Figure) -> Iterator[tuple[str, dict]]:
    layout = figure.to_dict()["layout"]
    for key, value in layout.items():
        if re.fullmatch(r"[xy]axis\d*", key):
            yield key, value
        elif re.fullmatch(r"scene\d*", key):
            yield from ((f"{key}.{axis}", value[axis]) for axis in ("xaxis", "yaxis", "zaxis"))


def assert_units_of(figure: go.Figure) -> None:
    """Fail on an axis that shows numbers without quantity and unit."""
    axes = list(_axes(figure))
    assert axes
    for name, axis in axes:
        if axis.get("visible") is False or axis.get("showticklabels") is False:
            continue
        title = axis.get("title", {}).get("text", "")
        if axis.get("type") == "category" and name.startswith("y"):
            continue
        assert title in CATEGORIES or re.search(r"\S \[.+\]$", title), (name, title)
