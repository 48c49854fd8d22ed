"""Reaction curves along a pile: which curve stands at which depth, and its linear spring."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.ground.curves import NOTHING, Curve, secant_stiffness
from jackettwin.soil.ground.layering import equivalent_points
from jackettwin.soil.ground.profile import Clay, Point, Sand, SoilProfile, ground_at
from jackettwin.soil.ground.py_curves import dry_stiff_clay_py, sand_py, soft_clay_py, stiff_clay_py
from jackettwin.soil.ground.tz_curves import (
    clay_bearing,
    clay_friction,
    clay_tz,
    sand_bearing,
    sand_friction,
    sand_tz,
    tip_qz,
)
from jackettwin.soil.piles.piles import Pile, PileSprings, Stations, stations

LAYERING = ("overburden", "georgiadis")


@dataclass(frozen=True)
class CurveOptions:
    """Which of the codes' alternatives to use: the forms of ``soft_clay_py`` and ``sand_tz``."""

    cyclic: bool = False
    sand_tz: str = "rp2geo"
    clay_py: str = "table"
    cycles: float = 100.0
    """How many, for the one curve that asks: stiff clay without free water, if ``cyclic``."""
    layering: str = "overburden"
    """How p-y curves know of the layers above: by their weight σ'_v alone at the true depth, or by
    Georgiadis's equivalent depth."""


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
    if options.layering not in LAYERING:
        raise InputError(
            "unknown way of layering",
            field="curves.layering",
            value=options.layering,
            allowed=", ".join(LAYERING),
        )
    scour = profile.scour.total_m
    if scour >= pile.length_m:
        raise InputError(
            "scour reaches the pile tip",
            field="scour",
            value=scour,
            allowed=f"< {pile.length_m:g} m",
            remedy="lengthen the pile, or check the unit of the scour",
        )
    D = pile.section.outer_diameter_m
    at = stations(pile, np.append(profile.boundaries_m, scour))
    layer = _layers(pile, profile, at)
    points = _points(profile, at, layer, D)
    sideways = points
    if options.layering == "georgiadis":

        def resistance(point: Point) -> float:
            return _lateral(point, D, options).capacity

        sideways = equivalent_points(profile, at.depth, layer, resistance)
    return PileCurves(
        at=at,
        py=tuple(_lateral(point, D, options) for point in sideways),
        tz=tuple(_axial(point, D, options) for point in points),
        qz=_tip(points[-1], D, pile.tip_area_m2),
        diameter_m=D,
    )


def _layers(pile: Pile, profile: SoilProfile, at: Stations) -> list[int | None]:
    """Return the layer of every station; None where it is scoured away.

    The scour's bottom cuts a layer without ending it, so a cut's layer is that of its middle.
    """
    scour = profile.scour.total_m
    cuts = np.unique([0.0, *(z for z in (*profile.boundaries_m, scour) if z < pile.length_m), pile.length_m])
    middle = 0.5 * (cuts[:-1] + cuts[1:])
    layer = np.searchsorted(profile.boundaries_m, middle)
    return [int(layer[cut]) if middle[cut] > scour else None for cut in at.layer]


def _points(
    profile: SoilProfile, at: Stations, layer: list[int | None], diameter: float
) -> list[Point | None]:
    """Return the ground at every station."""
    return [
        None if one is None else ground_at(profile, float(z), one, diameter=diameter)
        for z, one in zip(at.depth, layer, strict=True)
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
