"""Piles: beams held by distributed springs, lumped at their nodes.

Every layer is cut into an even number of equal elements and its springs are lumped by Simpson's rule: nodal
springs, as in a hand calculation, whose strain energy converges with the fourth power of the element length.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import ceil, pi

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.soil.curves import NOTHING, Curve, secant_stiffness
from jackettwin.soil.profile import Clay, Point, Sand, SoilProfile, ground_at
from jackettwin.soil.shaft import (
    clay_bearing,
    clay_friction,
    clay_tz,
    sand_bearing,
    sand_friction,
    sand_tz,
    tip_qz,
)
from jackettwin.soil.springs import dry_stiff_clay_py, sand_py, soft_clay_py, stiff_clay_py
from jackettwin.soil.support import ELASTIC, Spring, Support
from jackettwin.soil.viscoelastic import Law, Prony, kelvin_voigt
from jackettwin.structure.model import STEEL, Material, Member, Reaction, Section, Structure, Vector

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]


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


@dataclass(frozen=True)
class CurveOptions:
    """Which of the codes' alternatives to use: the forms of ``soft_clay_py`` and ``sand_tz``."""

    cyclic: bool = False
    sand_tz: str = "rp2geo"
    clay_py: str = "table"
    cycles: float = 100.0
    """How many, for the one curve that asks: stiff clay without free water, if ``cyclic``."""


@dataclass(frozen=True)
class PileCurves:
    """Reaction curves of a pile: p-y and t-z at every station, q-z at the tip."""

    at: Stations
    py: tuple[Curve, ...]
    tz: tuple[Curve, ...]
    qz: Curve
    diameter_m: float


def pile_curves(pile: Pile, profile: SoilProfile, options: CurveOptions | None = None) -> PileCurves:
    """Return the reaction curves of API RP 2GEO along a pile.

    Raises
    ------
    InputError
        If an option is unknown, or scour leaves nothing of the pile in the ground.
    """
    options = CurveOptions() if options is None else options
    scour = profile.scour.total_m
    if scour >= pile.length_m:
        raise InputError(
            "scour reaches the pile tip", field="scour", value=scour, allowed=f"< {pile.length_m:g} m"
        )
    D = pile.section.outer_diameter_m
    at = stations(pile, np.append(profile.boundaries_m, scour))
    points = _points(pile, profile, at)
    return PileCurves(
        at=at,
        py=tuple(_lateral(point, D, options) for point in points),
        tz=tuple(_axial(point, D, options) for point in points),
        qz=_tip(points[-1], D, pile.tip_area_m2),
        diameter_m=D,
    )


def _points(pile: Pile, profile: SoilProfile, at: Stations) -> list[Point | None]:
    """Return the ground at every station; None where it is scoured away.

    The scour's bottom cuts a layer without ending it, so a cut's layer is that of its middle.
    """
    scour = profile.scour.total_m
    cuts = np.unique([0.0, *(z for z in (*profile.boundaries_m, scour) if z < pile.length_m), pile.length_m])
    middle = 0.5 * (cuts[:-1] + cuts[1:])
    layer = np.searchsorted(profile.boundaries_m, middle)
    D = pile.section.outer_diameter_m
    return [
        ground_at(profile, float(z), int(layer[cut]), diameter=D) if middle[cut] > scour else None
        for z, cut in zip(at.depth, at.layer, strict=True)
    ]


def _lateral(point: Point | None, D: float, options: CurveOptions) -> Curve:
    if point is None:
        return NOTHING
    z, stress, soil = point.depth_m, point.stress_pa, point.soil
    if isinstance(soil, Sand):
        return sand_py(
            friction_angle_deg=soil.friction_angle_deg,
            stress_pa=stress,
            z=z,
            D=D,
            cyclic=options.cyclic,
            modulus_n_m3=soil.modulus_n_m3,
        )
    su, e50 = point.strength_pa, soil.strain_50
    clay = {"strength_pa": su, "stress_pa": stress, "z": z, "D": D, "strain_50": e50}
    if not soil.stiff:
        return soft_clay_py(**clay, J=soil.J, cyclic=options.cyclic, form=options.clay_py)
    clay["mean_strength_pa"] = point.mean_strength_pa
    if soil.free_water:
        return stiff_clay_py(**clay, cyclic=options.cyclic)
    return dry_stiff_clay_py(**clay, J=soil.J, cycles=options.cycles if options.cyclic else 0.0)


def _axial(point: Point | None, D: float, options: CurveOptions) -> Curve:
    if point is None:
        return NOTHING
    soil = point.soil
    if isinstance(soil, Sand):
        f = sand_friction(stress_pa=point.stress_pa, beta=soil.beta, limit_pa=soil.limit_friction_pa)
        return sand_tz(friction_pa=f, D=D, form=options.sand_tz)
    f = clay_friction(strength_pa=point.strength_pa, stress_pa=point.stress_pa)
    return clay_tz(friction_pa=f, D=D, residual=soil.residual)


def _tip(point: Point | None, D: float, area_m2: float) -> Curve:
    if point is None:
        return NOTHING
    soil = point.soil
    if isinstance(soil, Clay):
        bearing = clay_bearing(point.strength_pa)
    else:
        bearing = sand_bearing(
            stress_pa=point.stress_pa, bearing_factor=soil.bearing_factor, limit_pa=soil.limit_bearing_pa
        )
    return tip_qz(bearing_pa=bearing, D=D, area_m2=area_m2)


def linearised(
    curves: PileCurves, *, lateral_m: FloatArray | float = 0.0, axial_m: FloatArray | float = 0.0
) -> PileSprings:
    """Return secant springs at the nodes' displacements [m]; the initial stiffness where these are zero.

    Shaft friction also resists torsion: (D/2)² times the axial spring of the shaft.
    """
    at = curves.at
    y, z = (np.broadcast_to(np.abs(u), at.node_depth.shape)[at.node] for u in (lateral_m, axial_m))
    k_h = np.array([secant_stiffness(curve, u) for curve, u in zip(curves.py, y, strict=True)])
    k_v = np.array([secant_stiffness(curve, u) for curve, u in zip(curves.tz, z, strict=True)])
    shaft = at.at_nodes(k_v)
    axial = shaft.copy()
    axial[-1] += float(secant_stiffness(curves.qz, z[-1]))
    return PileSprings(at.node_depth, at.at_nodes(k_h), axial, 0.25 * curves.diameter_m**2 * shaft)


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
