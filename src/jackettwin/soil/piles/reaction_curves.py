"""Reaction curves along a pile: the curve at each depth, and its linear spring."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require
from jackettwin.soil.ground.curves import NOTHING, Curve, secant_stiffness
from jackettwin.soil.ground.layering import equivalent_points
from jackettwin.soil.ground.pisa import StockyGround
from jackettwin.soil.ground.profile import Point, SoilProfile, ground_at
from jackettwin.soil.piles.group import ClayBlock
from jackettwin.soil.piles.piles import Pile, PileSprings, Stations, stations
from jackettwin.soil.piles.soil_curves import CurveOptions


class SideMoment(NamedTuple):
    """Moment per length against rotation [N]; ``by_force``: for each N/m of lateral force there."""

    curve: Curve
    by_force: bool


@dataclass(frozen=True)
class PileCurves:
    """Reaction curves of a pile: p-y and t-z at every station, q-z at the tip.

    ``sides`` are the moments along the shaft of a stocky pile, one a station or none, ``base_shear`` and
    ``base_moment`` those under its tip. ``block`` is the pile's share of the clay that its group encloses.
    """

    at: Stations
    py: tuple[Curve, ...]
    tz: tuple[Curve, ...]
    qz: Curve
    diameter_m: float
    sides: tuple[SideMoment, ...] = ()
    base_shear: Curve = NOTHING
    base_moment: Curve = NOTHING
    block: ClayBlock | None = None


def pile_curves(pile: Pile, profile: SoilProfile, options: CurveOptions | None = None) -> PileCurves:
    """Return the reaction curves along a pile, by default those of API RP 2GEO.

    Raises
    ------
    InputError
        If scour leaves nothing of the pile in the ground, or piles of its group overlap.
    """
    options = CurveOptions() if options is None else options
    scour = profile.scour.total_m
    require(
        scour < pile.length_m,
        "scour reaches the pile tip",
        field="scour",
        value=scour,
        allowed=f"< {pile.length_m:g} m",
        remedy="lengthen the pile, or check the unit of the scour",
    )
    D = pile.outer_diameter_m
    at = stations(pile, np.append(profile.boundaries_m, scour))
    layer = _layers(pile, profile, at)

    def curve(of: Literal["py", "tz", "qz"], point: Point | None) -> Curve:
        return NOTHING if point is None else options.curve(of, point, pile)

    points = [
        None if one is None else ground_at(profile, float(z), one, diameter=D)
        for z, one in zip(at.depth, layer, strict=True)
    ]
    sideways = points
    if options.layering == "georgiadis":
        sideways = equivalent_points(profile, at.depth, layer, lambda point: curve("py", point).capacity)
    found = PileCurves(
        at=at,
        py=tuple(curve("py", point) for point in sideways),
        tz=tuple(curve("tz", point) for point in points),
        qz=curve("qz", points[-1]),
        diameter_m=D,
        block=options.group.block(pile, profile, at, layer) if options.group else None,
    )
    if not any(point is not None and options.is_stocky(point.soil) for point in points):
        return found
    return _with_sides_and_base(found, points, options, pile.length_m - scour)


def _with_sides_and_base(
    curves: PileCurves, points: list[Point | None], options: CurveOptions, length: float
) -> PileCurves:
    """Return the curves of a stocky pile with what turns it along its shaft and under its tip."""
    D = curves.diameter_m
    grounds = [
        StockyGround(p, D, length) if p is not None and options.is_stocky(p.soil) else None for p in points
    ]
    sides = tuple(
        SideMoment(NOTHING, by_force=False)
        if one is None
        else SideMoment(one.moment, by_force=one.moment_grows_with_force)
        for one in grounds
    )
    tip = grounds[-1]
    if tip is None:
        return replace(curves, sides=sides)
    return replace(curves, sides=sides, base_shear=tip.base_shear, base_moment=tip.base_moment)


def _layers(pile: Pile, profile: SoilProfile, at: Stations) -> list[int | None]:
    """Return the layer of every station; None where it is scoured away.

    The scour's bottom cuts a layer without ending it, so a cut's layer is that of its middle.
    """
    scour = profile.scour.total_m
    cuts = np.unique([0.0, *(z for z in (*profile.boundaries_m, scour) if z < pile.length_m), pile.length_m])
    middle = 0.5 * (cuts[:-1] + cuts[1:])
    layer = np.searchsorted(profile.boundaries_m, middle)
    return [int(layer[cut]) if middle[cut] > scour else None for cut in at.layer]


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
    lateral = at.at_nodes(k_h)
    lateral[-1] += float(secant_stiffness(curves.base_shear, y[-1]))
    torsional = 0.25 * curves.diameter_m**2 * shaft
    if not curves.sides:
        return PileSprings(at.node_depth, lateral, axial, torsional)
    # sand's moments grow with the force: none at rest
    turning = np.array([0.0 if by_force else curve.initial_stiffness for curve, by_force in curves.sides])
    rocking = at.at_nodes(turning)
    rocking[-1] += curves.base_moment.initial_stiffness
    return PileSprings(at.node_depth, lateral, axial, torsional, rocking)
