"""Components of a structure: nodes, members, materials, point masses, rigid links."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import dist, inf, isnan, nan
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, did_you_mean, located, look_up, require, require_between
from jackettwin.structure.two_node import BeamSection, TwoNodeElement

if TYPE_CHECKING:
    from collections.abc import Collection, Container, Iterable, Mapping

Vector = tuple[float, float, float]
PILES = "piles"
"""The part of members that stand in the ground, which holds them along their length; no water loads them."""
T = TypeVar("T", "Member", "Beam")
_LONGEST_M = 5e3
"""Longer than any member of a structure; a length in millimetres exceeds it."""
Inertia = tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class Material:
    """Linear elastic, isotropic: G = E / (2(1 + ν)), thesis section 3.3.1. Give G, or else ν counts."""

    youngs_modulus_pa: float = 210e9
    shear_modulus_pa: float = nan
    density_kg_m3: float = 7850.0
    poisson_ratio: float = field(default=0.3, compare=False)

    def __post_init__(self) -> None:
        # generous bounds: they only keep typing errors and overflow out
        require_between("youngs_modulus_pa", self.youngs_modulus_pa, 1e3, 1e18)
        require_between("density_kg_m3", self.density_kg_m3, 0.0, 1e8)
        E, G, nu = self.youngs_modulus_pa, self.shear_modulus_pa, self.poisson_ratio
        if isnan(G):
            require(0.0 <= nu < 0.5, "out of range", field="poisson_ratio", value=nu, allowed="≥ 0, < 0.5")
            object.__setattr__(self, "shear_modulus_pa", E / (2.0 * (1.0 + nu)))
        else:
            require_between("shear_modulus_pa", G, 1e3, 1e18)
            object.__setattr__(self, "poisson_ratio", E / (2.0 * G) - 1.0)


STEEL = Material()


def require_wall(field: str, thickness_m: float, outer_diameter_m: float) -> None:
    """Refuse a wall that a tube of this diameter cannot have.

    Raises
    ------
    InputError
        Names the field that the wall was given by.
    """
    require(
        0.0 < thickness_m <= 0.5 * outer_diameter_m,
        "thickness must be positive and at most the radius",
        field=field,
        value=thickness_m,
        allowed=f"0 < {field} ≤ {0.5 * outer_diameter_m:g}",
        remedy="give the wall in metres",
    )


@dataclass(frozen=True)
class Section:
    """A circular tube; ``thickness_m`` = radius makes it solid."""

    outer_diameter_m: float
    thickness_m: float

    def __post_init__(self) -> None:
        require_between("outer_diameter_m", self.outer_diameter_m, 1e-4, 1e3)
        require_wall("thickness_m", self.thickness_m, self.outer_diameter_m)

    @property
    def slenderness(self) -> float:
        """Diameter over wall thickness."""
        return self.outer_diameter_m / self.thickness_m


@dataclass(frozen=True)
class Member:
    """A straight tube between two nodes; with two different sections it is conical."""

    name: str
    start: str
    end: str
    section_start: Section
    section_end: Section
    material: Material
    part: str = ""
    """Which part of the structure it belongs to (``jacket``, ``transition_piece``, ``tower``, ``piles``)."""
    elements: int | None = None
    """Number of elements it is divided into; None leaves that to the structure and the analysis."""


@dataclass(frozen=True)
class Beam:
    """A straight uniform beam of any section between two nodes; tubes are members.

    ``twist_rad`` turns the section about the beam, right-handed, from where its x is the beam's local y,
    which is level, and its y the local z, which points upwards; of vertical beams, the global −y and x.
    """

    name: str
    start: str
    end: str
    section: BeamSection
    material: Material
    twist_rad: float = 0.0
    part: str = ""
    shape: str = "any section"
    """Name of its section."""
    elements: int | None = None
    """Number of elements it is divided into; None leaves that to the structure and the analysis."""

    def __post_init__(self) -> None:
        require_between("twist_rad", self.twist_rad, -1e3, 1e3)
        for key in ("A", "I_x", "I_y", "I_p", "J", "A_x", "A_y"):
            value = getattr(self.section, key)
            stiff = value > 0.0 and (value < inf or key in ("A_x", "A_y"))
            require(stiff, "must be positive", field=f"{self.name}.{key}", value=value, allowed="> 0")


@dataclass(frozen=True)
class PointMass:
    """A rigid body on a node: thesis eq. (3.21).

    ``inertia_kg_m2`` is the tensor about the body's own centre of gravity (xx, yy, zz, xy, xz, yz;
    the last three are tensor components, hence minus the products of inertia).
    """

    node: str
    mass_kg: float
    cg_offset_m: Vector = (0.0, 0.0, 0.0)
    inertia_kg_m2: Inertia = (0.0,) * 6
    part: str = ""

    def __post_init__(self) -> None:
        require_between("mass_kg", self.mass_kg, 0.0, 1e12)
        for value in self.cg_offset_m:
            require_between("cg_offset_m", value, -1e4, 1e4)
        inertia = self.inertia_kg_m2
        least = -1e-6 * max(np.abs(inertia))
        require(
            np.isfinite(inertia).all() and np.linalg.eigvalsh(self.inertia_tensor).min() >= least,
            "inertia about the centre of gravity must not be negative in any direction",
            field="inertia_kg_m2",
            value=inertia,
            remedy="state it about the centre of gravity, or give both moments about the node",
        )

    @property
    def inertia_tensor(self) -> FloatArray:
        """Inertia about the centre of gravity, (3, 3) [kg·m²]."""
        xx, yy, zz, xy, xz, yz = self.inertia_kg_m2
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@dataclass(frozen=True)
class RigidLink:
    """``follower`` moves as one rigid body with ``leader``; it turns freely about the axes in ``release``."""

    leader: str
    follower: str
    release: tuple[Vector, ...] = ()


@dataclass(frozen=True)
class Reaction:
    """Support of a node in the structure's own file: fixed DOFs, and a 6×6 stiffness and mass elsewhere."""

    node: str
    fixed: tuple[bool, bool, bool, bool, bool, bool] = (True, True, True, False, False, False)
    stiffness: tuple[tuple[float, ...], ...] | None = None
    mass: tuple[tuple[float, ...], ...] | None = None


@dataclass(frozen=True)
class Structure:
    """A frame of tubular members. A value: the ``with_`` methods return a new one.

    ``nodes`` maps a name to (x, y, z) [m]; ``sea_level_z_m`` is the mean sea level in that frame.
    """

    name: str
    nodes: Mapping[str, Vector]
    members: tuple[Member, ...]
    masses: tuple[PointMass, ...] = ()
    rigid_links: tuple[RigidLink, ...] = ()
    reactions: tuple[Reaction, ...] = ()
    interface_nodes: tuple[str, ...] = ()
    sea_level_z_m: float = 0.0
    subdivide: int = 1
    """Elements a member unless the analysis says otherwise."""
    beam: str = "euler-bernoulli"
    rotary_inertia: bool = False
    shear_in_mass: bool = True
    """Whether the mass of Timoshenko beams knows their shear; SubDyn's does not."""
    elements: tuple[TwoNodeElement, ...] = ()
    """Cables, springs and whatever else is known by its matrices."""
    beams: tuple[Beam, ...] = ()

    def __repr__(self) -> str:
        return (
            f"Structure({self.name!r}, {len(self.nodes)} nodes, {len(self.members)} members, "
            f"{len(self.masses)} masses, {len(self.reactions)} feet)"
        )

    def __post_init__(self) -> None:
        for name, point in self.nodes.items():
            with located(field=f"nodes.{name}"):
                for value in point:
                    require_between("coordinate", value, -1e6, 1e6)
        self._check_members()
        for kind, names in (
            ("masses", [m.node for m in self.masses]),
            ("rigid_links", [n for link in self.rigid_links for n in (link.leader, link.follower)]),
            ("elements", [n for element in self.elements for n in (element.start, element.end)]),
            ("reaction_nodes", [r.node for r in self.reactions]),
            ("interface_nodes", list(self.interface_nodes)),
        ):
            for name in names:
                self._require(name, kind)
        self._check_links()
        self._check_connected()

    def _check_members(self) -> None:
        names: set[str] = set()
        for member in self.bars:
            name, ends = member.name, (member.start, member.end)
            place = f"members.{name}"
            if name in names:
                remedy = "rename one of them"
                raise InputError("two members have this name", field=place, value=name, remedy=remedy)
            names.add(name)
            for end in ends:
                self._require(end, place)
            length = dist(self.nodes[member.start], self.nodes[member.end])
            if length > _LONGEST_M:
                raise InputError(
                    "member is too long",
                    field=place,
                    value=length,
                    allowed=f"up to {_LONGEST_M:g} m",
                    remedy=f"check nodes {' and '.join(ends)}: coordinates are in metres",
                )
            if length <= 1e-6:
                remedy = "join it to two nodes that lie apart, or make it a rigid link"
                raise InputError("member has zero length", field=place, value=list(ends), remedy=remedy)

    def _check_links(self) -> None:
        followers = [link.follower for link in self.rigid_links]
        leaders = {link.leader for link in self.rigid_links}
        for name in followers:
            require(
                followers.count(name) == 1 and name not in leaders,
                "rigid links chain, loop or share a follower",
                field="rigid_links",
                value=name,
                remedy="let every follower have one leader that follows nobody",
            )
        for name in self.reaction_nodes:
            require(
                name not in followers and self.reaction_nodes.count(name) == 1,
                "reaction node is given twice or follows another by a rigid link",
                field="reaction_nodes",
                value=name,
                remedy="name it once, and make it the leader of its rigid links",
            )

    def _check_connected(self) -> None:
        """Refuse nodes that members and rigid links do not join to the first member."""
        require(self.joined, "a structure needs members", field="members", value=[], remedy="add members")
        reached = reached_by(self.joined, {self.joined[0][0]})
        loose = [name for name in self.nodes if name not in reached]
        require(
            not loose,
            "node is not connected to the structure",
            field=f"nodes.{loose[0]}" if loose else None,
            value=loose[0] if len(loose) == 1 else loose,
            remedy="join it by a member or a rigid link, or delete it",
        )

    def _require(self, node: str, place: str) -> None:
        if node not in self.nodes:
            remedy = did_you_mean(node, self.nodes) or "define it under nodes"
            raise InputError("no such node", field=place, value=node, remedy=remedy)

    @property
    def bars(self) -> tuple[Member | Beam, ...]:
        """Members, then beams of any section."""
        return (*self.members, *self.beams)

    @property
    def joined(self) -> tuple[tuple[str, str], ...]:
        """Pairs of nodes that a member, an element or a rigid link joins."""
        return (
            *((m.start, m.end) for m in self.bars),
            *((e.start, e.end) for e in self.elements),
            *((link.leader, link.follower) for link in self.rigid_links),
        )

    @property
    def reaction_nodes(self) -> tuple[str, ...]:
        """Names of the nodes that stand on the ground."""
        return tuple(reaction.node for reaction in self.reactions)

    @cached_property
    def buried_nodes(self) -> tuple[str, ...]:
        """Names of the nodes along piles, below their heads."""
        above = {n for m in self.members if m.part != PILES for n in (m.start, m.end)}
        piles = dict.fromkeys(n for m in self.members if m.part == PILES for n in (m.start, m.end))
        return tuple(n for n in piles if n not in above and n not in self.reaction_nodes)

    @cached_property
    def top_node(self) -> str:
        """Name of the highest node."""
        return max(self.nodes, key=lambda name: self.nodes[name][2])

    def with_theory(self, beam: str | None, rotary_inertia: bool | None) -> Structure:
        """Return the structure with other beams, where given: also of the piles lumped at its feet."""
        return replace(
            self,
            beam=self.beam if beam is None else beam,
            rotary_inertia=self.rotary_inertia if rotary_inertia is None else rotary_inertia,
        )

    def with_masses(self, masses: tuple[PointMass, ...]) -> Structure:
        """Return the structure with other point masses."""
        return replace(self, masses=masses)

    def with_material(self, part: str, *, youngs_modulus: float = 1.0, density: float = 1.0) -> Structure:
        """Return the structure with the stiffness (E and G) and density of one part scaled.

        Raises
        ------
        InputError
            If no member belongs to the part.
        """
        look_up({m.part: m for m in self.bars}, part, "part", field="part")

        def scaled(m: Material) -> Material:
            stiffness = m.youngs_modulus_pa * youngs_modulus, m.shear_modulus_pa * youngs_modulus
            return Material(*stiffness, m.density_kg_m3 * density)

        def changed(bar: T) -> T:
            return replace(bar, material=scaled(bar.material)) if bar.part == part else bar

        members, beams = tuple(map(changed, self.members)), tuple(map(changed, self.beams))
        return replace(self, members=members, beams=beams)


def reached_by(
    joined: Iterable[tuple[str, str]], start: Collection[str], stop: Container[str] = ()
) -> set[str]:
    """Return the nodes that lead to some others over pairs that are joined, without passing ``stop``.

    >>> sorted(reached_by([("a", "b"), ("b", "c"), ("c", "d")], ["a"], stop={"d"}))
    ['a', 'b', 'c']
    """
    neighbours: dict[str, list[str]] = defaultdict(list)
    for a, b in joined:
        neighbours[a].append(b)
        neighbours[b].append(a)
    reached, stack = set(start), list(start)
    while stack:
        for name in neighbours[stack.pop()]:
            if name not in reached and name not in stop:
                reached.add(name)
                stack.append(name)
    return reached
