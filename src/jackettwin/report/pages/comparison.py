"""The page that compares modes with those of another program: shapes side by side, and all MAC values."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from markupsafe import Markup

from jackettwin.arrays import FloatArray
from jackettwin.report.figures import style
from jackettwin.report.figures.svg import Canvas
from jackettwin.report.pages.page import Drawing, PageSection, Text, write_page
from jackettwin.response import ModeComparison, expanded, mode_kinds
from jackettwin.structure import Assembly

_WIDTH, _HEIGHT, _HEAD = 320.0, 330.0, 58.0
_SWAY = 0.11
"""Largest drawn displacement, as a share of the drawing's height."""
_CELL = 46.0


def write_comparison(
    stages: Sequence[tuple[str, Assembly, ModeComparison]], path: Path, *, title: str, names: tuple[str, str]
) -> Path:
    """Write the page of one comparison or several stages; ``names`` are those of the two programs."""
    sections = []
    for name, assembly, found in stages:
        theirs = expanded(assembly, found.other)
        drawings = tuple(_side_by_side(assembly, found, k, theirs, names) for k in range(len(found.pairs)))
        caption = (
            f"How each mode moves: left {names[0]}, right {names[1]}, each drawn to its own largest motion"
        )
        blocks = (
            Drawing(f"shapes_{name}", caption, drawings),
            Drawing(
                f"mac_{name}", f"MAC of {names[0]} (rows) with {names[1]} (columns)", (_matrix(found, names),)
            ),
        )
        sections.append(PageSection(name.replace("_", " "), blocks))
        if found.unknown:
            few = ", ".join(found.unknown[:8])
            note = f"{len(found.unknown)} nodes of {names[1]} are not nodes of this structure: {few}"
            sections.append(PageSection(f"{name.replace('_', ' ')}: left out", (Text((note,)),)))
    return write_page(sections, path, title=title, subtitle=f"{names[0]} beside {names[1]}")


def _side_by_side(
    assembly: Assembly, found: ModeComparison, k: int, theirs: FloatArray, names: tuple[str, str]
) -> Markup:
    """Return one drawing of a mode and its counterpart, in the plane it moves in."""
    pair = found.pairs[k]
    own = _moved(assembly, found.own.shapes[:, pair.own])
    other = _moved(assembly, theirs[:, pair.other])
    if float((own * other).sum()) < 0.0:
        other = -other
    shape = found.own.shapes[:, [pair.own]]
    (kind,) = mode_kinds(assembly, shape, found.own.frequency_hz[[pair.own]])
    axes = [0, 1] if kind == "torsion" else [int(np.argmax((own[:, :2] ** 2).sum(axis=0))), 2]
    c = Canvas(_WIDTH, _HEIGHT, f"Mode {pair.own + 1} beside {pair.other + 1}")
    c.text(_WIDTH / 2, 16, f"{kind.replace('_', '-')}, MAC {pair.mac:.3f}", anchor="middle", bold=True)
    frequencies = found.own.frequency_hz[pair.own], found.other.frequency_hz[pair.other]
    colours = style.mode_look(f"{kind}_1").colour, style.ORANGE
    for side, (motion, f, colour, number) in enumerate(
        zip((own, other), frequencies, colours, (pair.own, pair.other), strict=True)
    ):
        left = side * _WIDTH / 2
        c.text(left + _WIDTH / 4, 34, names[side], anchor="middle", colour=colour)
        c.text(left + _WIDTH / 4, 50, f"{number + 1}: {f:.4f} Hz", anchor="middle")
        _draw(c, assembly, motion, axes, left, colour)
    return c.markup


def _moved(assembly: Assembly, shape: FloatArray) -> FloatArray:
    """Return the translations of all nodes of the mesh, scaled to a largest value of one."""
    motion = np.asarray(assembly.expand @ shape).reshape(-1, 6)[:, :3]
    return np.asarray(motion / np.abs(motion).max())


def _draw(
    c: Canvas, assembly: Assembly, motion: FloatArray, axes: list[int], left: float, colour: str
) -> None:
    mesh = assembly.mesh
    flat = mesh.coordinates[:, axes]
    extent, middle = np.ptp(flat, axis=0), 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    sway = _SWAY * float(extent.max())
    room = np.array([_WIDTH / 2 - 16.0, _HEIGHT - _HEAD - 16.0])
    scale = float(np.min(room / (extent + 2.0 * sway)))
    centre = np.array([left + _WIDTH / 4, _HEAD + (_HEIGHT - _HEAD) / 2])

    def strokes(at: FloatArray) -> str:
        place = centre + (at - middle) * [scale, -scale]
        lines = zip(place[mesh.start], place[mesh.end], strict=True)
        others = ((e.start, e.end) for e in mesh.others)
        number = {name: k for k, name in enumerate(mesh.node_names)}
        more = ((place[number[a]], place[number[b]]) for a, b in others)
        return "".join(f"M{a[0]:.1f} {a[1]:.1f}L{b[0]:.1f} {b[1]:.1f}" for a, b in (*lines, *more))

    c.path(strokes(flat), colour=style.PALE, width=1.0)
    c.path(strokes(flat + sway * motion[:, axes]), colour=colour, width=1.5)


def _matrix(found: ModeComparison, names: tuple[str, str]) -> Markup:
    """Return the MAC between all modes, darker where they agree."""
    n, m = found.mac.shape
    left, top = 96.0, 62.0
    c = Canvas(left + _CELL * m + 10.0, top + 26.0 * n + 10.0, "MAC between the modes of both programs")
    c.text(left + _CELL * m / 2, 16, names[1], anchor="middle", bold=True)
    c.text(4, top - 8, names[0], bold=True)
    for j in range(m):
        c.text(left + _CELL * (j + 0.5), 36, str(j + 1), anchor="middle")
        c.text(left + _CELL * (j + 0.5), 52, f"{found.other.frequency_hz[j]:.3f}", anchor="middle")
    for i in range(n):
        y = top + 26.0 * i
        c.text(left - 8, y + 18, f"{i + 1}: {found.own.frequency_hz[i]:.3f} Hz", anchor="end")
        for j in range(m):
            value = float(found.mac[i, j])
            c.box(left + _CELL * j, y, _CELL - 2.0, 24.0, colour=style.BLUE, opacity=value, edge=style.GRID)
            ink = "#ffffff" if value > 0.6 else style.INK
            c.text(left + _CELL * (j + 0.5) - 1.0, y + 17, f"{value:.2f}", anchor="middle", colour=ink)
    return c.markup
