"""The wind of a scenario and the turbine in it."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, require
from jackettwin.files import Angle, ForceCoefficient, Schema, Seed
from jackettwin.loads import (
    PIECE_M,
    TOWER_DRAG,
    Coherent,
    Control,
    Rotor,
    Wind,
    elements,
    read_rotor,
    rotation,
)

GRID_M = 19.1
"""Between the nodes of the wind field that the OpenFAST records were made in [m]."""
_OWN_MASS_KG = 948e3
"""Rotor and nacelle of the IEA 15 MW turbine."""
_SIMILAR = 0.25
"""Relative difference of that mass up to which its rotor is assumed as it is."""
_BY_MASS = 0.65
"""Exponent of the radius over that mass, from the NREL 5 MW turbine (350 t, 63.0 m) to the IEA 15 MW one
(120.4 m); the DTU 10 MW turbine (674 t, 89.2 m) is met within 8 %."""
_HEADINGS = 9
"""Number of headings over which the rotor's mean stiffness is averaged."""
_REMEDY = "give your windIO file as rotor: {data: FILE}, or rotor: {data: none} for the tower alone"
WindSpeed = Annotated[float, Field(gt=0.0, le=100.0)]
"""Mean at the hub [m/s]."""


class WindSchema(Schema):
    """``wind``: along +x; ``yaw_deg`` turns the nacelle anticlockwise from there."""

    speed_m_s: WindSpeed
    turbulence: Literal["A+", "A", "B", "C", "none"] | Annotated[float, Field(ge=0.0, le=1.0)] = "B"
    shear: Annotated[float, Field(ge=0.0, le=1.0)] = 0.14
    seed: Seed = 0
    yaw_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 0.0
    yaw_path: list[tuple[float, Angle]] | None = Field(default=None, min_length=2)
    tower_drag: ForceCoefficient = TOWER_DRAG
    coherence: Literal["all", "u"] | None = None
    piece_m: Annotated[float, Field(ge=1.0, le=200.0)] | None = None
    grid_m: Annotated[float, Field(ge=5.0, le=200.0)] | None = None


class RotorSchema(Schema):
    """``rotor``: a shipped windIO turbine, a file, or ``none``."""

    data: str = "iea15"
    state: Literal["parked", "idling", "operating"] = "parked"
    pitch_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 90.0
    azimuth_deg: Angle = 0.0


@dataclass(frozen=True)
class Air:
    """Wind along +x; ``yaw`` is the nacelle's heading, anticlockwise from +x seen from above [rad]."""

    wind: Wind
    seed: int = 0
    yaw: float = 0.0
    """The mean heading of a path: at which the nacelle's mass stands."""
    yaw_path: tuple[tuple[float, float], ...] = ()
    """Time in the record [s], first to last, and heading [rad] of rotor and sensors; straight in between."""
    tower_drag: float = TOWER_DRAG
    coherent: Coherent = "all"
    """Which components of turbulence are coherent across rotor and tower."""
    piece_m: float = PIECE_M
    """Longest piece of a standing blade or of the tower with a wind of its own."""
    grid_m: float | None = None
    """Width of a grid whose nodes standing blades take their wind from instead."""

    def heading(self, t: FloatArray) -> FloatArray:
        """Return the nacelle's heading [rad] at times ``t`` [s] in the record."""
        if not self.yaw_path:
            return np.full(t.shape, self.yaw)
        at, yaw = np.transpose(self.yaw_path)
        return np.asarray(np.interp(t, at, yaw), dtype=np.float64)

    def headings(self) -> FloatArray:
        """Return headings [rad] that stand for the record, each for as much of it."""
        if not self.yaw_path:
            return np.array([self.yaw])
        first, last = self.yaw_path[0][0], self.yaw_path[-1][0]
        return self.heading(first + (last - first) * (np.arange(_HEADINGS) + 0.5) / _HEADINGS)


@dataclass(frozen=True)
class Turbine:
    """The rotor and what it does: parked (shaft locked), idling (shaft free) or operating."""

    rotor: Rotor
    control: Control
    state: str = "parked"
    pitch: float = 0.5 * pi
    azimuth: float = 0.0
    name: str = ""
    assumed: float | None = None
    """Factor on the lengths of a rotor that nobody chose; None if somebody did."""


def build_turbine(
    rotor: RotorSchema | None, wind: WindSchema | None, folder: Path, *, nacelle_kg: float
) -> Turbine | None:
    """Return the turbine that ``rotor`` describes, or the usual one in a wind; None without either.

    Parameters
    ----------
    nacelle_kg : float
        Mass of rotor and nacelle on the structure, to which a rotor that nobody chose is scaled.

    Raises
    ------
    InputError
        If keys do not fit each other, or the rotor's file is missing or wrong.
    """
    if rotor is None and wind is None:
        return None
    chosen = rotor or RotorSchema()
    if chosen.data == "none":
        _refuse_rotor_keys(chosen)
        return None
    require(
        chosen.state != "operating" or wind is not None,
        "an operating turbine needs wind",
        field="wind",
        remedy="add wind: {speed_m_s: …}",
    )
    blades, control = read_rotor(chosen.data, folder=folder)
    factor = None if "data" in chosen.model_fields_set else likely_factor(nacelle_kg)
    return Turbine(
        blades if factor is None else blades.scaled(factor),
        control if factor is None else control.scaled(factor),
        chosen.state,
        radians(chosen.pitch_deg),
        radians(chosen.azimuth_deg),
        name=chosen.data if factor in (None, 1.0) else f"{chosen.data} × {factor:.2f}",
        assumed=factor,
    )


def likely_factor(nacelle_kg: float) -> float:
    """Return the likely ratio of a rotor's radius to the IEA 15 MW rotor's, from its mass with nacelle.

    Heavier rotors and nacelles carry longer blades: R ∝ m^0.65. The ratio is 1 for masses within a quarter of
    that turbine's, and if there is none.
    """
    ratio = nacelle_kg / _OWN_MASS_KG
    return 1.0 if nacelle_kg <= 0.0 or abs(ratio - 1.0) <= _SIMILAR else float(ratio**_BY_MASS)


def _refuse_rotor_keys(chosen: RotorSchema) -> None:
    """Refuse what only a rotor has."""
    for key in sorted(chosen.model_fields_set - {"data"}):
        raise InputError(
            "there is no rotor",
            field=f"rotor.{key}",
            value=getattr(chosen, key),
            remedy="name its data, or take this out",
        )


def build_air(w: WindSchema, turbine: Turbine | None, *, top_m: float, duration_s: float) -> Air:
    """Return the wind on a tower whose top stands ``top_m`` above still water.

    Raises
    ------
    InputError
        If keys do not fit each other or the turbine, or its blades reach the water.
    """
    if turbine is not None:
        check_clearance(turbine, top_m)
    stands = turbine is not None and turbine.state != "operating"
    require(
        w.grid_m is None or stands,
        "a grid is for blades that stand",
        field="wind.grid_m",
        value=w.grid_m,
        remedy="leave it out, or park the rotor",
    )
    hub = 0.0 if turbine is None else turbine.rotor.hub_height
    turbulence = 0.0 if w.turbulence == "none" else w.turbulence
    with located(field="wind"):
        wind = Wind(w.speed_m_s, top_m + hub, turbulence, w.shear)
    path = _yaw_path(w, duration_s)
    return Air(
        wind=wind,
        seed=w.seed,
        yaw=_mean_heading(path) if path else radians(w.yaw_deg),
        yaw_path=path,
        tower_drag=w.tower_drag,
        **_places(w, stands=stands),
    )


def _places(w: WindSchema, *, stands: bool) -> dict[str, Any]:
    """Return where the wind is made: a rotor that stands is blown at as by a wind field file.

    There v and w are independent from node to node, as IEC 61400-1 leaves them; on pieces, and for a rotor
    that turns, they are as coherent as u.
    """
    grid = GRID_M if stands and w.grid_m is None and w.piece_m is None else w.grid_m
    coherence = w.coherence or ("all" if grid is None else "u")
    return {"coherent": coherence, "piece_m": w.piece_m or PIECE_M, "grid_m": grid}


def _yaw_path(w: WindSchema, duration_s: float) -> tuple[tuple[float, float], ...]:
    """Return times [s] from the record's start to its end and the headings [rad] there; empty if none."""
    if w.yaw_path is None:
        return ()
    twice = "the heading is given twice"
    require(w.yaw_deg == 0.0, twice, field="wind.yaw_deg", value=w.yaw_deg, remedy="keep yaw_path")
    at, yaw = np.array(w.yaw_path, dtype=np.float64).T
    growing = np.all(np.diff(at) > 0.0)
    require(growing, "times must grow", field="wind.yaw_path", value=at.tolist(), remedy="sort them")
    inside = at[(at > 0.0) & (at < duration_s)]
    times = np.concatenate([[0.0], inside, [duration_s]])
    headings = np.radians(np.interp(times, at, yaw))
    return tuple(zip(times.tolist(), headings.tolist(), strict=True))


def _mean_heading(path: tuple[tuple[float, float], ...]) -> float:
    at, yaw = np.transpose(path)
    return float(np.trapezoid(yaw, at) / (at[-1] - at[0]))


def check_clearance(turbine: Turbine, top_m: float) -> None:
    """Refuse a rotor whose blades reach still water from a tower top at ``top_m`` above it.

    Raises
    ------
    InputError
        If a tip touches the water: of a parked rotor where it stands, of any other anywhere on its way.
    """
    parked = turbine.state == "parked"
    tip = top_m + lowest_tip(turbine.rotor, turbine.pitch, azimuth=turbine.azimuth if parked else None)
    require(
        tip > 0.0,
        f"a blade tip touches the water: radius {turbine.rotor.radius:.1f} m, "
        f"hub {top_m + turbine.rotor.hub_height:.1f} m above still water",
        field="rotor.data",
        value=turbine.name,
        allowed="tips above still water",
        remedy=_REMEDY,
    )


def lowest_tip(rotor: Rotor, pitch: float, *, azimuth: float | None) -> float:
    """Return the height of the lowest tip over the tower top [m]; azimuth [rad], None for a whole turn."""
    arms, d = elements(rotor, pitch).arm[:, -1], rotor.shaft
    if azimuth is not None:
        heights = (arms @ rotation(d, azimuth).T)[:, 2]
    else:
        along = arms @ d
        heights = d[2] * along - np.hypot(d[0], d[1]) * np.linalg.norm(arms - np.outer(along, d), axis=1)
    return rotor.hub_height + float(heights.min())


def rotor_notes(air: Air | None, turbine: Turbine | None) -> list[str]:
    """Return what to know of a rotor: nobody chose it, or it would not run in this wind."""
    if air is None or turbine is None:
        return []
    notes: list[str] = []
    limits, speed = turbine.control.wind_speeds_m_s, air.wind.speed_m_s
    if turbine.state == "operating" and limits is not None and not limits[0] <= speed <= limits[1]:
        notes.append(
            f"{turbine.name} operates in {speed:g} m/s, beyond its cut-in and cut-out of {limits[0]:g} and "
            f"{limits[1]:g} m/s: take rotor.state: idling, or another wind"
        )
    if turbine.assumed is not None:
        scaled = "" if turbine.assumed == 1.0 else ", scaled by (mass of rotor and nacelle / 948 t)^0.65"
        notes.append(
            f"no rotor is given: the wind blows on {turbine.name}, {turbine.state}{scaled}, radius "
            f"{turbine.rotor.radius:.1f} m, hub {air.wind.hub_height_m:.1f} m above still water; {_REMEDY}"
        )
    return notes
