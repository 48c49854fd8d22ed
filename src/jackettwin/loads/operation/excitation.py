"""Excitation of the tower by an operating rotor: multiples of blade passing, and turbulence at the blades."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads.aerodynamics.rotor import (
    AIR_KG_M3,
    CompiledRotor,
    Rotor,
    compiled_rotor,
    elements,
    rotation,
)
from jackettwin.loads.aerodynamics.rotor_wind import rotor_wind
from jackettwin.loads.aerodynamics.wind import Wind
from jackettwin.loads.operation.bem import OperatingPoint

PLACES = 96
"""Azimuths in a blade's share of a turn: 1.25° apart, a metre and a half at the tip of 120 m."""
_PASSING = 0.1
"""Half width of the band about the blades' passing, as a share of its frequency."""
_ORDERS = 2
"""Multiples of the blades' passing that are told."""
_DURATION_S, _STEP_S = 600.0, 0.1
"""Of the turbulence whose loads are told."""


class TowerOutline(NamedTuple):
    """Height over the tower top (n,), rising and at most 0, and diameter (n,) [m]."""

    z: FloatArray
    diameter: FloatArray


class Turbulent(NamedTuple):
    """Standard deviations (6,) of the tower top's loads: whole, and about the blades' passing [N, N·m]."""

    whole: FloatArray
    passing: FloatArray


def passing_loads(
    rotor: Rotor,
    operation: OperatingPoint,
    wind: Wind,
    *,
    tower: TowerOutline | None = None,
) -> FloatArray:
    """Return amplitudes (2, 6) of the loads at the tower top at once and twice the blades' passing.

    Of sheared, steady wind that the tower holds up: potential flow about its section at each height. The wake
    is frozen; blades alike, so that nothing is left at the rotor's own frequency.
    """
    compiled = _at_work(rotor, operation)
    turn = 2.0 * np.pi / rotor.n_blades
    angles = turn * np.arange(PLACES) / PLACES
    arms = elements(rotor, operation.pitch).arm.reshape(-1, 3)
    places = np.stack([rotor.hub + arms @ rotation(rotor.shaft, float(angle)).T for angle in angles])
    loads = compiled.loads(_steady_wind(places, wind, rotor, tower), np.zeros((PLACES, 6)), angles)
    return np.asarray(2.0 * np.abs(np.fft.rfft(loads, axis=0))[1 : _ORDERS + 1] / PLACES)


def turbulent_loads(
    rotor: Rotor,
    operation: OperatingPoint,
    wind: Wind,
    *,
    seed: int,
) -> Turbulent:
    """Return what turbulence makes of the loads at a tower top at rest; speed, pitch and wake are held."""
    field = rotor_wind(wind, rotor, duration=_DURATION_S, step=_STEP_S, seed=seed, azimuth=None)
    angle = operation.rotor_speed * _STEP_S * np.arange(field.n_times, dtype=np.float64)
    seen, shares = field.seen(rotor, angle)
    compiled = _at_work(rotor, operation).seeing(shares)
    loads = compiled.loads(seen, np.zeros((field.n_times, 6)), angle)
    lines = np.abs(np.fft.rfft(loads - loads.mean(axis=0), axis=0)) / field.n_times
    f = np.fft.rfftfreq(field.n_times, _STEP_S)
    passing = rotor.n_blades * operation.rotor_speed / (2.0 * np.pi)
    near = np.abs(f - passing) <= _PASSING * passing
    return Turbulent(*(np.sqrt(2.0 * (lines[band] ** 2).sum(axis=0)) for band in (f > 0.0, near)))


def _at_work(rotor: Rotor, operation: OperatingPoint) -> CompiledRotor:
    return compiled_rotor(
        rotor,
        pitch=operation.pitch,
        rotor_speed=operation.rotor_speed,
        induced=operation.induced,
        density=AIR_KG_M3,
    )


def _steady_wind(places: FloatArray, wind: Wind, rotor: Rotor, tower: TowerOutline | None) -> FloatArray:
    """Return the wind (..., 3) at places (..., 3) from the tower top."""
    top = wind.hub_height_m - rotor.hub_height
    found = np.zeros_like(places)
    found[..., 0] = wind.mean(top + places[..., 2])
    if tower is None:
        return found
    x, y, z = np.moveaxis(places, -1, 0)
    radius = np.interp(z, tower.z, 0.5 * tower.diameter, left=0.5 * tower.diameter[0], right=0.0)
    square = np.maximum(x**2 + y**2, radius**2)
    # flow about a cylinder: u = V (1 − a²(x² − y²)/r⁴), v = −2V a²xy/r⁴
    share = found[..., 0] * radius**2 / square**2
    found[..., 0] -= share * (x**2 - y**2)
    found[..., 1] -= 2.0 * share * x * y
    return found
