"""What a structure is made of: nodes, tubular members, materials, point masses, rigid links."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError, did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

FloatArray = npt.NDArray[np.float64]
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """Linear elastic, isotropic."""

    youngs_modulus_pa: float
    shear_modulus_pa: float
    density_kg_m3: float

    @classmethod
    def isotropic(cls, *, youngs_modulus_pa: float, poisson_ratio: float, density_kg_m3: float) -> Material:
        """Return a material with G = E / (2(1 + ν)) (thesis section 3.3.1)."""
        shear_modulus_pa = youngs_modulus_pa / (2.0 * (1.0 + poisson_ratio))
        return cls(youngs_modulus_pa, shear_modulus_pa, density_kg_m3)


STEEL = Material.isotropic(youngs_modulus_pa=210e9, poisson_ratio=0.3, density_kg_m3=7850.0)


@dataclass(frozen=True)
class Section:
    """A circular tube; ``thickness_m`` = radius makes it solid."""

    outer_diameter_m: float
    thickness_m: float

    def __post_init__(self) -> None:
        if not self.outer_diameter_m > 0.0:
            raise InputError(
                "diameter must be positive",
                field="outer_diameter_m",
                value=self.outer_diameter_m,
                allowed="> 0",
                remedy="give the outer diameter in metres",
            )
        if not 0.0 < self.thickness_m <= 0.5 * self.outer_diameter_m:
            raise InputError(
                "thickness must be positive and at most the radius",
                field="thickness_m",
                value=self.thickness_m,
                allowed=f"0 < thickness_m ≤ {0.5 * self.outer_diameter_m:g}",
                remedy="give the wall in metres",
            )


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
    """Which part of the structure it belongs to (``jacket``, ``transition_piece``, ``tower``)."""


@dataclass(frozen=True)
class PointMass:
    """A rigid body on a node: thesis eq. (3.21).

    ``inertia_kg_m2`` is the tensor about the body's own centre of gravity (xx, yy, zz, xy, xz, yz;
    the last three are tensor components, hence minus the products of inertia).
    """

    node: str
    mass_kg: float
    cg_offset_m: Vector = (0.0, 0.0, 0.0)
    inertia_kg_m2: tuple[float, float, float, float, float, float] = (0.0,) * 6
    part: str = ""


@dataclass(frozen=True)
class RigidLink:
    """``follower`` moves as one rigid body with ``leader``."""

    leader: str
    follower: str


@dataclass(frozen=True)
class Reaction:
    """How the structure's own file holds a node: fixed DOFs and, on the others, a 6×6 stiffness and mass."""

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
    parts: tuple[str, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        for index, member in enumerate(self.members):
            place = f"members.{member.name or index}"
            self._require(member.start, place)
            self._require(member.end, place)
            if np.linalg.norm(np.subtract(self.nodes[member.end], self.nodes[member.start])) <= 1e-9:
                raise InputError(
                    "member has zero length",
                    field=place,
                    value=[member.start, member.end],
                    remedy="join it to two nodes that lie apart, or make it a rigid link",
                )
        for kind, names in (
            ("masses", [m.node for m in self.masses]),
            ("rigid_links", [n for link in self.rigid_links for n in (link.leader, link.follower)]),
            ("reaction_nodes", [r.node for r in self.reactions]),
            ("interface_nodes", list(self.interface_nodes)),
        ):
            for name in names:
                self._require(name, kind)

    def _require(self, node: str, place: str) -> None:
        if node not in self.nodes:
            raise InputError(
                "no such node",
                field=place,
                value=node,
                remedy=did_you_mean(node, self.nodes) or "define it under nodes",
            )

    @property
    def reaction_nodes(self) -> tuple[str, ...]:
        """Names of the nodes that stand on the ground."""
        return tuple(reaction.node for reaction in self.reactions)

    @cached_property
    def top_node(self) -> str:
        """Name of the highest node."""
        return max(self.nodes, key=lambda name: self.nodes[name][2])

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
        known = sorted({member.part for member in self.members})
        if part not in known:
            raise InputError("no such part", field="part", value=part, allowed=", ".join(known))

        def scaled(member: Member) -> Member:
            if member.part != part:
                return member
            m = member.material
            return replace(
                member,
                material=Material(
                    m.youngs_modulus_pa * youngs_modulus,
                    m.shear_modulus_pa * youngs_modulus,
                    m.density_kg_m3 * density,
                ),
            )

        return replace(self, members=tuple(scaled(member) for member in self.members))
