"""The sea of a scenario: still water, waves, current, and their known errors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log, pi, radians, sqrt
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from jackettwin.errors import located, require
from jackettwin.files import Angle, Schema, Seed
from jackettwin.loads import (
    Coefficients,
    Current,
    Elevation,
    EndCoefficients,
    Kinematics,
    Water,
    WaterSchema,
    depth_of,
    highest_wave,
    peak_factor,
    read_elevation,
    read_kinematics,
    water_members,
    wave_number,
)
from jackettwin.structure import PILES, Structure

REGULAR = ("airy", "stokes5", "stream")
"""Types of waves that are one wave."""
GIVEN = ("elevation", "kinematics")
"""Types of waves that a file gives."""
_HIGHEST_WAVE = sqrt(0.5 * log(1000.0))
"""Of a random sea over Hs: the most probable highest of a thousand Rayleigh waves, 1.86."""
WIDEST = 0.2
"""Diameter over wave length up to which a member does not disturb the wave: DNV-RP-C205, ISO 19901-1."""
Period = Annotated[float, Field(ge=0.5, le=100.0)]
"""Of a wave: shorter ones are ripples, longer ones tides [s]."""
SignificantHeight = Annotated[float, Field(gt=0.0, le=30.0)]
"""Of a random sea [m]."""
Speed = Annotated[float, Field(ge=0.0, le=10.0)]
"""Of water [m/s]."""


class WavesSchema(Schema):
    """``waves``: height and period of a regular wave, Hs and Tp of a random sea, or a file."""

    type: Literal["airy", "stokes5", "stream", "jonswap", "pierson-moskowitz", "elevation", "kinematics"]
    file: str | None = None
    celerity_m_s: Annotated[float, Field(gt=0.0, le=200.0)] | None = None
    height_m: Annotated[float, Field(gt=0.0, le=100.0)] | None = None
    period_s: Period | None = None
    hs_m: SignificantHeight | None = None
    tp_s: Period | None = None
    gamma: Annotated[float, Field(ge=1.0, le=10.0)] | None = None
    spreading: Annotated[float, Field(gt=0.0, le=1000.0)] | None = None
    direction_deg: Angle = 0.0
    seed: Seed = 0
    stretching: Literal["none", "vertical", "extrapolated", "wheeler"] | None = None
    relative_velocity: Literal["none", "linearised", "full"] = "linearised"
    diffraction: Literal["none", "maccamy-fuchs"] = "none"


class CurrentSchema(Schema):
    """``current``."""

    subsurface_m_s: Speed = 0.0
    wind_driven_m_s: Speed = 0.0
    uniform_m_s: Speed = 0.0
    direction_deg: Angle = 0.0

    def build(self, depth_m: float) -> Current:
        """Return the current in water of a depth."""
        direction = radians(self.direction_deg)
        return Current(depth_m, self.subsurface_m_s, self.wind_driven_m_s, direction, self.uniform_m_s)


@dataclass(frozen=True)
class Sea:
    """Still water about the asset, its waves and current.

    ``height_m`` and ``period_s`` are H and T of a regular wave, Hs and Tp of a random sea.
    """

    depth_m: float
    coefficients: Coefficients
    water: Water | None = None
    """Water that moves with the structure, if its mass does not include it already."""
    waves: str | None = None
    height_m: float = 0.0
    period_s: float = 0.0
    direction: float = 0.0
    seed: int = 0
    stretching: str = "none"
    gamma: float | None = None
    spreading: float | None = None
    relative_velocity: str = "linearised"
    """Dependence of drag on the structure's motion: ``none``, ``linearised`` or ``full``."""
    diffraction: bool = False
    current: Current | None = None
    ends: EndCoefficients = EndCoefficients()
    elevation: Elevation | None = None
    """Of waves that are given, from the start of what is discarded."""
    kinematics: Kinematics | None = None
    """Of waves whose whole motion is given; ``elevation`` is its own."""
    celerity_m_s: float | None = None
    """At which given kinematics travel; None is that of their peak period."""

    @property
    def regular(self) -> bool:
        """Whether the waves repeat after their own period."""
        return self.waves in REGULAR

    @property
    def highest_wave_m(self) -> float:
        """H of a regular wave, 1.86 Hs of a random sea, twice the highest crest of a given one [m]."""
        if self.elevation is not None:
            return 2.0 * float(self.elevation.eta_m.max())
        return self.height_m if self.regular else _HIGHEST_WAVE * self.height_m

    @property
    def crest_m(self) -> float:
        """Height over still water that no crest passes [m]: members below it are loaded."""
        return 1.2 * max(self.height_m, 0.5 * self.highest_wave_m)


def build_sea(
    still: WaterSchema | None,
    w: WavesSchema | None,
    c: CurrentSchema | None,
    structure: Structure,
    folder: Path,
) -> Sea | None:
    """Return the sea that ``water``, ``waves`` and ``current`` describe; files are sought in ``folder``.

    Raises
    ------
    InputError
        If keys do not fit the type of waves, or a file is missing or wrong.
    """
    if still is None and w is None and c is None:
        return None
    given = still or WaterSchema()
    members = water_members(given, structure, folder)
    depth = depth_of(given, structure)
    calm = Sea(
        depth_m=depth,
        coefficients=members.coefficients,
        water=members.water if members.adds_mass else None,
        current=None if c is None else c.build(depth),
        ends=members.ends,
    )
    if w is None:
        return calm
    with located(field="waves"):
        filed = _filed(w, folder)
        eta = filed.elevation if isinstance(filed, Kinematics) else filed
        height, period = _size(w) if eta is None else (eta.significant_height_m, eta.peak_period_s)
        return replace(
            calm,
            waves=w.type,
            height_m=height,
            period_s=period,
            direction=radians(w.direction_deg),
            seed=w.seed,
            stretching=w.stretching or ("none" if w.type == "airy" else "wheeler"),
            gamma=None if eta is not None or w.type in REGULAR else _peakedness(w),
            spreading=w.spreading,
            relative_velocity=w.relative_velocity,
            diffraction=_scatters(w),
            elevation=eta,
            kinematics=filed if isinstance(filed, Kinematics) else None,
            celerity_m_s=w.celerity_m_s,
        )


def _filed(w: WavesSchema, folder: Path) -> Elevation | Kinematics | None:
    """Return what is given of waves by a file; refuse what does not belong to these."""
    require(
        (w.type in GIVEN) == (w.file is not None),
        "a file belongs to waves of type elevation or kinematics, and they need one",
        field="file",
        value=w.file,
        remedy="give type: elevation or kinematics and file, or height and period",
    )
    other = "celerity_m_s" if w.type != "kinematics" else "stretching"
    if w.file is None:
        _refuse(w, (other,), remedy="leave it out")
        return None
    in_file = ("height_m", "period_s", "hs_m", "tp_s", "gamma", "spreading")
    _refuse(w, (other, *in_file), remedy="leave it out: the file says it")
    return read_elevation(folder / w.file) if w.type == "elevation" else read_kinematics(folder / w.file)


def _size(w: WavesSchema) -> tuple[float, float]:
    """Return H and T, or Hs and Tp; refuse those of the other kind."""
    regular, random = ("height_m", "period_s"), ("hs_m", "tp_s")
    needed = regular if w.type in REGULAR else random
    others = (*random, "gamma", "spreading") if w.type in REGULAR else regular
    remedy = f"give {' and '.join(needed)}, or another type"
    _refuse(w, others, allowed=", ".join(needed), remedy=remedy)
    for name in needed:
        given = getattr(w, name) is not None
        require(given, "required key is missing", field=name, remedy=f"add {name!r}")
    return getattr(w, needed[0]), getattr(w, needed[1])


def _refuse(w: WavesSchema, names: tuple[str, ...], *, remedy: str, allowed: str | None = None) -> None:
    """Refuse keys that do not belong to this type of waves."""
    for name in names:
        value = getattr(w, name)
        problem = f"does not belong to waves of type {w.type}"
        require(value is None, problem, field=name, value=value, allowed=allowed, remedy=remedy)


def _scatters(w: WavesSchema) -> bool:
    """Return whether members scatter waves; steep ones have no theory of it here."""
    scatters = w.diffraction == "maccamy-fuchs"
    require(
        not scatters or w.type not in ("stokes5", "stream", "kinematics"),
        f"not known for waves of type {w.type}",
        field="diffraction",
        value=w.diffraction,
        allowed="none",
        remedy="take airy, jonswap or pierson-moskowitz, or leave it out",
    )
    return scatters


def _peakedness(w: WavesSchema) -> float | None:
    if w.type == "pierson-moskowitz":
        return 1.0
    if w.gamma is None and w.hs_m is not None and w.tp_s is not None:
        return peak_factor(w.hs_m, w.tp_s)
    return w.gamma


def sea_warnings(sea: Sea, structure: Structure) -> list[str]:
    """Return warnings; a random sea is judged by the wave of its peak period."""
    if sea.waves is None:
        return []
    length = 2.0 * pi / float(wave_number(2.0 * pi / sea.period_s, sea.depth_m))
    found = []
    name, diameter = _widest(structure, sea.coefficients, sea.depth_m)
    if diameter > WIDEST * length and not sea.diffraction:
        found.append(
            f"member {name} is {diameter:.1f} m wide, over {WIDEST:g} of the wave length {length:.0f} m: "
            "it scatters waves, and Morison's equation overstates their force (waves.diffraction)"
        )
    highest = highest_wave(length, sea.depth_m)
    if sea.waves == "airy" and sea.height_m > highest:
        found.append(
            f"waves of {sea.period_s:g} s break at {highest:.1f} m in {sea.depth_m:g} m of water; "
            f"linear theory says nothing of {sea.height_m:g} m"
        )
    elif not sea.regular and sea.highest_wave_m > highest:
        found.append(
            f"the highest waves, {sea.highest_wave_m:.1f} m, break: those of {sea.period_s:.3g} s reach "
            f"{highest:.1f} m in {sea.depth_m:g} m of water"
        )
    return found


def _widest(structure: Structure, coefficients: Coefficients, depth_m: float) -> tuple[str, float]:
    """Return name and hydrodynamic diameter [m] of the widest member in the water, at its ends."""
    widest = ("", 0.0)
    for member in structure.members:
        if member.part == PILES:
            continue
        ends = np.array([structure.nodes[node][2] for node in (member.start, member.end)])
        z = ends - structure.sea_level_z_m
        if z.min() >= 0.0 or z.max() <= -depth_m:
            continue
        tube = [s.outer_diameter_m for s in (member.section_start, member.section_end)]
        diameter = float((tube + 2.0 * coefficients.thickness(z)).max())
        widest = max(widest, (member.name, diameter), key=lambda one: one[1])
    return widest
