"""A parametric jacket: legs, X-braced bays, transition piece, tower, rotor-nacelle assembly."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jackettwin.errors import InputError, located
from jackettwin.structure.model import Material, Member, PointMass, Reaction, Section, Structure, Vector


@dataclass(frozen=True)
class Lattice:
    """Legs and braces from the feet (``base_z_m``) to the leg tops, ``height_m`` above them.

    Bay heights form a geometric series with ratio (top_width/base_width)^(1/bays), so that all X-braces
    are similar; the leg wall goes linearly from the bottom bay to the top bay. Braces have one section, or
    one a bay from the bottom up; the mud braces have that of the lowest bay.
    """

    legs: int
    bays: int
    base_width_m: float
    top_width_m: float
    height_m: float
    leg_diameter_m: float
    leg_thickness_bottom_m: float
    leg_thickness_top_m: float
    brace: Section | tuple[Section, ...]
    material: Material
    mud_braces: bool = True
    base_z_m: float = 0.0

    @property
    def top_z_m(self) -> float:
        """Z of the leg tops."""
        return self.base_z_m + self.height_m

    def brace_of(self, bay: int) -> Section:
        """Return the section of a bay's braces; bays count from 0 at the bottom."""
        return self.brace[bay] if isinstance(self.brace, tuple) else self.brace


@dataclass(frozen=True)
class TransitionPiece:
    """Two tubes from each leg top to the lower and upper centre nodes, a ring, and a centre column."""

    top_z_m: float
    tube: Section
    column: Section
    material: Material


@dataclass(frozen=True)
class Tower:
    """A tapered tube in ``elements`` pieces of constant section (the mean of each piece)."""

    height_m: float
    elements: int
    bottom: Section
    top: Section
    material: Material


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
        If fewer than three legs or no bay are asked for, or a part has no height.
    """
    _require(3 <= lattice.legs <= 24, "lattice.legs", lattice.legs, "3 to 24")
    _require(1 <= lattice.bays <= 100, "lattice.bays", lattice.bays, "1 to 100")
    for field in ("base_width_m", "top_width_m", "height_m"):
        value = getattr(lattice, field)
        _require(1e-3 <= value <= 1e3, f"lattice.{field}", value, "1 mm to 1000 m")
    _require(1 <= tower.elements <= 1000, "tower.elements", tower.elements, "1 to 1000")
    _require(0.0 < tower.height_m <= 1e3, "tower.height_m", tower.height_m, "> 0, at most 1000 m")
    n_braces = len(lattice.brace) if isinstance(lattice.brace, tuple) else lattice.bays
    _require(
        n_braces == lattice.bays, "lattice.brace", n_braces, f"one section, or {lattice.bays}, one a bay"
    )
    _require(
        transition_piece.top_z_m > lattice.top_z_m,
        "transition_piece.top_z_m",
        transition_piece.top_z_m,
        f"> base_z_m + height_m = {lattice.top_z_m:g}",
    )
    nodes: dict[str, Vector] = {}
    members: list[Member] = []
    _add_lattice(lattice, nodes, members)
    _add_transition_piece(transition_piece, lattice, nodes, members)
    _add_tower(tower, transition_piece.top_z_m, nodes, members)
    feet = tuple(_leg_node(leg, 0) for leg in range(lattice.legs))
    return Structure(
        name=name,
        nodes=nodes,
        members=tuple(members),
        masses=(rna,) if rna is not None else (),
        reactions=tuple(Reaction(foot) for foot in feet),
        interface_nodes=("tp_top",),
        sea_level_z_m=sea_level_z_m,
    )


def _require(condition: bool, field: str, value: object, allowed: str) -> None:
    if not condition:
        raise InputError(
            "out of range", field=field, value=value, allowed=allowed, remedy="check the number and its unit"
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
        with located(field="lattice.leg"):
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
        members.append(_member(f"mud_brace_{leg + 1}", ends, lattice.brace_of(0), lattice.material, "jacket"))


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
        members.append(_member(name, (corner, centre), lattice.brace_of(bay), lattice.material, "jacket"))


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
