"""Level of the response at the tower top, compared with OpenFAST's in wind of the same class.

Whether a simulation is as loud as OpenFAST is a measured ratio with its interval, where both were run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import exp, sqrt
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.intervals import NORMAL_90
from jackettwin.loads import OPERATING_LOG_STD, operating_point
from jackettwin.simulate.motion.model import asset_model
from jackettwin.simulate.motion.motion import Motion
from jackettwin.simulate.operating_modes import modes_with_rotor
from jackettwin.simulate.scenario.air import GRID_M
from jackettwin.simulate.scenario.scenario import Instrument, Scenario
from jackettwin.simulate.sensing import readings
from jackettwin.structure import without_rotor

FIRST, BETWEEN, SECOND = "first pair", "between first and second pair", "second pair"
FLANK = "lower flank of the second pair"
BANDS = {FIRST: (0.8, 1.2), BETWEEN: (1.7, 3.4), SECOND: (3.4, 5.6), FLANK: (4.24, 4.42)}
"""Bands over the first bending frequency."""
DIRECTIONS = {"fore_aft": (1.0, 0.0, 0.0), "side_side": (0.0, 1.0, 0.0)}


COMPARED, RECORDS, SPEEDS_M_S = "jacket15", 7, (8.0, 16.0)
"""Structure, number and mean winds of the OpenFAST records with which levels were compared."""
_STUDENT_90 = 1.943
"""The 95 % quantile of Student's t with one degree of freedom less than there are records."""


class Ratio(NamedTuple):
    """Simulated over OpenFAST's root mean square: the mean over records, and its standard deviation."""

    mean: float
    std: float

    @property
    def interval_90(self) -> tuple[float, float]:
        """Central 90 % interval of the mean ratio, in its logarithm by Student's t."""
        factor = exp(_STUDENT_90 * self.std / self.mean)
        return self.mean / factor, self.mean * factor


BESIDE_OPENFAST = {
    (FIRST, "fore_aft"): Ratio(1.04, 0.10),
    (FIRST, "side_side"): Ratio(1.00, 0.05),
    (BETWEEN, "fore_aft"): Ratio(1.00, 0.02),
    (BETWEEN, "side_side"): Ratio(0.97, 0.02),
    (SECOND, "fore_aft"): Ratio(1.12, 0.02),
    (SECOND, "side_side"): Ratio(0.92, 0.02),
    (FLANK, "fore_aft"): Ratio(1.00, 0.04),
    (FLANK, "side_side"): Ratio(1.25, 0.06),
}
"""From docs/verification/response_level.md."""


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
    ratio_to_openfast : float or None
        Simulated over OpenFAST's in such a state, as measured; None where the two were not compared.
    ratio_interval_90 : (low, high) or None
        Central 90 % interval of that ratio.
    """

    band: str
    direction: str
    limits_hz: tuple[float, float]
    rms_m_s2: float
    ratio_to_openfast: float | None
    ratio_interval_90: tuple[float, float] | None


def levels(motion: Motion, scenario: Scenario) -> tuple[Level, ...]:
    """Return the levels of a record; none without two bending pairs to stand between."""
    first = [m for m in motion.modes if m.label in ("fore_aft_1", "side_side_1")]
    if len(first) < 2 or scenario.air is None or scenario.air.wind.sigma == 0.0:
        return ()
    f1 = sqrt(first[0].frequency_hz * first[1].frequency_hz)
    node = scenario.asset.structure.top_node
    sensors = tuple(Instrument(name, axis, node=node) for name, axis in DIRECTIONS.items())
    clock = replace(scenario.clock, step_s=scenario.clock.load_step_s)
    moved = readings(motion, replace(scenario, instruments=sensors, clock=clock))
    beyond = beyond_comparison(scenario)
    found = []
    for row, direction in zip(moved, DIRECTIONS, strict=True):
        for band, (low, high) in BANDS.items():
            limits = (low * f1, high * f1)
            ratio = None if beyond else BESIDE_OPENFAST[band, direction]
            rms = band_rms(row, clock.step_s, limits)
            mean, interval = (ratio.mean, ratio.interval_90) if ratio else (None, None)
            found.append(Level(band, direction, limits, rms, mean, interval))
    return tuple(found)


class OperatingLevel(NamedTuple):
    """Level of an operating rotor's scenario in the first pair: its blades are rigid, its wake is frozen.

    Attributes
    ----------
    damping_ratio : of the scenario's model
    expected_damping_ratio : with bending blades and a wake and lift that lag, as ``operation`` has them
    ratio, ratio_interval_90 : root mean square here over the expected, √(expected ζ/ζ), and its interval by
        the standard deviation of the expected ln ζ
    """

    damping_ratio: float
    expected_damping_ratio: float
    ratio: float
    ratio_interval_90: tuple[float, float]


def operating_levels(scenario: Scenario, damping: Mapping[str, float]) -> dict[str, OperatingLevel]:
    """Return by direction how loud the first pair of an operating rotor's scenario is; nothing of another.

    Parameters
    ----------
    damping : {label: ratio} of the scenario's modes
    """
    air, turbine = scenario.air, scenario.turbine
    if air is None or turbine is None or turbine.state != "operating":
        return {}
    still = asset_model(replace(scenario.asset, structure=without_rotor(scenario.asset.structure)))
    operation = operating_point(turbine.rotor, turbine.control, air.wind.speed_m_s)
    expected = {m.label: m for m in modes_with_rotor(still, turbine.rotor, operation, shaft="free")[1]}
    found = {}
    for side in DIRECTIONS:
        here, other = damping.get(f"{side}_1"), expected.get(f"{side}_1")
        if here is None or other is None or min(here, other.damping_ratio) <= 0.0:
            continue
        ratio, wide = sqrt(other.damping_ratio / here), exp(0.5 * NORMAL_90 * OPERATING_LOG_STD[side])
        found[side] = OperatingLevel(here, other.damping_ratio, ratio, (ratio / wide, ratio * wide))
    return found


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
    if scenario.asset.structure.name != COMPARED:
        found.append("the structure is not the 15 MW jacket")
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
