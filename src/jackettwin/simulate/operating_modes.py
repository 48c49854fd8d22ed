"""Modes, damping, thrust and excitation of an asset with an operating rotor, by wind speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import degrees, exp, pi
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.caveats import Omission
from jackettwin.intervals import NORMAL_90
from jackettwin.loads import (
    OPERATING_LEAST_RATIO,
    OPERATING_LOG_STD,
    Control,
    Linearised,
    OperatingPoint,
    Rotor,
    TowerOutline,
    Turbulent,
    Wind,
    operating_damping,
    operating_point,
    passing_loads,
    turbulent_loads,
)
from jackettwin.simulate.motion.model import Model, TrueMode, asset_model, true_modes, with_aerodynamics
from jackettwin.simulate.scenario.asset import Asset
from jackettwin.structure import Structure, without_rotor

_FIRST = {"fore_aft": "fore_aft_1", "side_side": "side_side_1"}
_BELOW_HZ = 1.5
_ROUNDS = 3
"""After which a first mode's pole and the blades' answer at it agree within 1e-3 of its damping."""
_LOADS = ("x_n", "y_n", "z_n", "x_nm", "y_nm", "z_nm")
LEFT_OUT = tuple(
    Omission(what)
    for what in (
        "the controller's own pitch and torque: they are held, and a real one changes fore-aft damping",
        "blades that twist, dynamic stall: within the interval; bending blades beyond the first two modes",
        "rotor speed that follows gusts; unequal blades, which shake at the rotor's own frequency",
        "yaw error, wakes of neighbours",
    )
)


@dataclass(frozen=True)
class OperatingAsset:
    """One wind speed.

    Attributes
    ----------
    modes : of the asset with the rotor, up to 1.5 Hz
    passing : (2, 6) amplitudes of the loads at once and twice the blades' passing, of steady wind
    turbulent : standard deviations of the loads of ten minutes of turbulence, or None
    """

    operation: OperatingPoint
    mean: Linearised
    modes: tuple[TrueMode, ...]
    passing: FloatArray
    turbulent: Turbulent | None


def operating_asset(
    asset: Asset,
    rotor: Rotor,
    control: Control,
    wind: Wind,
    *,
    shaft: str = "free",
    seed: int | None = 0,
    model: Model | None = None,
) -> OperatingAsset:
    """Return an asset in a wind in which its rotor works.

    ``model`` is the asset in still air with a rigid rotor, if it is known.
    """
    still = model or asset_model(replace(asset, structure=without_rotor(asset.structure)))
    operation = operating_point(rotor, control, wind.speed_m_s)
    mean, modes = modes_with_rotor(still, rotor, operation, shaft=shaft)
    passing = passing_loads(rotor, operation, wind, tower=tower_outline(asset.structure))
    turbulent = None if seed is None else turbulent_loads(rotor, operation, wind, seed=seed)
    return OperatingAsset(operation, mean, modes, passing, turbulent)


def modes_with_rotor(
    still: Model, rotor: Rotor, operation: OperatingPoint, *, shaft: str, bending: bool = True
) -> tuple[Linearised, tuple[TrueMode, ...]]:
    """Return a rotor about a steady motion at the first frequency, and the modes up to 1.5 Hz with it.

    Bending blades answer each of the first two modes at its own pole; all others see rigid blades.
    """

    def seen(pole: complex, *, bending: bool) -> tuple[Linearised, tuple[TrueMode, ...]]:
        mean = operating_damping(rotor, operation, pole=pole, shaft=shaft, bending=bending)
        return mean, true_modes(with_aerodynamics(still, mean), below_hz=_BELOW_HZ)

    first = min(mode.frequency_hz for mode in true_modes(still, below_hz=_BELOW_HZ))
    steady = 2j * pi * first
    modes = {mode.label: mode for mode in seen(steady, bending=False)[1]}
    for label in _FIRST.values():
        for _ in range(_ROUNDS if label in modes else 0):
            near = {mode.label: mode for mode in seen(modes[label].pole, bending=bending)[1]}
            modes[label] = near.get(label, modes[label])
    mean = operating_damping(rotor, operation, pole=steady, shaft=shaft, bending=bending)
    return mean, tuple(modes.values())


def tower_outline(structure: Structure) -> TowerOutline | None:
    """Return the tower below its top; None if nothing is called tower."""
    top = structure.nodes[structure.top_node][2]
    ends = {}
    for member in structure.members:
        if member.part == "tower":
            for node, section in ((member.start, member.section_start), (member.end, member.section_end)):
                ends[structure.nodes[node][2] - top] = section.outer_diameter_m
    if not ends:
        return None
    z = np.array(sorted(ends))
    return TowerOutline(z, np.array([ends[height] for height in z]))


def operating_row(found: OperatingAsset, *, blades: int) -> dict[str, Any]:
    """Return one wind speed as JSON has it, in SI units but for what its names say."""
    operation = found.operation
    turn_hz = operation.rotor_speed / (2.0 * pi)
    return {
        "wind_speed_m_s": operation.wind_speed,
        "rotor_speed_rpm": 60.0 * turn_hz,
        "pitch_deg": degrees(operation.pitch),
        "thrust_n": float(found.mean.load[0]),
        "aerodynamic_power_w": operation.power,
        "passing_hz": blades * turn_hz,
        **{side: _side_row(found.modes, side) for side in _FIRST},
        "modes": [
            {"label": m.label, "frequency_hz": m.frequency_hz, "damping_ratio": m.damping_ratio}
            for m in found.modes
        ],
        "passing": [dict(zip(_LOADS, map(float, row), strict=True)) for row in found.passing],
        "turbulent": None
        if found.turbulent is None
        else {
            name: dict(zip(_LOADS, map(float, getattr(found.turbulent, name)), strict=True))
            for name in Turbulent._fields
        },
        "damping_matrix": found.mean.damping.tolist(),
    }


def _side_row(modes: tuple[TrueMode, ...], side: str) -> dict[str, Any] | None:
    """Return a first bending mode and the rotor's part of its damping with its interval."""
    mode = next((m for m in modes if m.label == _FIRST[side]), None)
    if mode is None:
        return None
    part = mode.damping_by_source["rotor"]
    width = exp(NORMAL_90 * OPERATING_LOG_STD[side])
    return {
        "frequency_hz": mode.frequency_hz,
        "damping_ratio": mode.damping_ratio,
        "rotor_damping_ratio": part,
        "rotor_damping_ratio_interval_90": [
            min(part / width, part - OPERATING_LEAST_RATIO),
            max(part * width, part + OPERATING_LEAST_RATIO),
        ],
    }
