"""Whether a rotor fits the asset and the wind it stands in, and which one it is if nobody chose it."""

from __future__ import annotations

import numpy as np

from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.rotor import Rotor, elements, rotation
from jackettwin.simulate.scenario.scenario import Scenario, Turbine

_REMEDY = "give your windIO file as rotor: {data: FILE}, or rotor: {data: none} for the tower alone"


def check_clearance(turbine: Turbine, top_m: float) -> None:
    """Refuse a rotor whose blades reach still water from a tower top at ``top_m`` above it.

    Raises
    ------
    InputError
        If a tip touches the water: of a parked rotor where it stands, of any other anywhere on its way.
    """
    parked = turbine.state == "parked"
    lowest = top_m + lowest_tip(turbine.rotor, turbine.pitch, azimuth=turbine.azimuth if parked else None)
    if lowest <= 0.0:
        raise InputError(
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


def rotor_notes(scenario: Scenario) -> list[str]:
    """Return what to know of a rotor: nobody chose it, or it would not run in this wind."""
    air, turbine = scenario.air, scenario.turbine
    if air is None or turbine is None:
        return []
    limits, speed = turbine.control.wind_speeds_m_s, air.wind.speed_m_s
    if turbine.state == "operating" and limits is not None and not limits[0] <= speed <= limits[1]:
        return [
            f"{turbine.name} operates in {speed:g} m/s, beyond its cut-in and cut-out of {limits[0]:g} and "
            f"{limits[1]:g} m/s: take rotor.state: idling, or another wind"
        ]
    if not turbine.assumed:
        return []
    return [
        f"no rotor is given: the wind blows on {turbine.name}, {turbine.state}, radius "
        f"{turbine.rotor.radius:.1f} m, hub {air.wind.hub_height_m:.1f} m above still water; {_REMEDY}"
    ]
