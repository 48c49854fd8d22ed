"""The motion of an asset through a scenario."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, NumericalError
from jackettwin.response import (
    Feedback,
    Hold,
    StateSpace,
    first_order_hold,
    march,
    march_with_feedback,
    periodic_start,
    state_space,
)
from jackettwin.simulate.motion.ground import EVALUATIONS, CyclicFeet
from jackettwin.simulate.motion.loads import Loads, loads_on
from jackettwin.simulate.motion.model import BAND_HZ, Model, TrueMode, true_modes
from jackettwin.simulate.motion.pushes import Decrement, decrement, pushed, started
from jackettwin.simulate.motion.rotor_feedback import march_with_rotor
from jackettwin.simulate.scenario.scenario import Scenario, in_words_of


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
    rotor_speed_rad_s : zero where it stands, or there is none
    decrement : of a decay after a release, if nothing else moves the asset
    """

    model: Model
    space: StateSpace
    states: FloatArray
    force: FloatArray
    step_s: float
    modes: tuple[TrueMode, ...]
    signals: dict[str, FloatArray] = field(default_factory=dict)
    rotor_speed_rad_s: float = 0.0
    decrement: Decrement | None = None


def simulate_motion(scenario: Scenario) -> Motion:
    """Return the motion of a scenario's asset, from a start without transient.

    The model's own motion, the mean damping of rotor, tower and waves included, is stepped exactly; what the
    rotor adds beyond its mean damping is a feedback.

    Raises
    ------
    InputError
        If parts of the scenario do not fit each other, or the motion grows without bound under them.
    """
    with in_words_of(scenario):
        return _motion(scenario)


def _motion(scenario: Scenario) -> Motion:
    clock = scenario.clock
    n_steps = round(clock.total_s / clock.load_step_s)
    loads = loads_on(scenario, n_steps)
    space = state_space(loads.model.reduced.pencil)
    hold = first_order_hold(space.A, space.B, clock.load_step_s)
    x0 = periodic_start(hold, loads.before)
    force = loads.repeating
    if loads.wave is not None:
        series = loads.wave.series
        own = first_order_hold(space.A, space.B, series.step_s)
        x0 = x0 + periodic_start(own, np.vstack([series.loads, series.loads[:1]]))
        t = np.arange(n_steps + 1, dtype=np.float64) * clock.load_step_s
        force = force + loads.wave.at(t)
    push, displacement = pushed(scenario, loads.model, n_steps)
    force, x0 = force + push, started(x0, displacement, loads.model, space)
    try:
        states, force = _answered(scenario, loads, space, hold, x0, force)
    except NumericalError as error:
        raise InputError(
            "the motion grows without bound",
            field="time.load_step_s",
            value=clock.load_step_s,
            allowed="shorter steps, or loads that fit the structure",
            remedy="halve it; if that does not help, check coefficients, current and wind",
        ) from error
    return Motion(
        loads.model,
        space,
        states,
        force,
        clock.load_step_s,
        true_modes(loads.model, below_hz=BAND_HZ, heading_rad=scenario.heading_rad),
        loads.signals,
        0.0 if loads.rotor is None else float(loads.rotor.angle[1]) / clock.load_step_s,
        decrement(scenario, loads.model, space, states),
    )


def _answered(
    scenario: Scenario, loads: Loads, space: StateSpace, hold: Hold, x0: FloatArray, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return states and forces, those that depend on the motion included."""
    parts = _feedbacks(scenario, loads)
    if not parts:
        return march(hold, x0, force), force
    if loads.rotor is not None and len(parts) == 1:
        top = loads.model.top
        states, extra = march_with_rotor(hold, x0, force, loads.rotor, loads.damping, top)
        return states, force + extra @ top
    return _with_feedback(parts, hold, x0, force)


class _Part(NamedTuple):
    """A force (m,) on the motion ``rows`` (m, n) of the coordinates, from step and state."""

    rows: FloatArray
    force: Feedback
    evaluations: int


def _feedbacks(scenario: Scenario, loads: Loads) -> list[_Part]:
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
    parts: list[_Part], hold: Hold, x0: FloatArray, force: FloatArray
) -> tuple[FloatArray, FloatArray]:
    rows = np.vstack([part.rows for part in parts])
    own = Hold(hold.E, hold.P0 @ rows.T, hold.P1 @ rows.T)

    def feedback(k: int, x: FloatArray) -> FloatArray:
        return np.concatenate([part.force(k, x) for part in parts])

    evaluations = max(part.evaluations for part in parts)
    states, extra = march_with_feedback(hold, own, x0, force, feedback, evaluations=evaluations)
    return states, force + extra @ rows
