r"""Expected level of response of OpenFAST in wind of the same class, and its scatter.

The rms of ten minutes of a lightly damped mode scatters between seeds:
for a stationary Gaussian signal with spectrum G the mean square over a time T has the relative variance

.. math:: \frac{\operatorname{var}\,\overline{x^2}}{σ^4} = \frac{\int G^2 df}{T (\int G df)^2}

(Isserlis and Parseval): 1/(2πζfT) for a mode alone, 1/(BT) for a flat band B. Two programs that were
given other seeds scatter both.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, hypot, log, pi, sqrt
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90
from jackettwin.simulate.motion.motion import Motion
from jackettwin.simulate.scenario.air import GRID_M
from jackettwin.simulate.scenario.scenario import Instrument, Scenario
from jackettwin.simulate.sensing import readings

FIRST, BETWEEN = "first pair", "between first and second pair"
BANDS = {FIRST: (0.8, 1.2), BETWEEN: (1.7, 3.4)}
"""Bands over the first bending frequency."""
DIRECTIONS = {"fore_aft": (1.0, 0.0, 0.0), "side_side": (0.0, 1.0, 0.0)}


class Ratio(NamedTuple):
    """Simulated over OpenFAST's root mean square, and the standard deviation of its logarithm."""

    mean: float
    std: float


BESIDE_OPENFAST = {
    (FIRST, "fore_aft"): Ratio(1.04, 0.10),
    (FIRST, "side_side"): Ratio(1.00, 0.05),
    (BETWEEN, "fore_aft"): Ratio(1.00, 0.02),
    (BETWEEN, "side_side"): Ratio(0.97, 0.02),
}
"""From docs/verification/response_level.md, over seven OpenFAST records."""
SPEEDS_M_S = (8.0, 16.0)
"""Mean winds of those records."""


@dataclass(frozen=True)
class Level:
    """Root mean square of the acceleration at the tower top in a band [m/s²].

    Attributes
    ----------
    band : str
        Of ``BANDS``.
    direction : str
        Of ``DIRECTIONS``.
    limits_hz : (low, high)
    rms_m_s2 : float
        Of this record.
    openfast_m_s2 : (low, high)
        What a record of OpenFAST as long as this one shows in wind of the same class in nine of ten cases.
    """

    band: str
    direction: str
    limits_hz: tuple[float, float]
    rms_m_s2: float
    openfast_m_s2: tuple[float, float]


def levels(motion: Motion, scenario: Scenario) -> tuple[Level, ...]:
    """Return the levels of a record; none without two bending pairs to stand between."""
    first = [m for m in motion.modes if m.label in ("fore_aft_1", "side_side_1")]
    if len(first) < 2 or scenario.air is None or scenario.air.wind.sigma == 0.0:
        return ()
    f1 = sqrt(first[0].frequency_hz * first[1].frequency_hz)
    damping = {m.label.removesuffix("_1"): m.damping_ratio * m.frequency_hz for m in first}
    node = scenario.asset.structure.top_node
    sensors = tuple(Instrument(name, axis, node=node) for name, axis in DIRECTIONS.items())
    clock = replace(scenario.clock, step_s=scenario.clock.load_step_s)
    moved = readings(motion, replace(scenario, instruments=sensors, clock=clock))
    found = []
    for row, direction in zip(moved, DIRECTIONS, strict=True):
        for band, (low, high) in BANDS.items():
            limits = (low * f1, high * f1)
            bandwidth = 2.0 * pi * damping[direction] if band == FIRST else limits[1] - limits[0]
            rms = band_rms(row, clock.step_s, limits)
            there = expected(rms, band, direction, bandwidth * clock.duration_s)
            found.append(Level(band, direction, limits, rms, there))
    return tuple(found)


def expected(rms: float, band: str, direction: str, bandwidth_time: float) -> tuple[float, float]:
    """Return the 90 % interval of OpenFAST's level; both records scatter by ½/√(BT) in their logarithm."""
    ratio = BESIDE_OPENFAST[band, direction]
    spread = NORMAL_90 * hypot(ratio.std, sqrt(0.5 / bandwidth_time))
    middle = log(rms / ratio.mean) if rms > 0.0 else -np.inf
    return exp(middle - spread), exp(middle + spread)


def band_rms(x: FloatArray, step_s: float, limits_hz: tuple[float, float]) -> float:
    """Return the root mean square of a signal (n,) between two frequencies, from its periodogram."""
    f = np.fft.rfftfreq(x.size, step_s)
    inside = (f > limits_hz[0]) & (f < limits_hz[1])
    return float(np.sqrt(2.0 * (np.abs(np.fft.rfft(x - x.mean())[inside]) ** 2).sum())) / x.size


def beyond_comparison(scenario: Scenario) -> list[str]:
    """Return the respects in which the scenario is outside the compared records."""
    air, turbine = scenario.air, scenario.turbine
    if air is None:
        return []
    found = []
    if turbine is None or turbine.state != "parked":
        found.append("the rotor is not parked")
    if not SPEEDS_M_S[0] <= air.wind.speed_m_s <= SPEEDS_M_S[1]:
        found.append(f"the wind is not {SPEEDS_M_S[0]:g} to {SPEEDS_M_S[1]:g} m/s")
    if air.grid_m != GRID_M or air.coherent != "u":
        found.append(f"the wind has no grid of {GRID_M:g} m with u alone coherent")
    if air.yaw_path or air.yaw != 0.0:
        found.append("the nacelle stands askew")
    if scenario.sea is not None and scenario.sea.waves is not None:
        found.append("there are waves")
    return found
