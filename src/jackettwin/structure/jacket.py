"""A parametric jacket: legs, X-braced bays, transition piece, tower, and what hangs on the legs.

The classes are what a structure file gives under ``jacket``, key by key.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, Field

from jackettwin.errors import require, require_between
from jackettwin.files import Placed, refuse_tiny
from jackettwin.structure.model import (
    STEEL,
    Material,
    Member,
    PointMass,
    Reaction,
    Section,
    Structure,
    Vector,
    require_wall,
)

FURTHEST_M = 20.0
"""How far beyond the legs' ends an appurtenance may lie [m]: a boat landing, not a slip of the pen."""


def _of_solid(material: Material) -> Material:
    refuse_tiny("density_kg_m3", material.density_kg_m3, least=500.0, remedy="kg/m³: steel has 7850")
    return material


MaterialInFile = Placed[Annotated[Material, AfterValidator(_of_solid)]]
"""A material as a file gives it: its density is nil or that of something solid."""


@dataclass(frozen=True)
class Lattice:
    """Legs and braces from the feet (``base_z_m``) to the leg tops, ``height_m`` above them.

    Bay heights form a geometric series with ratio (top_width/base_width)^(1/bays), so that all X-braces
    are similar; the leg wall goes linearly from the bottom bay to the top bay. Braces have one section, or
    one a bay from the bottom up; the mud braces have that of the lowest bay.
    """

    base_width_m: float
    top_width_m: float
    height_m: float
    leg_diameter_m: float
    leg_thickness_bottom_m: float
    leg_thickness_top_m: float
    brace: Placed[Section] | tuple[Placed[Section], ...]
    legs: int = 4
    bays: int = 4
    material: MaterialInFile = STEEL
    mud_braces: bool = True
    base_z_m: float = 0.0

    def __post_init__(self) -> None:
        require_between("legs", self.legs, 3, 24)
        require_between("bays", self.bays, 1, 100)
        for field in ("base_width_m", "top_width_m", "height_m"):
            require_between(field, getattr(self, field), 1e-3, 1e3, "m")
        require_between("leg_diameter_m", self.leg_diameter_m, 1e-4, 1e3, "m")
        for field in ("leg_thickness_bottom_m", "leg_thickness_top_m"):
            require_wall(field, getattr(self, field), self.leg_diameter_m)
        n, one_each = len(self.braces), f"one section, or {self.bays}, one a bay"
        require(n == self.bays, "out of range", field="brace", value=n, allowed=one_each)

    @property
    def top_z_m(self) -> float:
        """Z of the leg tops."""
        return self.base_z_m + self.height_m

    @property
    def braces(self) -> tuple[Section, ...]:
        """Section of every bay's braces, from the bottom up."""
        return self.brace if isinstance(self.brace, tuple) else (self.brace,) * self.bays


@dataclass(frozen=True)
class TransitionPiece:
    """Two tubes from each leg top to the lower and upper centre nodes, a ring, and a centre column."""

    top_z_m: float
    tube: Placed[Section]
    column: Placed[Section]
    material: MaterialInFile = STEEL


@dataclass(frozen=True)
class Tower:
    """A tapered tube in ``elements`` pieces of constant section (the mean of each piece)."""

    height_m: float
    bottom: Placed[Section]
    top: Placed[Section]
    elements: int = 12
    material: MaterialInFile = STEEL

    def __post_init__(self) -> None:
        require_between("elements", self.elements, 1, 1000)
        require_between("height_m", self.height_m, 1e-3, 1e3, "m")


@dataclass(frozen=True)
class Appurtenance:
    """A mass that carries nothing, even along the height between two levels: boat landing, anodes, growth.

    ``legs`` on which it hangs count from 1; empty is all.
    """

    mass_kg: Annotated[float, Field(ge=0.0, le=1e9)]
    bottom_z_m: float
    top_z_m: float
    legs: tuple[Annotated[int, Field(ge=1)], ...] = ()

    def __post_init__(self) -> None:
        low, high = self.bottom_z_m, f"up to top_z_m = {self.top_z_m:g}"
        require(low <= self.top_z_m, "levels are reversed", field="bottom_z_m", value=low, allowed=high)

    def on(self, structure: Structure, name: str) -> list[PointMass]:
        """Return its masses on the leg nodes of a jacket.

        Every leg's share goes to its nodes so that mass and centre of gravity are kept where the span lies
        between the leg's ends: each slice is carried by the nodes above and below it, as by a lever.

        Raises
        ------
        InputError
            If the span is far from the legs, or there is no such leg.
        """
        every = _legs(structure)
        unknown = next((leg for leg in self.legs if leg > len(every)), None)
        require(unknown is None, "no such leg", field="legs", value=unknown, allowed=f"1 to {len(every)}")
        chosen = [every[leg - 1] for leg in self.legs] or every
        masses: list[PointMass] = []
        for nodes in chosen:
            z = np.array([structure.nodes[node][2] for node in nodes])
            require(
                self.bottom_z_m <= z[-1] + FURTHEST_M and self.top_z_m >= z[0] - FURTHEST_M,
                "lies beyond the legs",
                field="bottom_z_m",
                value=(self.bottom_z_m, self.top_z_m),
                allowed=f"levels from {z[0]:g} to {z[-1]:g} m",
                remedy="give z in the structure's own frame",
            )
            slices = np.clip(np.linspace(self.bottom_z_m, self.top_z_m, 201), z[0], z[-1])
            # a linear hat on each node: the lever rule
            shares = np.array([np.interp(slices, z, row).mean() for row in np.eye(len(z))])
            masses += [
                PointMass(node, float(share) * self.mass_kg / len(chosen), part=name)
                for node, share in zip(nodes, shares, strict=True)
                if share > 0.0
            ]
        return masses


def _legs(structure: Structure) -> list[list[str]]:
    """Return the nodes of every leg from the foot up."""
    feet = [node for node in structure.nodes if node.startswith("foot_")]
    return [
        [foot, *(node for node in structure.nodes if node.startswith(f"leg_{foot.removeprefix('foot_')}_"))]
        for foot in feet
    ]


def jacket(
    *,
    name: str,
    lattice: Lattice,
    transition_piece: TransitionPiece,
    tower: Tower,
    rna: PointMass | None,
    sea_level_z_m: float,
) -> Structure:
    """Return the structure; its reaction nodes are ``foot_1`` …, its tower top is ``tower_top``.

    Raises
    ------
    InputError
        If the transition piece does not stand above the legs.
    """
    require(
        transition_piece.top_z_m > lattice.top_z_m,
        "out of range",
        field="transition_piece.top_z_m",
        value=transition_piece.top_z_m,
        allowed=f"> base_z_m + height_m = {lattice.top_z_m:g}",
        remedy="check the number and its unit",
    )
    nodes: dict[str, Vector] = {}
    members: list[Member] = []
    _add_lattice(lattice, nodes, members)
    _add_transition_piece(transition_piece, lattice, nodes, members)
    _add_tower(tower, transition_piece.top_z_m, nodes, members)
    return Structure(
        name=name,
        nodes=nodes,
        members=tuple(members),
        masses=(rna,) if rna is not None else (),
        reactions=tuple(Reaction(_leg_node(leg, 0)) for leg in range(lattice.legs)),
        interface_nodes=("tp_top",),
        sea_level_z_m=sea_level_z_m,
    )


def _leg_node(leg: int, level: int) -> str:
    return f"foot_{leg + 1}" if level == 0 else f"leg_{leg + 1}_{level}"


def _levels(lattice: Lattice) -> list[tuple[float, float]]:
    """Return (z, width) of every level."""
    ratio = (lattice.top_width_m / lattice.base_width_m) ** (1.0 / lattice.bays)
    heights = ratio ** np.arange(lattice.bays)
    above = np.concatenate([[0.0], np.cumsum(heights / heights.sum())]) * lattice.height_m
    width = lattice.base_width_m + (lattice.top_width_m - lattice.base_width_m) * above / lattice.height_m
    return [(lattice.base_z_m + float(a), float(b)) for a, b in zip(above, width, strict=True)]


def _add_lattice(lattice: Lattice, nodes: dict[str, Vector], members: list[Member]) -> None:
    n, levels = lattice.legs, _levels(lattice)
    angles = np.pi * (2 * np.arange(n) + 1) / n
    for level, (z, width) in enumerate(levels):
        radius = 0.5 * width / np.sin(np.pi / n)
        for leg, angle in enumerate(angles):
            nodes[_leg_node(leg, level)] = (float(radius * np.cos(angle)), float(radius * np.sin(angle)), z)
    walls = np.linspace(lattice.leg_thickness_bottom_m, lattice.leg_thickness_top_m, lattice.bays)
    for bay in range(lattice.bays):
        leg_section = Section(lattice.leg_diameter_m, float(walls[bay]))
        for leg in range(n):
            ends = _leg_node(leg, bay), _leg_node(leg, bay + 1)
            members.append(
                _member(f"leg_{leg + 1}_bay_{bay + 1}", ends, leg_section, lattice.material, "jacket")
            )
        for face in range(n):
            _add_cross(lattice, face, bay, nodes, members)
    for leg in range(n if lattice.mud_braces else 0):
        ends = _leg_node(leg, 0), _leg_node((leg + 1) % n, 0)
        members.append(_member(f"mud_brace_{leg + 1}", ends, lattice.braces[0], lattice.material, "jacket"))


def _add_cross(
    lattice: Lattice, face: int, bay: int, nodes: dict[str, Vector], members: list[Member]
) -> None:
    """Add one X-brace: four segments that meet where the diagonals of the trapezium cross."""
    left, right = face, (face + 1) % lattice.legs
    corners = [
        _leg_node(left, bay),
        _leg_node(right, bay + 1),
        _leg_node(right, bay),
        _leg_node(left, bay + 1),
    ]
    a, b, c, d = (np.array(nodes[corner]) for corner in corners)
    at = np.linalg.norm(c - a) / (np.linalg.norm(c - a) + np.linalg.norm(b - d))
    x, y, z = a + at * (b - a)
    centre = f"cross_{face + 1}_{bay + 1}"
    nodes[centre] = (float(x), float(y), float(z))
    for k, corner in enumerate(corners, start=1):
        name = f"brace_{face + 1}_{bay + 1}_{k}"
        members.append(_member(name, (corner, centre), lattice.braces[bay], lattice.material, "jacket"))


def _add_transition_piece(
    tp: TransitionPiece, lattice: Lattice, nodes: dict[str, Vector], members: list[Member]
) -> None:
    nodes["tp_bottom"] = (0.0, 0.0, lattice.top_z_m)
    nodes["tp_top"] = (0.0, 0.0, tp.top_z_m)
    tops = [_leg_node(leg, lattice.bays) for leg in range(lattice.legs)]
    for leg, top in enumerate(tops):
        for kind, ends in (
            ("lower", (top, "tp_bottom")),
            ("upper", (top, "tp_top")),
            ("ring", (top, tops[(leg + 1) % lattice.legs])),
        ):
            members.append(_member(f"tp_{kind}_{leg + 1}", ends, tp.tube, tp.material, "transition_piece"))
    members.append(_member("tp_column", ("tp_bottom", "tp_top"), tp.column, tp.material, "transition_piece"))


def _add_tower(tower: Tower, z0: float, nodes: dict[str, Vector], members: list[Member]) -> None:
    names = ["tp_top", *(f"tower_{k}" for k in range(1, tower.elements)), "tower_top"]
    for k, name in enumerate(names[1:], start=1):
        nodes[name] = (0.0, 0.0, z0 + tower.height_m * k / tower.elements)
    for k, ends in enumerate(pairwise(names)):
        at = (k + 0.5) / tower.elements
        section = Section(
            tower.bottom.outer_diameter_m + at * (tower.top.outer_diameter_m - tower.bottom.outer_diameter_m),
            tower.bottom.thickness_m + at * (tower.top.thickness_m - tower.bottom.thickness_m),
        )
        members.append(_member(f"tower_{k + 1}", ends, section, tower.material, "tower"))


def _member(name: str, ends: tuple[str, str], section: Section, material: Material, part: str) -> Member:
    return Member(name, ends[0], ends[1], section, section, material, part)
