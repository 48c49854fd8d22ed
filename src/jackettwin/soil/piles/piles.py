"""Piles: beams held by distributed springs, lumped at their nodes.

Every layer is cut into an even number of equal elements and its springs are lumped by Simpson's rule: nodal
springs, as in a hand calculation, whose strain energy converges with the fourth power of the element length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, pi

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.errors import InputError
from jackettwin.soil.laws.viscoelastic import Law, Prony, kelvin_voigt
from jackettwin.soil.support import ELASTIC, Spring, Support
from jackettwin.structure import Material, Section, Structure
from jackettwin.structure.model import STEEL, Member, Reaction, Vector


@dataclass(frozen=True)
class Pile:
    """A vertical open tube driven to ``length_m`` below the mudline.

    ``spacing_m`` bounds the length of its elements; None is half a diameter, which leaves 0.03 % in a head
    flexibility.
    """

    length_m: float
    section: Section
    material: Material = STEEL
    spacing_m: float | None = None
    plugged: bool = False
    """Whether the tip bears on its full area, or on steel alone."""

    def __post_init__(self) -> None:
        for field in ("length_m", "spacing_m"):
            value = getattr(self, field)
            if value is not None and not (np.isfinite(value) and value > 0.0):
                raise InputError("must be positive", field=f"pile.{field}", value=value, allowed="> 0")

    @property
    def element_m(self) -> float:
        """Longest element allowed."""
        return 0.5 * self.section.outer_diameter_m if self.spacing_m is None else self.spacing_m

    @property
    def tip_area_m2(self) -> float:
        """Area the soil under the tip pushes on."""
        D, t = self.section.outer_diameter_m, self.section.thickness_m
        return 0.25 * pi * (D**2 if self.plugged else D**2 - (D - 2.0 * t) ** 2)


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
        n = 2 * max(1, ceil((bottom - top) / (2.0 * pile.element_m) - 1e-9))
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
    """Linear springs on a pile's nodes: lateral, axial, torsional (n_nodes,) [N/m, N/m, N·m/rad]."""

    node_depth: FloatArray
    lateral: FloatArray
    axial: FloatArray
    torsional: FloatArray


def linear_springs(
    pile: Pile,
    *,
    lateral: Callable[[FloatArray], FloatArray],
    axial: Callable[[FloatArray], FloatArray],
    tip_n_m: float = 0.0,
    boundaries: tuple[float, ...] = (),
) -> PileSprings:
    """Return the springs of a soil given as stiffness per length k_h(z), k_v(z) [N/m²]; no torsional ones."""
    at = stations(pile, boundaries)
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
        held += _held((foot, *below), springs, law)
        if dashpots is not None:
            held += _held((foot, *below), dashpots, Prony(c=1.0))
    reactions = tuple(Reaction(foot) for foot in structure.reaction_nodes)
    piled = replace(structure, nodes=nodes, members=tuple(members), reactions=reactions)
    return piled, Support(springs=tuple(held))


def _held(names: tuple[str, ...], springs: PileSprings, law: Law) -> list[Spring]:
    return [
        Spring(name, np.diag([h, h, v, 0.0, 0.0, t]), law)
        for name, h, v, t in zip(names, springs.lateral, springs.axial, springs.torsional, strict=True)
    ]


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
        Member(f"{a}-{b}", a, b, pile.section, pile.section, pile.material, "piles")
        for a, b in zip(names[:-1], names[1:], strict=True)
    ]
    return below, members
