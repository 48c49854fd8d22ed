"""Columns of a buckling check: straight runs of members between joints that restrain them."""

from __future__ import annotations

from collections import Counter, defaultdict
from itertools import combinations
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.structure import Structure

_STRAIGHT = 0.9998
"""Cosine of the angle (about 1°) up to which two members in a row are one column."""


class StraightRun(NamedTuple):
    """Length [m] of a straight run, and whether one of its ends hangs free."""

    length_m: float
    is_cantilever: bool


def columns(structure: Structure) -> dict[str, StraightRun]:
    """Return the straight run that each member, and each beam that is no tube, belongs to.

    Two of them in line are one column unless something else at their common node leads to the ground: what
    hangs there (a platform, a nacelle) holds nothing. A column is a cantilever if only one of its ends leads
    to the ground without the column itself, as a tower's foot does and its top does not. Several interface
    nodes count as held together by the transition piece. Ground holds a pile at each of its nodes.
    """
    frame = _Frame(structure)
    run = {name: name for name in frame.ends}

    def root(name: str) -> str:
        while run[name] != name:
            name = run[name]
        return name

    axis = {name: _axis(structure, *ends) for name, ends in frame.ends.items()}
    for node, names in frame.members_at.items():
        for a, b in combinations(names, 2):
            in_line = abs(axis[a][0] @ axis[b][0]) > _STRAIGHT
            if in_line and not frame.is_grounded(node, without={a, b}):
                run[root(a)] = root(b)
    pieces: dict[str, list[str]] = defaultdict(list)
    for name in run:
        pieces[root(name)].append(name)
    found: dict[str, StraightRun] = {}
    for names in pieces.values():
        column = StraightRun(sum(axis[name][1] for name in names), frame.is_cantilever(names))
        found |= dict.fromkeys(names, column)
    return found


class _Frame:
    """Which node leads to which, by the name of what joins them."""

    def __init__(self, structure: Structure) -> None:
        self.ends = {m.name: (m.start, m.end) for m in structure.members}
        self.ends |= {beam.name: (beam.start, beam.end) for beam in structure.beams}
        self.height = {name: xyz[2] for name, xyz in structure.nodes.items()}
        self.ground = {*structure.reaction_nodes, *structure.buried_nodes}
        self.members_at: dict[str, list[str]] = defaultdict(list)
        self.neighbours: dict[str, list[tuple[str, str]]] = defaultdict(list)
        for name, (start, end) in self.ends.items():
            self.members_at[start].append(name)
            self.members_at[end].append(name)
            self._join(name, start, end)
        others = [(one.start, one.end) for one in structure.elements]
        others += [(link.leader, link.follower) for link in structure.rigid_links]
        tied = structure.interface_nodes
        for start, end in (*others, *zip(tied, tied[1:], strict=False)):
            self._join("", start, end)  # nameless: only members and beams are ever left out

    def _join(self, name: str, start: str, end: str) -> None:
        self.neighbours[start].append((name, end))
        self.neighbours[end].append((name, start))

    def is_grounded(self, node: str, *, without: set[str]) -> bool:
        """Return whether a way leads from a node to the ground that avoids some members."""
        seen, stack = {node}, [node]
        while stack:
            here = stack.pop()
            if here in self.ground:
                return True
            ways = [end for name, end in self.neighbours[here] if name not in without and end not in seen]
            seen.update(ways)
            stack += sorted(ways, key=self.height.__getitem__, reverse=True)  # downwards first: soon there
        return False

    def is_cantilever(self, run: list[str]) -> bool:
        """Return whether just one end of a run leads to the ground without it."""
        count = Counter(node for name in run for node in self.ends[name])
        held = [self.is_grounded(node, without=set(run)) for node, n in count.items() if n == 1]
        return sum(held) == 1


def _axis(structure: Structure, start: str, end: str) -> tuple[FloatArray, float]:
    along = np.subtract(structure.nodes[end], structure.nodes[start])
    length = float(np.linalg.norm(along))
    return along / length, length
