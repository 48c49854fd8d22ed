"""Wave and wind loads alone: force, and moment about the still water's origin."""

from __future__ import annotations

from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.caveats import OUT_OF_SCOPE, Omission, omission_documents
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import InputError
from jackettwin.loads import Water, morison_points, radiation_damping, resultant_columns, water_weights
from jackettwin.response import build_system, mode_kinds, mode_labels, undamped_modes
from jackettwin.simulate.breaking_waves import breaking_document
from jackettwin.simulate.motion.model import aerodynamics, asset_assembly
from jackettwin.simulate.motion.water import water_ends, water_loads, water_points, wave_field
from jackettwin.simulate.motion.wind import rotor_loads_in, tower_loads, tower_points, wind_field
from jackettwin.simulate.scenario.air import Air, rotor_notes
from jackettwin.simulate.scenario.asset import Asset
from jackettwin.simulate.scenario.scenario import Scenario, in_words_of
from jackettwin.simulate.scenario.sea import Sea, sea_warnings
from jackettwin.structure import Assembly, assemble

_FINE_M = 0.5
"""Longest piece of a member: the loads themselves are the result."""
PHASES = 16
"""Phases of a regular wave that are tabulated."""
_RADIATING = 5
"""Modes whose radiation damping is tabulated."""


def resultants(scenario: Scenario) -> dict[str, FloatArray]:
    """Return force and moment about the origin at still water level, (n_times, 6) [N, N·m].

    Keys are ``water`` (waves and current, without buoyancy) and ``wind`` (rotor and tower), each on an asset
    that stands still, each with its own times: a regular wave over one period.

    Raises
    ------
    InputError
        If there is neither wave, current nor wind.
    """
    with in_words_of(scenario):
        return _resultants(scenario)


def _resultants(scenario: Scenario) -> dict[str, FloatArray]:
    assembly = assemble(scenario.asset.structure, subdivide=scenario.asset.subdivide)
    parts: dict[str, FloatArray] = {}
    total_s = scenario.clock.total_s
    if scenario.sea is not None:
        grid = water_points(assembly, scenario.sea, spacing=_FINE_M)
        ends = water_ends(assembly, scenario.sea)
        water = water_loads(
            scenario.sea,
            grid,
            resultant_columns(grid.points),
            duration=total_s,
            ends=None if ends is None else (ends, resultant_columns(ends.points)),
        )
        if water is not None:
            parts["water"] = water.series.loads
    if scenario.air is not None:
        parts["wind"] = _of_wind(scenario, scenario.air, assembly)
    if not parts:
        raise InputError(
            "nothing loads the asset", file=scenario.path, field="waves", remedy="add waves, current or wind"
        )
    return parts


def _of_wind(scenario: Scenario, air: Air, assembly: Assembly) -> FloatArray:
    """Return what the wind does to rotor and tower, (n_times, 6)."""
    aero = None if scenario.turbine is None else aerodynamics(air, scenario.turbine)
    field = wind_field(air, aero, duration=scenario.clock.total_s, step=scenario.clock.load_step_s)
    total = np.zeros((field.n_times, 6))
    if aero is not None:
        t = np.arange(field.n_times, dtype=np.float64) * field.step_s - scenario.clock.discard_s
        still = rotor_loads_in(field, air, aero, heading=air.heading(t) if air.yaw_path else None).still
        top = np.array(assembly.structure.nodes[assembly.structure.top_node])
        arm = top - [0.0, 0.0, assembly.structure.sea_level_z_m]
        total += np.hstack([still[:, :3], still[:, 3:] + np.cross(arm, still[:, :3])])
    tower = tower_points(assembly, air)
    return total if tower is None else total + tower_loads(field, tower, resultant_columns(tower.points))


_LEFT_OUT = (
    *OUT_OF_SCOPE,
    Omission("motion of the asset: it stands still"),
)
_OF_WAVES = (
    Omission("slam of horizontal members is in `breaking`, not in the loads", "DNV-RP-C205 8"),
    Omission("impact of breaking waves is in `breaking`, not in the loads", "IEC 61400-3-1"),
    Omission("run-up, spray and marine growth that is not given"),
)


def loads_document(scenario: Scenario) -> dict[str, Any]:
    """Return the document of ``jackettwin loads``: extremes and spread of the total and of its parts."""
    parts = resultants(scenario)
    total = parts[next(iter(parts))]
    if len(parts) == 2:
        total = _together(scenario, parts)
    sea_level = scenario.asset.structure.sea_level_z_m
    return {
        **_statistics(total),
        **_at_the_mudline(scenario, total),
        "still_water": _still_water(scenario),
        "parts": {name: _statistics(loads) for name, loads in parts.items()},
        "reference_point_m": [0.0, 0.0, sea_level],
        "phases": _phases(scenario, parts),
        "radiation": None if scenario.sea is None else _radiation(scenario.asset, scenario.sea),
        "breaking": None
        if scenario.sea is None
        else breaking_document(scenario.sea, scenario.asset.structure),
        "left_out": omission_documents(
            (*(_OF_WAVES if scenario.sea is not None and scenario.sea.waves is not None else ()), *_LEFT_OUT)
        ),
        "warnings": [
            *([] if scenario.sea is None else sea_warnings(scenario.sea, scenario.asset.structure)),
            *rotor_notes(scenario.air, scenario.turbine),
        ],
    }


def _at_the_mudline(scenario: Scenario, total: FloatArray) -> dict[str, Any]:
    """Return base shear and overturning moment: largest horizontal force, and moment about the bed."""
    if scenario.sea is None:
        return {"mudline": None}
    moved = about_mudline(total, scenario.sea.depth_m)
    axes = dict(zip("xyz", moved[:, 3:].T, strict=True))
    return {
        "mudline": {
            "z_msl_m": -scenario.sea.depth_m,
            "base_shear_n": float(np.hypot(moved[:, 0], moved[:, 1]).max()),
            "overturning_moment_n_m": float(np.hypot(moved[:, 3], moved[:, 4]).max()),
            "moment_n_m": {axis: _spread(column) for axis, column in axes.items()},
        }
    }


def _still_water(scenario: Scenario) -> dict[str, Any] | None:
    """Return buoyancy, what is filled and grown, and the pressure at the bed; None without a sea."""
    sea = scenario.sea
    if sea is None:
        return None
    assembly = assemble(scenario.asset.structure, subdivide=scenario.asset.subdivide)
    grid = morison_points(
        assembly, highest_z=0.0, lowest_z=-sea.depth_m, coefficients=sea.coefficients, spacing=_FINE_M
    )
    weights = water_weights(assembly, grid, sea.water or Water())
    lifted = float(weights.displaced.sum())
    return {
        "buoyancy_n": lifted,
        "center_of_buoyancy_m": (weights.displaced @ grid.points / lifted).tolist() if lifted else None,
        "water_inside_n": None if sea.water is None else float(weights.inside.sum()),
        "growth_weight_n": float(weights.growth.sum()),
        "pressure_at_the_bed_pa": sea.coefficients.density_kg_m3 * GRAVITY_M_S2 * sea.depth_m,
    }


def _radiation(asset: Asset, sea: Sea) -> list[dict[str, Any]]:
    """Return the damping ratio of the lowest modes from the waves that they radiate."""
    assembly = asset_assembly(asset, sea=sea)
    grid = morison_points(assembly, highest_z=0.0, coefficients=sea.coefficients)
    modes = undamped_modes(build_system(assembly, asset.support), _RADIATING)
    labels = mode_labels(mode_kinds(assembly, modes.shapes, modes.frequency_hz))
    return [
        {
            "label": label,
            "frequency_hz": float(omega / (2.0 * np.pi)),
            "damping_ratio": radiation_damping(grid, shape, float(omega), sea.depth_m) / (2.0 * float(omega)),
        }
        for label, omega, shape in zip(labels, modes.omega, modes.shapes.T, strict=True)
    ]


def about_mudline(loads: FloatArray, depth_m: float) -> FloatArray:
    """Return force and moment (n, 6) about the bed under the origin from those about still water.

    M_bed = M + (0, 0, d) × F
    """
    moved = loads.copy()
    moved[:, 3] -= depth_m * loads[:, 1]
    moved[:, 4] += depth_m * loads[:, 0]
    return moved


def _phases(scenario: Scenario, parts: dict[str, FloatArray]) -> list[dict[str, Any]] | None:
    """Return a regular wave's loads over one period; None without one."""
    sea = scenario.sea
    if sea is None or not sea.regular:
        return None
    water = parts["water"]
    steps = np.arange(0, water.shape[0], water.shape[0] // PHASES)
    moved = about_mudline(water, sea.depth_m)
    waves = wave_field(sea, duration=scenario.clock.total_s)
    assert waves is not None
    eta = waves.elevation(np.zeros((1, 3)), steps * (sea.period_s / water.shape[0]))[:, 0]
    return [
        {
            "phase_deg": 360.0 * float(k) / water.shape[0],
            "wave_elevation_m": float(level),
            "force_n": water[k, :3].tolist(),
            "moment_msl_n_m": water[k, 3:].tolist(),
            "moment_mudline_n_m": moved[k, 3:].tolist(),
        }
        for k, level in zip(steps, eta, strict=True)
    ]


def _together(scenario: Scenario, parts: dict[str, FloatArray]) -> FloatArray:
    """Return the sum at the wind's times; waves that repeat sooner are carried on."""
    wind, water = parts["wind"], parts["water"]
    clock, sea = scenario.clock, scenario.sea
    assert sea is not None
    period = sea.period_s if sea.regular else clock.total_s
    t = np.arange(wind.shape[0]) * clock.load_step_s
    at = np.arange(water.shape[0]) * (period / water.shape[0])
    carried = np.stack([np.interp(t, at, column, period=period) for column in water.T], axis=1)
    return np.asarray(wind + carried)


def _statistics(loads: FloatArray) -> dict[str, Any]:
    force = {axis: _spread(loads[:, i]) for i, axis in enumerate("xyz")}
    moment = {axis: _spread(loads[:, 3 + i]) for i, axis in enumerate("xyz")}
    return {"force_n": force, "moment_msl_n_m": moment}


def _spread(column: FloatArray) -> dict[str, float]:
    return {name: float(getattr(column, name)()) for name in ("max", "min", "std", "mean")}
