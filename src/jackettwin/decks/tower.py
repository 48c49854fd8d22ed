"""A tower on the interface of a foundation: of tubes by their stations, or ElastoDyn's."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.decks.openfast import read_deck, to_float
from jackettwin.errors import located, require
from jackettwin.files import Placed, Schema
from jackettwin.structure import (
    STEEL,
    Beam,
    BeamSection,
    Member,
    RigidLink,
    Section,
    Structure,
    Vector,
)
from jackettwin.structure.jacket import MaterialInFile, Tower, tower_tubes

TOWER, FOUNDATION, BASE = "tower", "foundation", "tower_base"
_SAME_M = 1e-6
"""Levels closer than this are one."""
Station = tuple[float, float, float]
Bars = tuple[tuple[Member, ...], tuple[Beam, ...]]


class TowerSchema(Schema):
    """``tower`` on a foundation: as in a parametric jacket, by ``stations``, or ElastoDyn's."""

    height_m: Annotated[float, Field(gt=0.0, le=1e3)] | None = None
    bottom: Placed[Section] | None = None
    top: Placed[Section] | None = None
    elements: Annotated[int, Field(ge=1, le=1000)] = 12
    material: MaterialInFile = STEEL
    stations: Annotated[list[Station], Field(min_length=2)] | None = None
    elastodyn: str | None = None
    base_z_m: Annotated[float, Field(ge=-1e4, le=1e4)] | None = None

    def stand_on(self, foundation: Structure, *, folder: Path | None) -> Structure:
        """Return the foundation with the tower on its interface.

        Raises
        ------
        InputError
            If the tower is not given in just one way, or the foundation has no interface, or a tower.
        """
        with located(field="tower"):
            ways = (self.height_m, self.stations, self.elastodyn)
            require(
                sum(way is not None for way in ways) == 1,
                "give the tower in one way",
                field="height_m, stations, elastodyn",
                value=sum(way is not None for way in ways),
                remedy="height_m with bottom and top; or stations: [[height_m, diameter_m, wall_m], …]; "
                "or elastodyn: the input file of ElastoDyn",
            )
            if self.elastodyn is not None:
                file = Path(self.elastodyn) if folder is None else folder / self.elastodyn
                base, levels, section = read_elastodyn_tower(file)
                base_z_m = foundation.sea_level_z_m + base if self.base_z_m is None else self.base_z_m
                return _standing(foundation, levels, _beams(section), base_z_m)
            levels, sections = self._tubes()
            return _standing(foundation, levels, _members(sections, self.material), self.base_z_m)

    def _tubes(self) -> tuple[FloatArray, list[tuple[Section, Section]]]:
        """Return heights over the base [m], and the tubes of the pieces between them."""
        if self.stations is None:
            for key in ("bottom", "top"):
                require(getattr(self, key), "required key is missing", field=key, remedy=f"add {key!r}")
            assert self.height_m is not None and self.bottom is not None and self.top is not None
            tubes = tower_tubes(Tower(self.height_m, self.bottom, self.top, self.elements))
            return np.linspace(0.0, self.height_m, self.elements + 1), [(tube, tube) for tube in tubes]
        height = np.array([station[0] for station in self.stations])
        rising = bool(np.all(np.diff(height) > 0.0)) and height[0] == 0.0
        told = "rising from 0, the tower's base"
        require(rising, "heights do not rise", field="stations", value=height.tolist(), allowed=told)
        ends = []
        for k, (_, diameter, wall) in enumerate(self.stations):
            with located(field=f"stations.{k}"):
                ends.append(Section(diameter, wall))
        return height, [*pairwise(ends)]


def _members(
    sections: list[tuple[Section, Section]], material: MaterialInFile
) -> Callable[[list[str]], Bars]:
    def bars(names: list[str]) -> Bars:
        pieces = zip(pairwise(names), sections, strict=True)
        return tuple(
            Member(f"tower_{k}", *ends, *tubes, material, TOWER)
            for k, (ends, tubes) in enumerate(pieces, start=1)
        ), ()

    return bars


def _beams(sections: list[BeamSection]) -> Callable[[list[str]], Bars]:
    def bars(names: list[str]) -> Bars:
        pieces = zip(pairwise(names), sections, strict=True)
        return (), tuple(
            Beam(f"tower_{k}", *ends, section, STEEL, 0.0, TOWER, "ElastoDyn's tower")
            for k, (ends, section) in enumerate(pieces, start=1)
        )

    return bars


def _standing(
    foundation: Structure, levels: FloatArray, bars: Callable[[list[str]], Bars], base_z_m: float | None
) -> Structure:
    """Return a foundation with a tower from its base to ``levels`` [m] above it."""
    based, base = with_base(foundation, base_z_m)
    x, y, z = based.nodes[base]
    names = [base, *(f"tower_{k}" for k in range(1, levels.size - 1)), "tower_top"]
    taken = [name for name in names[1:] if name in based.nodes]
    require(
        not taken and not any(bar.part == TOWER for bar in based.bars),
        "the foundation has a tower already",
        field="foundation",
        value=taken[0] if taken else TOWER,
        remedy="take tower: out, or name a foundation without one",
    )
    above: dict[str, Vector] = {
        name: (x, y, z + float(height)) for name, height in zip(names[1:], levels[1:], strict=True)
    }
    members, beams = bars(names)
    # a deck names no parts: what it has is the tower's foundation
    below = [replace(m, part=m.part or FOUNDATION) for m in based.members]
    under = [replace(b, part=b.part or FOUNDATION) for b in based.beams]
    nodes = dict(based.nodes) | above
    return replace(based, nodes=nodes, members=(*below, *members), beams=(*under, *beams))


def with_base(foundation: Structure, base_z_m: float | None = None) -> tuple[Structure, str]:
    """Return a foundation whose interface is one node, and that node's name.

    A single interface node is the base, unless this lies at another z. Several, which a transition piece
    holds together, follow a new node ``tower_base`` as one rigid body: in their middle, at the highest.

    Raises
    ------
    InputError
        If the foundation has no interface.
    """
    interface = foundation.interface_nodes
    require(
        interface,
        "the foundation has no interface for a tower to stand on",
        field="interface_nodes",
        value=[],
        remedy="name the nodes under the tower as interface_nodes",
    )
    points = np.array([foundation.nodes[node] for node in interface])
    z = float(points[:, 2].max()) if base_z_m is None else base_z_m
    leaders = {link.follower: link.leader for link in foundation.rigid_links}
    if len(interface) == 1 and abs(z - points[0, 2]) < _SAME_M:
        return foundation, interface[0]
    x, y = (float(v) for v in points[:, :2].mean(axis=0))
    # a node follows one that follows none: what follows an interface node follows the base instead
    heads = dict.fromkeys(leaders.get(node, node) for node in interface)
    links = [replace(link, leader=BASE) if link.leader in heads else link for link in foundation.rigid_links]
    links += [RigidLink(BASE, head) for head in heads]
    nodes = dict(foundation.nodes) | {BASE: (x, y, z)}
    based = replace(foundation, nodes=nodes, rigid_links=tuple(links), interface_nodes=(BASE,))
    return based, BASE


def read_elastodyn_tower(path: Path) -> tuple[float, FloatArray, list[BeamSection]]:
    """Return the tower of an ElastoDyn input file: z of its base from still water, heights over it, sections.

    ElastoDyn's tower has mass and bending stiffness alone; axial and torsional stiffness are those of a round
    steel tube of the same mass and bending. Between stations both go straight, and a piece has their mean.

    Raises
    ------
    InputError
        If a file is missing or lacks its table.
    """
    deck = read_deck(path, "ElastoDyn file")
    with located(file=path):
        base = deck.number("TowerBsHt")
        height = deck.number("TowerHt") - base
        name, remedy = deck.scalar("TwrFile", ""), "give the one that names the tower"
        require(name, "not an ElastoDyn input file", field="TwrFile", remedy=remedy)
        require(height > 0.0, "the tower has no height", field="TowerHt", value=height, allowed="> TowerBsHt")
    file = path.parent / name.replace("\\", "/")
    deck = read_deck(file, "ElastoDyn tower file")
    with located(file=file):
        rows = deck.table_below("HtFract", int(deck.number("NTwInpSt")))
        require(len(rows) > 1, "table is missing", field="HtFract", remedy="give an ElastoDyn tower file")
        names = ("htfract", "tmassden", "twfastif", "twssstif")
        at, mass, fore_aft, side_side = np.array([row.numbers(*names) for row in rows]).T
        factors = [to_float(deck.scalar(key, "1"), key) for key in ("AdjTwMa", "AdjFASt", "AdjSSSt")]
    stations = np.array([mass, fore_aft, side_side]).T * factors
    return base, at * height, [_steel(*numbers) for numbers in 0.5 * (stations[:-1] + stations[1:])]


def _steel(mass_kg_m: float, fore_aft_n_m2: float, side_side_n_m2: float) -> BeamSection:
    """Return a section of steel of a mass and bending stiffnesses; upright, its y is the global x."""
    A = mass_kg_m / STEEL.density_kg_m3
    I_x, I_y = fore_aft_n_m2 / STEEL.youngs_modulus_pa, side_side_n_m2 / STEEL.youngs_modulus_pa
    # half the area carries shear in a thin tube
    return BeamSection(A, 0.5 * A, 0.5 * A, I_x, I_y, I_x + I_y, I_x + I_y)
