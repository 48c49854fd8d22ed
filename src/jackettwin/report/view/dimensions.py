"""Dimensions in the view of a structure: levels, widths between legs, diameters of single tubes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.structure import Assembly, Structure

_SAME_M = 0.05
"""Distance below which levels are the same, since joints of a storey rarely agree to the millimetre [m]."""
_OUTER = 0.8
"""Share of the largest distance from the axis above which a point of a level is on a leg."""


def dimensions(assembly: Assembly) -> dict[str, list[Any]]:
    """Return the dimensions to draw, in metres, with z from the mean sea level.

    Returns
    -------
    levels : [z], ascending: the ends of every part
    widths : [{a, b, text}] between a leg and its neighbour at these levels, the widest first
    diameters : [{at, text}] of the tubes where a part stands alone, the thickest first
    """
    structure = assembly.structure
    levels: list[float] = []
    widths: dict[float, _Width] = {}
    diameters: dict[float, tuple[float, FloatArray]] = {}
    for part in dict.fromkeys(m.part for m in structure.members):
        points, tubes = _part(structure, part)
        for z in (points[:, 2].min(), points[:, 2].max()):
            here = np.abs(points[:, 2] - z) < _SAME_M
            level = round(float(z), 2)
            levels.append(level)
            width = _width(points[here])
            if width is not None:
                widths[level] = max(width, widths.get(level, width), key=lambda w: w.length)
            else:
                found = (float(tubes[here].max()), points[here][0])
                diameters[level] = max(found, diameters.get(level, found), key=lambda d: d[0])
    return {
        "levels": _apart(levels),
        "widths": [
            {"a": w.a.round(3).tolist(), "b": w.b.round(3).tolist(), "text": f"{w.length:.2f} m"}
            for w in sorted(widths.values(), key=lambda w: -w.length)
        ],
        "diameters": [
            {"at": at.round(3).tolist(), "text": f"⌀ {diameter:.2f} m"}
            for diameter, at in sorted(diameters.values(), key=lambda d: -d[0])
        ],
    }


@dataclass(frozen=True)
class _Width:
    """The distance between two neighbours of a level."""

    a: FloatArray
    b: FloatArray
    length: float


def _width(points: FloatArray) -> _Width | None:
    """Return the distance of the outermost point from its neighbour as far out; None for a single point."""
    radius = np.linalg.norm(points[:, :2] - points[:, :2].mean(axis=0), axis=1)
    outer = points[radius >= _OUTER * radius.max()]
    apart = np.linalg.norm(outer - outer[0], axis=1)
    if not np.any(apart > _SAME_M):
        return None
    nearest = int(np.argmin(np.where(apart > _SAME_M, apart, np.inf)))
    return _Width(outer[0], outer[nearest], float(apart[nearest]))


def _part(structure: Structure, part: str) -> tuple[FloatArray, FloatArray]:
    """Return the ends of a part's members (n, 3) and the diameters of their tubes there (n,)."""
    sea = np.array([0.0, 0.0, structure.sea_level_z_m])
    ends = [
        (node, section.outer_diameter_m)
        for m in structure.members
        if m.part == part
        for node, section in ((m.start, m.section_start), (m.end, m.section_end))
    ]
    points = np.array([structure.nodes[node] for node, _ in ends]) - sea
    return points, np.array([diameter for _, diameter in ends])


def _apart(levels: list[float]) -> list[float]:
    """Return levels in ascending order, merging equal ones."""
    found: list[float] = []
    for z in sorted(levels):
        if not found or z - found[-1] > _SAME_M:
            found.append(round(z, 3))
    return found
