"""A parametric jacket: legs, braced bays, transition piece and tower.

The classes are what a structure file gives under ``jacket``, key by key.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import AfterValidator

from jackettwin.arrays import FloatArray
from jackettwin.errors import require, require_between
from jackettwin.files import Placed, refuse_tiny
from jackettwin.structure.bracing import Face, Pattern, crossing, middle, rising, single
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


def _of_solid(material: Material) -> Material:
    refuse_tiny("density_kg_m3", material.density_kg_m3, least=500.0, remedy="kg/m³: steel has 7850")
    return material


MaterialInFile = Placed[Annotated[Material, AfterValidator(_of_solid)]]
"""A material as a file gives it: its density is nil or that of something solid."""


@dataclass(frozen=True)
class Lattice:
    """Legs and braces from the feet (``base_z_m``) to the leg tops, ``height_m`` above them.

    Bay heights form a geometric series with ratio (top_width/base_width)^(1/bays), so that all X-braces
    are similar, unless ``levels_z_m`` gives the levels between the bays; the leg wall goes linearly from the
    bottom bay to the top bay. Braces have one section, or one a bay from the bottom up; the mud braces have
    that of the lowest bay, ``horizontals`` (levels counted from 1, the top of the lowest bay) that of the bay
    below them. ``bracing`` is one pattern or one a bay; a K bay brings the horizontal that its braces meet,
    the topmost that of the transition piece's ring.
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
    bracing: Pattern | tuple[Pattern, ...] = "X"
    levels_z_m: tuple[float, ...] = ()
    horizontals: tuple[int, ...] = ()

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
        n, one_each = len(self.patterns), f"one pattern, or {self.bays}, one a bay"
        require(n == self.bays, "out of range", field="bracing", value=n, allowed=one_each)
        self._check_levels()

    def _check_levels(self) -> None:
        wanted = self.bays - 1
        require(
            not self.levels_z_m or len(self.levels_z_m) == wanted,
            "levels do not fit the bays",
            field="levels_z_m",
            value=len(self.levels_z_m),
            allowed=f"{wanted} levels between {self.bays} bays, or none",
        )
        levels = (self.base_z_m, *self.levels_z_m, self.top_z_m)
        require(
            all(below < above for below, above in pairwise(levels)),
            "levels do not rise from the feet to the leg tops",
            field="levels_z_m",
            value=list(self.levels_z_m),
            allowed=f"rising, between {self.base_z_m:g} and {self.top_z_m:g} m",
            remedy="give z in the structure's own frame",
        )
        for level in self.horizontals:
            require(
                1 <= level < self.bays,
                "no such level",
                field="horizontals",
                value=level,
                allowed=f"1 to {wanted}" if wanted else "none, with one bay",
                remedy="mud_braces are those of the feet, the ring that of the leg tops",
            )

    @property
    def top_z_m(self) -> float:
        """Z of the leg tops."""
        return self.base_z_m + self.height_m

    @property
    def braces(self) -> tuple[Section, ...]:
        """Section of every bay's braces, from the bottom up."""
        return self.brace if isinstance(self.brace, tuple) else (self.brace,) * self.bays

    @property
    def patterns(self) -> tuple[Pattern, ...]:
        """Bracing of every bay, from the bottom up."""
        return self.bracing if isinstance(self.bracing, tuple) else (self.bracing,) * self.bays

    @property
    def met_in_the_middle(self) -> frozenset[int]:
        """Levels whose horizontals carry the braces of a K at their middle."""
        return frozenset(bay + 1 for bay, pattern in enumerate(self.patterns) if pattern == "K")


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
    if lattice.levels_z_m:
        z = np.array([lattice.base_z_m, *lattice.levels_z_m, lattice.top_z_m]) - lattice.base_z_m
        return _with_widths(lattice, z)
    ratio = (lattice.top_width_m / lattice.base_width_m) ** (1.0 / lattice.bays)
    heights = ratio ** np.arange(lattice.bays)
    above = np.concatenate([[0.0], np.cumsum(heights / heights.sum())]) * lattice.height_m
    return _with_widths(lattice, above)


def _with_widths(lattice: Lattice, above: FloatArray) -> list[tuple[float, float]]:
    """Return (z, width) at heights above the feet; legs are straight."""
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
            _add_braces(lattice, face, bay, nodes, members)
    for leg in range(n if lattice.mud_braces else 0):
        ends = _leg_node(leg, 0), _leg_node((leg + 1) % n, 0)
        members.append(_member(f"mud_brace_{leg + 1}", ends, lattice.braces[0], lattice.material, "jacket"))


def _add_braces(
    lattice: Lattice, face: int, bay: int, nodes: dict[str, Vector], members: list[Member]
) -> None:
    """Add the braces of a bay's face, and the horizontal at its top where there is one below the leg tops."""
    left, right, level = face, (face + 1) % lattice.legs, bay + 1
    corners = Face(
        _leg_node(left, bay), _leg_node(right, bay), _leg_node(left, level), _leg_node(right, level)
    )
    pattern = lattice.patterns[bay]
    if pattern == "X":
        braces = crossing(nodes, corners, f"cross_{face + 1}_{level}")
    elif pattern == "K":
        apex = middle(nodes, corners.top_left, corners.top_right, f"mid_{face + 1}_{level}")
        braces = rising(corners, apex)
    else:
        braces = single(corners, bay)
    names = [(f"brace_{face + 1}_{level}{brace.suffix}", (brace.start, brace.end)) for brace in braces]
    meets = level in lattice.met_in_the_middle
    if level < lattice.bays and (meets or level in lattice.horizontals):
        names += _horizontal(f"horizontal_{face + 1}_{level}", corners, meets, f"mid_{face + 1}_{level}")
    members += [_member(name, ends, lattice.braces[bay], lattice.material, "jacket") for name, ends in names]


def _horizontal(name: str, face: Face, meets: bool, at: str) -> list[tuple[str, tuple[str, str]]]:
    """Return a horizontal at the top of a face: name and ends, of its halves where braces meet its middle."""
    left, right = face.top_left, face.top_right
    if not meets:
        return [(name, (left, right))]
    return [(f"{name}_1", (left, at)), (f"{name}_2", (at, right))]


def _add_transition_piece(
    tp: TransitionPiece, lattice: Lattice, nodes: dict[str, Vector], members: list[Member]
) -> None:
    nodes["tp_bottom"] = (0.0, 0.0, lattice.top_z_m)
    nodes["tp_top"] = (0.0, 0.0, tp.top_z_m)
    tops = [_leg_node(leg, lattice.bays) for leg in range(lattice.legs)]
    meets = lattice.bays in lattice.met_in_the_middle
    for leg, top in enumerate(tops):
        face = Face(top, top, top, tops[(leg + 1) % lattice.legs])
        for name, ends in (
            (f"tp_lower_{leg + 1}", (top, "tp_bottom")),
            (f"tp_upper_{leg + 1}", (top, "tp_top")),
            *_horizontal(f"tp_ring_{leg + 1}", face, meets, f"mid_{leg + 1}_{lattice.bays}"),
        ):
            members.append(_member(name, ends, tp.tube, tp.material, "transition_piece"))
    members.append(_member("tp_column", ("tp_bottom", "tp_top"), tp.column, tp.material, "transition_piece"))


def _add_tower(tower: Tower, z0: float, nodes: dict[str, Vector], members: list[Member]) -> None:
    names = ["tp_top", *(f"tower_{k}" for k in range(1, tower.elements)), "tower_top"]
    for k, name in enumerate(names[1:], start=1):
        nodes[name] = (0.0, 0.0, z0 + tower.height_m * k / tower.elements)
    for k, (ends, tube) in enumerate(zip(pairwise(names), tower_tubes(tower), strict=True), start=1):
        members.append(_member(f"tower_{k}", ends, tube, tower.material, "tower"))


def tower_tubes(tower: Tower) -> list[Section]:
    """Return the tubes of a tower's pieces, from the bottom up."""
    bottom, top = tower.bottom, tower.top
    return [
        Section(
            bottom.outer_diameter_m + at * (top.outer_diameter_m - bottom.outer_diameter_m),
            bottom.thickness_m + at * (top.thickness_m - bottom.thickness_m),
        )
        for at in ((k + 0.5) / tower.elements for k in range(tower.elements))
    ]


def _member(name: str, ends: tuple[str, str], section: Section, material: Material, part: str) -> Member:
    return Member(name, ends[0], ends[1], section, section, material, part)
