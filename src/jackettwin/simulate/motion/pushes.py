"""Forces at nodes and release tests of a scenario: modal forces, initial state, and logarithmic decrement."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import pi
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require
from jackettwin.response import StateSpace, damping_ratio, maxwell_branches
from jackettwin.simulate.motion.model import Model
from jackettwin.simulate.scenario.pushes import GivenForces, Pull
from jackettwin.simulate.scenario.scenario import Scenario, SimulationClock
from jackettwin.structure import dense

_SMALLEST = 0.02
"""Share of the first amplitude below which a decay is not followed."""
_MOST_CYCLES = 50
_STIFFEST = 1e-18
"""Flexibility [m/N] of rounding."""
_LEAST_CYCLES = 2
_LEAST_SHARE = 0.1
"""Share of the displacement in the pole that dominates a decay; with less the decay is no mode's."""
_LARGEST_TURN = 0.1
"""Rotation [rad] up to which displacements are linear in it within a per cent."""


def pushed(scenario: Scenario, model: Model, n_steps: int) -> tuple[FloatArray, FloatArray]:
    """Return what pushes and pull do to the coordinates, (n_steps + 1, n), and the pull's displacement (n,).

    The pull has lasted: springs and dashpots have come to rest under it. It holds until the load step of its
    release and is gone one later; let go at the very start of the simulation it is no force at all.

    Raises
    ------
    InputError
        If the file of forces has finer steps than the loads.
    """
    clock = scenario.clock
    t = np.arange(n_steps + 1, dtype=np.float64) * clock.load_step_s - clock.discard_s
    force = np.zeros((n_steps + 1, model.reduced.n))
    if scenario.forces is not None:
        force += _given(scenario.forces, model, t, clock)
    if scenario.pull is None:
        return force, np.zeros(model.reduced.n)
    pulled, displacement = _static(scenario.pull, model)
    if scenario.pull.release_s + clock.discard_s > 0.0:
        force[t <= scenario.pull.release_s + 1e-9] += pulled
    return force, displacement


def _given(given: GivenForces, model: Model, t: FloatArray, clock: SimulationClock) -> FloatArray:
    finest = float(np.diff(given.time_s).min())
    require(
        finest >= clock.load_step_s * (1.0 - 1e-6),
        "the file of forces has finer steps than the loads, which run straight between theirs",
        field="time.load_step_s",
        value=clock.load_step_s,
        allowed=f"up to {finest:g} s",
        remedy=f"load_step_s: {finest:g}",
    )
    values = given.at(t)
    rows = np.stack([_rows(model, node) for node in given.nodes])
    return np.asarray(np.einsum("tnc,ncq->tq", values, rows))


def _rows(model: Model, node: str) -> FloatArray:
    """Return the motion of a node from the coordinates, (6, n)."""
    assembly = model.assembly
    return np.asarray(assembly.expand[assembly.mesh.node_dofs(node)] @ model.reduced.basis)


def _along(pull: Pull, model: Model) -> FloatArray:
    """Return the pulled node's displacement along the pull from the coordinates, (n,)."""
    return np.asarray(np.array(pull.direction) @ _rows(model, pull.node)[:3])


def _static(pull: Pull, model: Model) -> tuple[FloatArray, FloatArray]:
    """Return the pull's force on the coordinates and the displacements under it."""
    along = _along(pull, model)
    K = dense(model.reduced.pencil.static_stiffness())
    per_newton = np.linalg.solve(K, along)  # what flows or falls over is refused before it is reduced
    flexibility = float(along @ per_newton)
    require(
        flexibility > _STIFFEST,
        "is held in this direction: no force moves it",
        field="start.node",
        value=pull.node,
        remedy="pull a node that moves",
    )
    newtons = pull.force_n if pull.force_n is not None else float(pull.displacement_m or 0.0) / flexibility
    return newtons * along, np.asarray(newtons * per_newton)


def started(x0: FloatArray, displacement: FloatArray, model: Model, space: StateSpace) -> FloatArray:
    """Return a start (n_states,) displaced by a lasting pull: at rest, every dashpot relaxed."""
    inner = [displacement[branch.dofs] for branch in maxwell_branches(model.reduced.pencil)]
    return np.asarray(x0 + np.concatenate([displacement, np.zeros(space.n), *inner]))


@dataclass(frozen=True)
class Decrement:
    """Logarithmic decrement of a released node, and the pole of the mode that dominates its decay.

    Attributes
    ----------
    node, direction : of the pull
    cycles : on which a straight line through the logarithms of the peaks rests
    frequency_hz, logarithmic_decrement, damping_ratio : ζ = δ/√(4π² + δ²)
    scatter : standard deviation of the peaks about the line, of the logarithm
        Large where several modes beat, or damping depends on the amplitude.
    pole_frequency_hz, pole_damping_ratio : of the model
    pole_share : of the displacement at the release
    """

    node: str
    direction: tuple[float, float, float]
    cycles: int
    frequency_hz: float
    logarithmic_decrement: float
    damping_ratio: float
    scatter: float
    pole_frequency_hz: float
    pole_damping_ratio: float
    pole_share: float

    def document(self) -> dict[str, Any]:
        """Return it as JSON data."""
        return asdict(self)


def decrement(scenario: Scenario, model: Model, space: StateSpace, states: FloatArray) -> Decrement | None:
    """Return the logarithmic decrement after the release.

    None without a pull, under other loads, or if no mode carries the displacement for some cycles.
    The first cycle is left out, in which modes die that the pull excites beside the first.
    """
    pull, clock = scenario.pull, scenario.clock
    if pull is None or not _alone(scenario):
        return None
    first = round((pull.release_s + clock.discard_s) / clock.load_step_s) + (pull.release_s > 0.0)
    along = _along(pull, model)
    times, peaks = _peaks(states[first:, : space.n] @ along, clock.load_step_s)
    from_second = slice(2, 2 + 2 * _MOST_CYCLES)  # two extremes a cycle
    times, peaks = times[from_second], peaks[from_second]
    loud = peaks > _SMALLEST * peaks[:1].max(initial=0.0)
    last = peaks.size if loud.all() else int(np.argmin(loud))
    if last < 2 * _LEAST_CYCLES + 1:
        return None
    k, logs = 0.5 * np.arange(last), np.log(peaks[:last])
    slope, level = np.polyfit(k, logs, 1)
    f, zeta, share = _pole(space, states[first], along)
    if abs(share) < _LEAST_SHARE:
        return None
    return Decrement(
        pull.node,
        pull.direction,
        int(k[-1]),
        float(k[-1] / (times[last - 1] - times[0])),
        float(-slope),
        float(-slope / np.hypot(2.0 * pi, slope)),
        float(np.std(logs - slope * k - level)),
        f,
        zeta,
        share,
    )


def pull_notes(scenario: Scenario, model: Model, found: Decrement | None) -> tuple[str, ...]:
    """Return why a release has no decrement, and whether the pull goes beyond what a linear model knows."""
    pull = scenario.pull
    if pull is None:
        return ()
    notes = []
    if found is None and _alone(scenario):
        notes.append(
            f"release of {pull.node}: no logarithmic decrement, since no mode carries "
            f"{100 * _LEAST_SHARE:.0f} % of the displacement, or it dies within {_LEAST_CYCLES + 1} cycles"
        )
    moved = model.assembly.expand @ (model.reduced.basis @ _static(pull, model)[1])
    turn = float(np.linalg.norm(moved.reshape(-1, 6)[:, 3:], axis=1).max())
    if turn > _LARGEST_TURN:
        notes.append(
            f"pull of {pull.node}: the structure turns by up to {np.degrees(turn):.0f}°, beyond the small "
            f"rotations (about {np.degrees(_LARGEST_TURN):.0f}°) of a linear model: pull less"
        )
    return tuple(notes)


def _alone(scenario: Scenario) -> bool:
    """Return whether nothing but a pull moves the asset."""
    waves = scenario.sea is not None and scenario.sea.waves is not None
    return scenario.air is None and scenario.forces is None and not waves


def _peaks(u: FloatArray, step_s: float) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and magnitudes of the extremes, by a parabola through the three samples about each."""
    middle = u[1:-1]
    i = 1 + np.flatnonzero((np.abs(middle) >= np.abs(u[:-2])) & (np.abs(middle) > np.abs(u[2:])))
    bend, slope = u[i - 1] - 2.0 * u[i] + u[i + 1], 0.5 * (u[i + 1] - u[i - 1])
    shift = -slope / bend
    return (i + shift) * step_s, np.abs(u[i] + 0.5 * slope * shift)


def _pole(space: StateSpace, x: FloatArray, along: FloatArray) -> tuple[float, float, float]:
    """Return frequency, damping ratio and share of the pole that moves the node most from a state."""
    values, right = np.linalg.eig(space.A)
    part = np.linalg.solve(right, x.astype(np.complex128)) * (along @ right[: space.n])
    part[values.imag <= 0.0] = 0.0
    best = int(np.argmax(np.abs(part)))
    s = values[best]
    total = abs(float(x[: space.n] @ along))
    return float(abs(s) / (2.0 * pi)), float(damping_ratio(s)), float(2.0 * part[best].real / total)
