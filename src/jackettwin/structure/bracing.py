"""Bracing of a jacket's faces: X, K and Z bays, and horizontals between the legs."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from jackettwin.structure.model import Vector

Pattern = Literal["X", "K", "Z"]
"""Of a face's bay: diagonals that cross; two that rise to the middle of the horizontal above; one alone."""


class Face(NamedTuple):
    """The corners of a bay's face: leg nodes at its bottom and top, left and right seen from outside."""

    bottom_left: str
    bottom_right: str
    top_left: str
    top_right: str


class Brace(NamedTuple):
    """A brace of a face: what its name adds to the face's, and its ends."""

    suffix: str
    start: str
    end: str


def crossing(nodes: dict[str, Vector], face: Face, centre: str) -> list[Brace]:
    """Return the four braces of an X, which meet in a new node where the trapezium's diagonals cross."""
    corners = (face.bottom_left, face.top_right, face.bottom_right, face.top_left)
    a, b, c, d = (np.array(nodes[corner]) for corner in corners)
    at = np.linalg.norm(c - a) / (np.linalg.norm(c - a) + np.linalg.norm(b - d))
    x, y, z = a + at * (b - a)
    nodes[centre] = (float(x), float(y), float(z))
    return [Brace(f"_{k}", corner, centre) for k, corner in enumerate(corners, start=1)]


def rising(face: Face, apex: str) -> list[Brace]:
    """Return the two braces of a K, from the legs up to the middle of the horizontal above."""
    return [Brace("_1", face.bottom_left, apex), Brace("_2", face.bottom_right, apex)]


def single(face: Face, bay: int) -> list[Brace]:
    """Return the brace of a Z, from left to right in even bays and back in odd ones: a zigzag up the face."""
    ends = (face.bottom_left, face.top_right) if bay % 2 == 0 else (face.bottom_right, face.top_left)
    return [Brace("_1", *ends)]


def middle(nodes: dict[str, Vector], left: str, right: str, name: str) -> str:
    """Add the node halfway between two others, and return its name."""
    x, y, z = 0.5 * (np.array(nodes[left]) + np.array(nodes[right]))
    nodes[name] = (float(x), float(y), float(z))
    return name
