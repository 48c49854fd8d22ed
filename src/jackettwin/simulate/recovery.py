r"""Section forces and reactions of a foundation from the interface motion of another program.

The foundation is a superelement of the interface's motion x_b, which is given, and of internal coordinates
q with unit mass:

.. math::

    \ddot q + C_{ii}\dot q + Ω^2 q = f_i - M_{ib}\ddot x_b - C_{ib}\dot x_b

(Craig & Bampton 1968; static shapes have no stiffness coupling). With z = q + M_ib x_b, D = C_ii M_ib − C_ib
and p = ż + C_ii z − D x_b, no derivative of a sampled motion is needed:

.. math:: \dot z = p - C_{ii} z + D x_b, \qquad \dot p = -Ω^2 z + Ω^2 M_{ib} x_b + f_i
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import ceil

import numpy as np
from scipy.interpolate import CubicSpline

from jackettwin.arrays import FloatArray
from jackettwin.caveats import Omission
from jackettwin.errors import look_up
from jackettwin.loads import water_mass
from jackettwin.response import (
    INTERFACE,
    Superelement,
    build_system,
    first_order_hold,
    held_displacement,
    march,
    own_damping,
)
from jackettwin.response.superelement.craig_bampton import superelement
from jackettwin.simulate.interface_motion import InterfaceMotion
from jackettwin.simulate.members import waves_along, weight
from jackettwin.simulate.motion.water import relative_drag, water_loads, water_points
from jackettwin.simulate.scenario.scenario import Scenario
from jackettwin.simulate.section_series import ForceSeries, series_of
from jackettwin.structure import Assembly, Vector, assemble, at_interface

MODES = 120
"""Internal coordinates, if the foundation has as many: stiff members at the interface are the last to settle
(docs/verification/recovery.md)."""
_PER_PERIOD = 4.0
"""Steps in the shortest period of the internal coordinates: a straight line between samples of the motion
would shake them at every sample."""
_BAND_HZ = 2.0
_BLOCK = 2000
FORCES_LEFT_OUT = tuple(
    Omission(what)
    for what in (
        "inertia of members between their joints; vibration of one member on its own beyond the coordinates",
        "wind on what stands below the interface",
        "rotations of the interface beyond small ones, and of the foundation with its yaw",
        "the motion before the file begins: the foundation starts at rest on the moving interface",
    )
)


@dataclass(frozen=True)
class Recovery:
    """Section forces and reactions, and the superelement that they are of."""

    series: ForceSeries
    element: Superelement


def recovered(
    scenario: Scenario,
    motion: InterfaceMotion,
    members: Sequence[str] = (),
    *,
    reference_m: Vector | None = None,
    number: int | None = None,
) -> Recovery:
    """Return what members and feet of a scenario's foundation bear as its interface moves.

    Weight, still water and waves of the scenario act on the foundation; what stands above is in the motion.

    Parameters
    ----------
    members : names of members; none are those that stand on the ground or carry the interface
    reference_m : point whose motion is given; default: the centroid of the interface nodes
    number : of internal coordinates; by default ``MODES``, or all but one of a smaller foundation

    Raises
    ------
    InputError
        If the structure has no interface, or no such member below it.
    """
    assembly = _foundation(scenario)
    every = {member.name: None for member in assembly.structure.members}
    for name in members:
        look_up(every, name, "member below the interface", field="--members")
    asset = scenario.asset
    own = own_damping(assembly, asset.rayleigh)
    system = build_system(assembly, asset.support, rayleigh=asset.rayleigh, spread=own)
    number = min(MODES, system.pencil.n - INTERFACE - 1) if number is None else number
    element = superelement(system, number=number, reference_m=reference_m, band_hz=_BAND_HZ)
    t = motion.step_s * np.arange(len(motion.values), dtype=np.float64)
    element, waves = _in_waves(scenario, assembly, element, t)
    q = internal_motion(element, motion, waves)
    load, at_rest = weight(scenario, assembly)
    rest = held_displacement(system, load)
    along = waves_along(scenario, assembly)
    if along is not None:
        inner, K = element.basis[:, INTERFACE:], element.K[INTERFACE:, INTERFACE:]
        followed = inner @ np.linalg.solve(K, inner.T @ along.on_dofs)
        beyond = held_displacement(system, along.on_dofs) - followed

    def blocks() -> Iterator[tuple[FloatArray, FloatArray]]:
        for first in range(0, t.size, _BLOCK):
            here = slice(first, first + _BLOCK)
            u = rest + np.hstack([motion.values[here], q[here]]) @ element.basis.T
            if along is None:
                yield u, at_rest
            else:
                loads = along.at(t[here])
                yield u + loads @ beyond.T, at_rest + along.spread(loads)

    return Recovery(series_of(assembly, blocks(), members, motion.step_s), element)


def internal_motion(element: Superelement, motion: InterfaceMotion, forces: FloatArray) -> FloatArray:
    """Return internal coordinates (n_times, n) under the interface's motion and ``forces`` (n_times, n)."""
    b, i = slice(INTERFACE), slice(INTERFACE, None)
    n = element.n - INTERFACE
    M_ib, C, K = element.M[i, b], element.C[i, i], element.K[i, i]
    D = C @ M_ib - element.C[i, b]
    A = np.block([[-C, np.eye(n)], [-K, np.zeros((n, n))]])
    B = np.block([[D, np.zeros((n, n))], [K @ M_ib, np.eye(n)]])
    fastest = float(element.held_frequency_hz.max(initial=0.0))
    finer = max(1, ceil(motion.step_s * _PER_PERIOD * fastest))
    t = np.arange(len(motion.values), dtype=np.float64) * finer
    spline = CubicSpline(t, np.hstack([motion.values, forces]))
    inputs = spline(np.arange(t[-1] + 1.0))
    step = motion.step_s / finer
    x_b, v_b = motion.values[0], spline(0.0, 1)[:INTERFACE] / step
    q = np.linalg.solve(K, forces[0])
    z = q + M_ib @ x_b
    start = np.concatenate([z, M_ib @ v_b + C @ z - D @ x_b])
    states = march(first_order_hold(A, B, step), start, inputs)[::finer, :n]
    return np.asarray(states - motion.values @ M_ib.T)


def _foundation(scenario: Scenario) -> Assembly:
    """Return what is below the interface, with the added mass of water and the weight of the whole."""
    asset, sea = scenario.asset, scenario.sea
    built = partial(
        assemble,
        beam_theory=asset.beam,
        rotary_inertia=asset.rotary_inertia,
        subdivide=asset.subdivide,
        gravity=asset.gravity,
    )
    assembly = built(at_interface(asset.structure)[0], weight=built(asset.structure).weight)
    if sea is None or sea.water is None:
        return assembly
    grid = water_points(assembly, sea)
    return replace(assembly, mass=assembly.mass + water_mass(assembly, grid, sea.water).tocsc())


def _in_waves(
    scenario: Scenario, assembly: Assembly, element: Superelement, t: FloatArray
) -> tuple[Superelement, FloatArray]:
    """Return the element with the drag on its motion, and forces (n_times, n) on its internal coordinates."""
    sea, nothing = scenario.sea, np.zeros((t.size, element.n - INTERFACE))
    if sea is None or (sea.waves is None and sea.current is None):
        return element, nothing
    grid = water_points(assembly, sea)
    columns = np.asarray(grid.N.T @ element.basis)
    water = water_loads(sea, grid, columns, duration=scenario.clock.total_s)
    if water is None:
        return element, nothing
    if sea.relative_velocity != "none":
        element = replace(element, C=element.C + relative_drag(grid, water, element.basis))
    return element, water.at(t)[:, INTERFACE:]
