"""Piles: beams held by distributed springs, lumped at their nodes.

Every layer is cut into an even number of equal elements and its springs are lumped by Simpson's rule: nodal
springs, as in a hand calculation, whose strain energy converges with the fourth power of the element length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, inf, pi
from typing import Annotated

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import InputError, require
from jackettwin.soil.laws.viscoelastic import Law, Prony, kelvin_voigt
from jackettwin.soil.support import ELASTIC, Spring, Support
from jackettwin.structure import PILES, Material, Member, Reaction, Section, Structure, Vector
from jackettwin.structure.model import require_wall

_MOST_ELEMENTS = 2000
"""Along a pile."""


@dataclass(frozen=True)
class Pile:
    """A vertical open tube driven to ``length_m`` below the mudline; a foundation file gives these keys.

    ``element_m`` bounds the length of its elements; None is half a diameter, which leaves 0.03 % in a head
    flexibility. A ``plugged`` tip bears on its full area, else on steel alone.
    """

    length_m: Annotated[float, Field(gt=0.0, le=300.0)]
    outer_diameter_m: Annotated[float, Field(ge=0.05, le=20.0)]
    thickness_m: Annotated[float, Field(ge=1e-3, le=10.0)]
    youngs_modulus_pa: Annotated[float, Field(ge=1e9, le=1e13)] = 210e9
    poisson_ratio: Annotated[float, Field(ge=0.0, lt=0.5)] = 0.3
    density_kg_m3: Annotated[float, Field(ge=500.0, le=50e3)] = 7850.0
    plugged: bool = False
    element_m: Annotated[float, Field(gt=0.0, le=300.0)] | None = None

    def __post_init__(self) -> None:
        require_wall("thickness_m", self.thickness_m, self.outer_diameter_m)
        for field, value in (("length_m", self.length_m), ("element_m", self.longest_element_m)):
            require(0.0 < value < inf, "must be positive", field=field, value=value, allowed="> 0")
        require(
            self.length_m <= _MOST_ELEMENTS * self.longest_element_m,
            "too many elements",
            field="element_m",
            value=self.element_m,
            allowed=f"≥ {self.length_m / _MOST_ELEMENTS:.3g} m for this length",
            remedy="leave it out: half a diameter leaves 0.03 %",
        )

    @cached_property
    def section(self) -> Section:
        """Its tube."""
        return Section(self.outer_diameter_m, self.thickness_m)

    @cached_property
    def material(self) -> Material:
        """Its steel."""
        E, nu, rho = self.youngs_modulus_pa, self.poisson_ratio, self.density_kg_m3
        return Material(youngs_modulus_pa=E, poisson_ratio=nu, density_kg_m3=rho)

    @property
    def longest_element_m(self) -> float:
        """Longest element allowed."""
        return 0.5 * self.outer_diameter_m if self.element_m is None else self.element_m

    @property
    def inner_diameter_m(self) -> float:
        """Of the soil inside."""
        return self.outer_diameter_m - 2.0 * self.thickness_m

    @property
    def elastic_modulus_m3(self) -> float:
        """Elastic section modulus of the tube."""
        D, d = self.outer_diameter_m, self.inner_diameter_m
        return pi / 32.0 * (D**4 - d**4) / D

    @property
    def tip_area_m2(self) -> float:
        """Area the soil under the tip pushes on."""
        hollow = 0.0 if self.plugged else self.inner_diameter_m
        return 0.25 * pi * (self.outer_diameter_m**2 - hollow**2)


@dataclass(frozen=True)
class Stations:
    """Where the soil acts on a pile.

    Attributes
    ----------
    node_depth : (n_nodes,) depth of the pile's nodes below the mudline [m]
    node, depth, weight, layer : (n_stations,)
        Node number, depth, pile length a spring stands for [m], and layer; a node on the edge of two
        layers has one station in each.
    """

    node_depth: FloatArray
    node: IntArray
    depth: FloatArray
    weight: FloatArray
    layer: IntArray

    def at_nodes(self, per_length: FloatArray) -> FloatArray:
        """Return nodal springs [N/m] from stiffness per length at the stations [N/m²]."""
        nodal = np.bincount(self.node, self.weight * per_length, minlength=self.node_depth.size)
        return np.asarray(nodal, dtype=np.float64)


def stations(pile: Pile, boundaries: FloatArray | tuple[float, ...] = ()) -> Stations:
    """Return the nodes of a pile and its Simpson stations, edges of layers (and of scour) at nodes."""
    inside = [float(z) for z in np.unique(boundaries) if 0.0 < z < pile.length_m]
    edges = np.array([0.0, *inside, pile.length_m])
    node_depth, parts = [np.zeros(1)], []
    first = 0
    for layer, (top, bottom) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
        n = 2 * max(1, ceil((bottom - top) / (2.0 * pile.longest_element_m) - 1e-9))
        z = np.linspace(top, bottom, n + 1)
        simpson = np.where(np.arange(n + 1) % 2 == 1, 4.0, 2.0)
        simpson[[0, -1]] = 1.0
        parts.append(
            (first + np.arange(n + 1), z, simpson * (bottom - top) / (3.0 * n), np.full(n + 1, layer))
        )
        node_depth.append(z[1:])
        first += n
    node, depth, weight, layers = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return Stations(np.concatenate(node_depth), node.astype(np.intp), depth, weight, layers.astype(np.intp))


@dataclass(frozen=True)
class PileSprings:
    """Linear springs on a pile's nodes: lateral, axial, torsional (n_nodes,) [N/m, N/m, N·m/rad].

    ``rocking`` (n_nodes,) [N·m/rad] is of ground that resists a stocky pile's turning; None is none.
    """

    node_depth: FloatArray
    lateral: FloatArray
    axial: FloatArray
    torsional: FloatArray
    rocking: FloatArray | None = None

    @property
    def by_node(self) -> FloatArray:
        """Springs (n_nodes, 6) of every node's translations and rotations."""
        turning = np.zeros_like(self.lateral) if self.rocking is None else self.rocking
        columns = (self.lateral, self.lateral, self.axial, turning, turning, self.torsional)
        return np.stack(columns, axis=1)


def linear_springs(
    pile: Pile,
    *,
    lateral: Callable[[FloatArray], FloatArray],
    axial: Callable[[FloatArray], FloatArray],
    tip_n_m: float = 0.0,
) -> PileSprings:
    """Return the springs of a soil given as stiffness per length k_h(z), k_v(z) [N/m²]; no torsional ones."""
    at = stations(pile, ())
    k_v = at.at_nodes(np.broadcast_to(axial(at.depth), at.depth.shape))
    k_v[-1] += tip_n_m
    k_h = at.at_nodes(np.broadcast_to(lateral(at.depth), at.depth.shape))
    return PileSprings(at.node_depth, k_h, k_v, np.zeros_like(k_h))


def dashpots(damping_ratio: float, omega1: float) -> Prony:
    """Return the law 1 + 2ζs/ω1 that puts c = 2ζk/ω1 beside every spring k, thesis eq. (5.4).

    >>> dashpots(0.02, 1.15).stiffness(1.15j)  # loss factor 2ζ at ω1
    array(1.+0.04j)
    """
    if not (damping_ratio >= 0.0 and omega1 > 0.0):
        raise InputError(
            "out of range", field="damping_ratio, omega1", value=(damping_ratio, omega1), allowed="≥ 0, > 0"
        )
    return kelvin_voigt(1.0, 2.0 * damping_ratio / omega1)


def with_piles(
    structure: Structure,
    pile: Pile,
    springs: PileSprings,
    *,
    law: Law = ELASTIC,
    dashpots: PileSprings | None = None,
) -> tuple[Structure, Support]:
    """Return the structure with a vertical pile under every reaction node, and the springs that hold it.

    The feet stay the reaction nodes (gravity's axial forces are found with these held). ``law`` scales every
    spring and is 1 at its static stiffness; ``dashpots`` [N·s/m] stand beside them (radiation).

    Raises
    ------
    InputError
        If the structure has no reaction nodes.
    """
    if not structure.reactions:
        raise InputError("the structure has no reaction nodes to put piles under", field="reaction_nodes")
    nodes, members, held = dict(structure.nodes), list(structure.members), []
    for foot in structure.reaction_nodes:
        below, tubes = pile_beams(foot, nodes[foot], pile, springs.node_depth)
        nodes |= below
        members += tubes
        held += _springs_at((foot, *below), springs, law)
        if dashpots is not None:
            held += _springs_at((foot, *below), dashpots, Prony(c=1.0))
    reactions = tuple(Reaction(foot) for foot in structure.reaction_nodes)
    piled = replace(structure, nodes=nodes, members=tuple(members), reactions=reactions)
    return piled, Support(springs=tuple(held))


def _springs_at(names: tuple[str, ...], springs: PileSprings, law: Law) -> list[Spring]:
    return [Spring(name, np.diag(row), law) for name, row in zip(names, springs.by_node, strict=True)]


def pile_beams(
    head: str, at: Vector, pile: Pile, node_depth: FloatArray
) -> tuple[dict[str, Vector], list[Member]]:
    """Return the nodes below a pile's head, and its members."""
    x, y, z = at
    below: dict[str, Vector] = {
        f"{head}/pile_{i}": (x, y, z - float(depth)) for i, depth in enumerate(node_depth[1:], start=1)
    }
    names = [head, *below]
    members = [
        Member(f"{a}-{b}", a, b, pile.section, pile.section, pile.material, PILES, elements=1)
        for a, b in zip(names[:-1], names[1:], strict=True)
    ]
    return below, members
