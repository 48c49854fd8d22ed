"""Loads on the model of a scenario: prescribed forces, and forces that depend on its motion."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import RotorWind
from jackettwin.simulate.motion.model import Aerodynamics, Model, aerodynamics, build_model, with_aerodynamics
from jackettwin.simulate.motion.water import (
    RelativeDrag,
    WaterLoads,
    relative_drag,
    relative_drag_beyond,
    water_ends,
    water_loads,
    water_points,
)
from jackettwin.simulate.motion.wind import (
    RotorLoads,
    rotor_loads_in,
    tower_damping,
    tower_loads,
    tower_points,
    wind_field,
)
from jackettwin.simulate.scenario.air import Air, Turbine
from jackettwin.simulate.scenario.scenario import Scenario, SimulationClock
from jackettwin.simulate.scenario.sea import Sea


@dataclass(frozen=True)
class Loads:
    """Loads on the model: prescribed forces, and the rotor's forces that depend on its motion."""

    model: Model
    repeating: FloatArray
    """(n_steps + 1, n) forces that repeat after the simulated time."""
    before: FloatArray
    """The same before the record, with the nacelle at its first heading."""
    wave: WaterLoads | None
    """Regular waves, which repeat after their own period."""
    rotor: RotorLoads | None
    damping: FloatArray
    """(6, 6) damping of the rotor at the tower top that the model contains already."""
    signals: dict[str, FloatArray]
    relative: RelativeDrag | None = None
    """Drag on the members' own motion beyond the damping that the model contains."""


@dataclass(frozen=True)
class _Part:
    """Effect of water or air on the model.

    Attributes
    ----------
    model : Model
        With the mean damping and stiffness of it.
    repeating, before : (n_steps + 1, n), as in ``Loads``
    """

    model: Model
    repeating: FloatArray
    before: FloatArray
    signals: dict[str, FloatArray] = field(default_factory=dict)
    wave: WaterLoads | None = None
    relative: RelativeDrag | None = None
    rotor: RotorLoads | None = None
    rotor_damping: FloatArray = field(default_factory=lambda: np.zeros((6, 6)))


def loads_on(scenario: Scenario, n_steps: int) -> Loads:
    """Return model and loads, with n_steps + 1 rows of which the last repeats the first."""
    model, clock = build_model(scenario), scenario.clock
    nothing = np.zeros((n_steps + 1, model.reduced.n))
    water = air = _Part(model, nothing, nothing)
    if scenario.sea is not None:
        water = _of_water(scenario.sea, model, clock, nothing)
    if scenario.air is not None:
        air = _of_air(scenario.air, scenario.turbine, water.model, clock)
    return Loads(
        water.model if scenario.air is None else air.model,
        water.repeating + air.repeating,
        water.before + air.before,
        water.wave,
        air.rotor,
        air.rotor_damping,
        water.signals | air.signals,
        water.relative,
    )


def _of_water(sea: Sea, model: Model, clock: SimulationClock, nothing: FloatArray) -> _Part:
    basis, t = model.reduced.basis, _times(nothing, clock)
    grid, ends = water_points(model.assembly, sea), water_ends(model.assembly, sea)
    water = water_loads(
        sea,
        grid,
        np.asarray(grid.N.T @ basis),
        duration=clock.total_s,
        ends=None if ends is None else (ends, np.asarray(ends.N.T @ basis)),
        keep_motion=sea.relative_velocity == "full",
    )
    if water is None:
        return _Part(model, nothing, nothing)
    beyond = None
    if sea.relative_velocity != "none":
        drag = relative_drag(grid, water, basis)
        model = model.with_forces_of_motion("water", damping=drag, stiffness=np.zeros_like(drag))
        if sea.relative_velocity == "full":
            beyond = relative_drag_beyond(grid, water, basis, drag)
    signals = {} if sea.waves is None else {"wave_elevation": water.elevation(t)}
    if abs(water.series.period_s - clock.total_s) < 1e-9:
        repeating = water.at(t)
        return _Part(model, repeating, repeating, signals, relative=beyond)
    return _Part(model, nothing, nothing, signals, wave=water, relative=beyond)


def _of_air(air: Air, turbine: Turbine | None, model: Model, clock: SimulationClock) -> _Part:
    step = clock.load_step_s
    aero = None if turbine is None else aerodynamics(air, turbine)
    wind = wind_field(air, aero, duration=clock.total_s, step=step)
    nothing = np.zeros((wind.n_times + 1, model.reduced.n))
    part = _Part(model, nothing, nothing) if aero is None else _of_rotor(wind, air, aero, model, clock)
    part = replace(part, signals={"wind_hub_x": _closed(wind.at_hub()[:, 0])})
    tower = tower_points(model.assembly, air)
    if tower is None:
        return part
    basis = model.reduced.basis
    pushed = _closed(tower_loads(wind, tower, np.asarray(tower.N.T @ basis)))
    drag = tower_damping(air, tower, basis)
    return replace(
        part,
        model=part.model.with_forces_of_motion("rotor", damping=drag, stiffness=np.zeros_like(drag)),
        repeating=part.repeating + pushed,
        before=part.before + pushed,
    )


def _of_rotor(wind: RotorWind, air: Air, aero: Aerodynamics, model: Model, clock: SimulationClock) -> _Part:
    t = np.arange(wind.n_times, dtype=np.float64) * wind.step_s
    heading = air.heading(t - clock.discard_s) if air.yaw_path else None
    rotor = rotor_loads_in(wind, air, aero, heading=heading)
    resting = rotor if heading is None else rotor_loads_in(wind, air, aero, heading=float(heading[0]))
    known = rotor.mean_damping()
    model = with_aerodynamics(model, aero.mean._replace(damping=known))
    repeating, before = (_closed(loads.still) @ model.top for loads in (rotor, resting))
    return _Part(model, repeating, before, rotor=rotor, rotor_damping=known)


def _times(rows: FloatArray, clock: SimulationClock) -> FloatArray:
    return np.arange(rows.shape[0], dtype=np.float64) * clock.load_step_s


def _closed(series: FloatArray) -> FloatArray:
    return np.concatenate([series, series[:1]])
