"""Kinds of soil reaction curves, and their registry.

A kind is a function that returns the curve of one depth, and its row. The row is entered in ``SOIL_CURVES``
here, or by an installed package as an entry point. A foundation file chooses a kind by its name.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cache
from typing import Literal, NamedTuple, cast

from jackettwin.errors import look_up, require, require_between
from jackettwin.files import Placed
from jackettwin.plugins import plugins_of_type
from jackettwin.soil.ground.curves import Curve, ScaledCurve
from jackettwin.soil.ground.pisa import StockyGround
from jackettwin.soil.ground.profile import Clay, Point, Sand
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
from jackettwin.soil.piles.group import AxialCycles, PileGroup
from jackettwin.soil.piles.piles import Pile

REACTIONS = ("sand_py", "clay_py", "sand_tz", "clay_tz", "sand_qz", "clay_qz")
"""Lateral, along the shaft, under the tip, in either soil: fields of :class:`CurveOptions`."""
LAYERING = ("overburden", "georgiadis")
PISA = "pisa"
"""Name of the lateral curves that come with moments along the shaft, and shear and moment at the base."""


@dataclass(frozen=True)
class CurveOptions:
    """Which kind of curve stands for each reaction, by its name in ``soil_curves``, and how it is loaded."""

    cyclic: bool = False
    sand_tz: str = "rp2geo"
    clay_py: str = "table"
    cycles: float = 100.0
    """How many, for the one curve that asks: stiff clay without free water, if ``cyclic``."""
    layering: Literal["overburden", "georgiadis"] = "overburden"
    """Effect of the layers above on p-y curves: by their weight σ'_v alone at the true depth, or by
    Georgiadis's equivalent depth."""
    sand_py: str = "rp2geo"
    clay_tz: str = "rp2geo"
    sand_qz: str = "rp2geo"
    clay_qz: str = "rp2geo"
    p_multiplier: float = 1.0
    """On every p-y curve, beside that of ``group``."""
    t_multiplier: float = 1.0
    """On every t-z curve: shaft friction that cycles along the axis have left, or set-up has added."""
    group: Placed[PileGroup] | None = None
    """Where the other piles of this one's group stand."""
    axial_cycles: Placed[AxialCycles] | None = None
    """Cycles along the axis, on t-z curves of sand."""

    def __post_init__(self) -> None:
        require_between("cycles", self.cycles, 1.0, 1e9)
        for name in ("p_multiplier", "t_multiplier"):
            require_between(name, getattr(self, name), 0.01, 5.0)
        require(
            self.layering in LAYERING,
            "unknown way of layering",
            field="layering",
            value=self.layering,
            allowed=", ".join(LAYERING),
        )
        own = {(kind.reaction, kind.name) for kind in SOIL_CURVES}
        for reaction in REACTIONS:
            name = getattr(self, reaction)
            if (reaction, name) not in own:  # options stand in defaults: importing them loads no plugin
                look_up(soil_curves(reaction), name, "soil curve", field=reaction)
        require(
            not (self.cyclic and self.clay_py == "cube-root"),
            "Matlock's parabola is for static loads",
            field="clay_py",
            value=self.clay_py,
            allowed="table, if cyclic",
        )
        for key in ("sand_py", "clay_py"):
            require(
                not (self.cyclic and getattr(self, key) == PISA),
                "PISA's curves are for static loads",
                field=key,
                value=PISA,
                allowed="rp2geo or table, if cyclic",
            )

    def is_stocky(self, soil: Sand | Clay) -> bool:
        """Return whether lateral curves in a soil come with moments and with base terms."""
        return self._kind(soil) == PISA

    def _kind(self, soil: Sand | Clay) -> str:
        return str(getattr(self, _reaction(soil, "py")))

    def kinds(self, soils: Collection[Sand | Clay]) -> tuple[SoilCurve, ...]:
        """Return the kind of curve that stands for each reaction of some soils."""
        there = {_reaction(soil, of) for soil in soils for of in ("py", "tz", "qz")}
        return tuple(soil_curves(r)[getattr(self, r)] for r in REACTIONS if r in there)

    def curve(self, of: Literal["py", "tz", "qz"], point: Point, pile: Pile) -> Curve:
        """Return the lateral, shaft or tip reaction of the ground at one depth of a pile."""
        reaction = _reaction(point.soil, of)
        found = soil_curves(reaction)[getattr(self, reaction)].build(point, pile, self)
        factor = self._factor(of, point.soil, pile.outer_diameter_m)
        return found if factor == 1.0 else ScaledCurve(found, factor)

    def _factor(self, of: Literal["py", "tz", "qz"], soil: Sand | Clay, diameter_m: float) -> float:
        if of == "py":
            return self.p_multiplier * (self.group.p_multiplier(diameter_m) if self.group else 1.0)
        cycled = self.axial_cycles if of == "tz" and isinstance(soil, Sand) else None
        left = 1.0 if cycled is None else cycled.friction_left
        return left * (self.t_multiplier if of == "tz" else 1.0)


def _reaction(soil: Sand | Clay, of: str) -> str:
    return f"{'sand' if isinstance(soil, Sand) else 'clay'}_{of}"


class SoilCurve(NamedTuple):
    """A kind of curve: its reaction (one of ``REACTIONS``), its name, what it is in words, and its function.

    The function gets the ground at a depth, the pile and all options; its curve is in N per m of pile, under
    the tip in N.
    """

    reaction: str
    name: str
    words: str
    build: Callable[[Point, Pile, CurveOptions], Curve]


def _sand_py(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    soil = cast("Sand", point.soil)
    return sand_py(
        friction_angle_deg=soil.friction_angle_deg,
        stress_pa=point.stress_pa,
        z=point.depth_m,
        D=pile.outer_diameter_m,
        cyclic=options.cyclic,
        modulus_n_m3=soil.modulus_n_m3,
    )


def _clay_py(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    soil = cast("Clay", point.soil)
    clay = {
        "strength_pa": point.strength_pa,
        "stress_pa": point.stress_pa,
        "z": point.depth_m,
        "D": pile.outer_diameter_m,
        "strain_50": soil.strain_50,
    }
    if not soil.stiff:
        return soft_clay_py(**clay, J=soil.J, cyclic=options.cyclic, form=options.clay_py)
    clay["mean_strength_pa"] = point.mean_strength_pa
    if soil.free_water:
        return stiff_clay_py(**clay, cyclic=options.cyclic)
    return dry_stiff_clay_py(**clay, J=soil.J, cycles=options.cycles if options.cyclic else 0.0)


def _sand_tz(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    soil = cast("Sand", point.soil)
    f = sand_friction(stress_pa=point.stress_pa, beta=soil.beta, limit_pa=soil.limit_friction_pa)
    form = "rp2a" if options.sand_tz == "rp2a" else "rp2geo"
    return sand_tz(friction_pa=f, D=pile.outer_diameter_m, form=form)


def _clay_tz(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    soil = cast("Clay", point.soil)
    f = clay_friction(strength_pa=point.strength_pa, stress_pa=point.stress_pa)
    return clay_tz(friction_pa=f, D=pile.outer_diameter_m, residual=soil.residual)


def _sand_qz(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    soil = cast("Sand", point.soil)
    q = sand_bearing(
        stress_pa=point.stress_pa, bearing_factor=soil.bearing_factor, limit_pa=soil.limit_bearing_pa
    )
    return tip_qz(bearing_pa=q, D=pile.outer_diameter_m, area_m2=pile.tip_area_m2)


def _clay_qz(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    q = clay_bearing(point.strength_pa)
    return tip_qz(bearing_pa=q, D=pile.outer_diameter_m, area_m2=pile.tip_area_m2)


def _pisa(point: Point, pile: Pile, options: CurveOptions) -> Curve:
    return StockyGround(point, pile.outer_diameter_m, pile.length_m).lateral


SOIL_CURVES = (
    SoilCurve("sand_py", "rp2geo", "API RP 2GEO, O'Neill & Murchison (1983)", _sand_py),
    SoilCurve("clay_py", "table", "Matlock (1970), points of the code; stiff clay by its layer", _clay_py),
    SoilCurve("clay_py", "cube-root", "Matlock's parabola, static only; stiff clay by its layer", _clay_py),
    SoilCurve(
        "sand_py", PISA, "PISA, dense Dunkirk sand (Burd et al. 2020), with base and side terms", _pisa
    ),
    SoilCurve("clay_py", PISA, "PISA, Cowden till (Byrne et al. 2020), with base and side terms", _pisa),
    SoilCurve("sand_tz", "rp2geo", "API RP 2GEO: peak at 1 % of the diameter", _sand_tz),
    SoilCurve("sand_tz", "rp2a", "API RP 2A-WSD: straight to the peak at 2.54 mm", _sand_tz),
    SoilCurve("clay_tz", "rp2geo", "API RP 2GEO: peak at 1 % of the diameter, then a residual", _clay_tz),
    SoilCurve("sand_qz", "rp2geo", "API RP 2GEO: full bearing at a tenth of the diameter", _sand_qz),
    SoilCurve("clay_qz", "rp2geo", "API RP 2GEO: full bearing at a tenth of the diameter", _clay_qz),
    *(
        SoilCurve(reaction, "iso19901-4", "ISO 19901-4 (2016), the same curve as API RP 2GEO's", build)
        for reaction, build in (
            ("sand_tz", _sand_tz),
            ("clay_tz", _clay_tz),
            ("sand_qz", _sand_qz),
            ("clay_qz", _clay_qz),
        )
    ),
)
PLUGINS = "jackettwin.soil_curves"
"""Group of entry points, each a :class:`SoilCurve`."""


@cache
def soil_curves(reaction: str) -> dict[str, SoilCurve]:
    """Return the kinds of curves of a reaction by name: ours, then those that installed packages bring."""
    every = (*SOIL_CURVES, *plugins_of_type(PLUGINS, SoilCurve).values())
    return {kind.name: kind for kind in every if kind.reaction == reaction}
