"""The motion of an asset through a scenario."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from jackettwin.response.time import (
    Feedback,
    Hold,
    StateSpace,
    first_order_hold,
    march,
    march_with_feedback,
    periodic_start,
    state_space,
)
from jackettwin.simulate.ground import EVALUATIONS, CyclicFeet
from jackettwin.simulate.model import (
    Model,
    TrueMode,
    aerodynamics,
    build_model,
    true_modes,
    with_aerodynamics,
)
from jackettwin.simulate.scenario import Scenario
from jackettwin.simulate.water import (
    RelativeDrag,
    WaterLoads,
    relative_drag,
    relative_drag_beyond,
    water_ends,
    water_loads,
    water_points,
)
from jackettwin.simulate.wind import (
    RotorLoads,
    rotor_loads_in,
    tower_damping,
    tower_loads,
    tower_points,
    wind_field,
)

FloatArray = npt.NDArray[np.float64]

_TRUTH_BELOW_HZ = 1.0


@dataclass(frozen=True)
class Motion:
    """States of the linear model at every load step, and the forces between them.

    Attributes
    ----------
    model : Model
        With the mean damping of air and water.
    states : (n_steps + 1, n_states)
    force : (n_steps + 1, n) on the coordinates, all told
    step_s : load step
    modes : the linear model's
    signals : channels of the environment at the load steps, (n_steps + 1,) each
    """

    model: Model
    space: StateSpace
    states: FloatArray
    force: FloatArray
    step_s: float
    modes: tuple[TrueMode, ...]
    signals: dict[str, FloatArray] = field(default_factory=dict)


@dataclass(frozen=True)
class _Loads:
    """What drives the model: forces known beforehand, and the rotor's answer to motion."""

    model: Model
    repeating: FloatArray
    """(n_steps + 1, n) forces that repeat after the simulated time."""
    wave: WaterLoads | None
    """Regular waves, which repeat after their own period."""
    rotor: RotorLoads | None
    damping: FloatArray
    """(6, 6) of the rotor at the tower top that the model knows already."""
    signals: dict[str, FloatArray]
    relative: RelativeDrag | None = None
    """Drag on the members' own motion beyond what the model knows."""


def simulate_motion(scenario: Scenario) -> Motion:
    """Return the motion of a scenario's asset, from a start without transient.

    The model's own motion, the mean damping of rotor, tower and waves included, is stepped exactly; what the
    rotor adds beyond its mean damping is a feedback.

    Raises
    ------
    InputError
        If parts of the scenario do not fit each other.
    NumericalError
        If the motion grows without bound.
    """
    clock = scenario.clock
    n_steps = round(clock.total_s / clock.load_step_s)
    loads = _loads(scenario, n_steps)
    space = state_space(loads.model.reduced.pencil)
    hold = first_order_hold(space.A, space.B, clock.load_step_s)
    x0 = periodic_start(hold, loads.repeating)
    force = loads.repeating
    if loads.wave is not None:
        series = loads.wave.series
        own = first_order_hold(space.A, space.B, series.step_s)
        x0 = x0 + periodic_start(own, np.vstack([series.loads, series.loads[:1]]))
        t = np.arange(n_steps + 1, dtype=np.float64) * clock.load_step_s
        force = force + loads.wave.at(t)
    parts = _feedbacks(scenario, loads)
    if parts:
        states, force = _with_feedback(parts, space, hold, x0, force)
    else:
        states = march(hold, x0, force)
    return Motion(
        loads.model,
        space,
        states,
        force,
        clock.load_step_s,
        true_modes(loads.model, below_hz=_TRUTH_BELOW_HZ),
        loads.signals,
    )


class _Part(NamedTuple):
    """A force (m,) on the motion ``rows`` (m, n) of the coordinates, from step and state."""

    rows: FloatArray
    force: Feedback
    evaluations: int


def _feedbacks(scenario: Scenario, loads: _Loads) -> list[_Part]:
    """Return what depends on the motion beyond the linear model."""
    model, n = loads.model, loads.model.reduced.n
    parts = []
    if loads.rotor is not None:
        change, n_times = loads.rotor.change(loads.damping), loads.rotor.still.shape[0]
        parts.append(_Part(model.top, lambda k, x: change(k % n_times, model.top @ x[n : 2 * n]), 1))
    if loads.relative is not None:
        relative, h = loads.relative, scenario.clock.load_step_s
        parts.append(_Part(np.eye(n), lambda k, x: relative.change(k * h, x[n : 2 * n]), 1))
    if scenario.asset.foundation is not None:
        feet = CyclicFeet(model, scenario.asset.foundation)
        parts.append(_Part(feet.motion, lambda k, x: feet.force(k, feet.motion @ x[:n]), EVALUATIONS))
    return parts


def _with_feedback(
    parts: list[_Part], space: StateSpace, hold: Hold, x0: FloatArray, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    rows = np.vstack([part.rows for part in parts])
    own = Hold(hold.E, hold.P0 @ rows.T, hold.P1 @ rows.T)

    def feedback(k: int, x: FloatArray) -> FloatArray:
        return np.concatenate([part.force(k, x) for part in parts])

    evaluations = max(part.evaluations for part in parts)
    states, extra = march_with_feedback(hold, own, x0, force, feedback, evaluations=evaluations)
    return states, force + extra @ rows


def _loads(scenario: Scenario, n_steps: int) -> _Loads:
    """Return model and loads, with n_steps + 1 rows of which the last repeats the first."""
    model = build_model(scenario)
    basis, step = model.reduced.basis, scenario.clock.load_step_s
    t = np.arange(n_steps + 1, dtype=np.float64) * step
    repeating = np.zeros((n_steps + 1, model.reduced.n))
    drag = {source: np.zeros((model.reduced.n,) * 2) for source in ("water", "rotor")}
    signals: dict[str, FloatArray] = {}
    wave: WaterLoads | None = None
    rotor: RotorLoads | None = None
    beyond: RelativeDrag | None = None
    known = np.zeros((6, 6))
    if scenario.sea is not None:
        grid = water_points(model.assembly, scenario.sea)
        ends = water_ends(model.assembly, scenario.sea)
        water = water_loads(
            scenario.sea,
            grid,
            np.asarray(grid.N.T @ basis),
            duration=scenario.clock.total_s,
            ends=None if ends is None else (ends, np.asarray(ends.N.T @ basis)),
            keep_motion=scenario.sea.relative_velocity == "full",
        )
        if water is not None:
            if scenario.sea.relative_velocity != "none":
                drag["water"] += relative_drag(grid, water, basis)
            if scenario.sea.relative_velocity == "full":
                beyond = relative_drag_beyond(grid, water, basis, drag["water"])
            if scenario.sea.waves is not None:
                signals["wave_elevation"] = water.elevation(t)
            if abs(water.series.period_s - scenario.clock.total_s) < 1e-9:
                repeating += water.at(t)
            else:
                wave = water
    if scenario.air is not None and scenario.turbine is not None:
        air, aero = scenario.air, aerodynamics(scenario.air, scenario.turbine)
        field_ = wind_field(air, aero, duration=scenario.clock.total_s, step=step)
        rotor = rotor_loads_in(field_, air, aero)
        known = rotor.mean_damping()
        repeating += _closed(rotor.still) @ model.top
        signals["wind_hub_x"] = _closed(field_.at_hub()[:, 0])
        tower = tower_points(model.assembly, air)
        if tower is not None:
            repeating += _closed(tower_loads(field_, tower, np.asarray(tower.N.T @ basis)))
            drag["rotor"] += tower_damping(air, tower, basis)
        model = with_aerodynamics(model, aero.mean._replace(damping=known))
    for source, matrix in drag.items():
        model = model.with_forces_of_motion(source, damping=matrix, stiffness=np.zeros_like(matrix))
    return _Loads(model, repeating, wave, rotor, known, signals, beyond)


def _closed(series: FloatArray) -> FloatArray:
    return np.concatenate([series, series[:1]])
