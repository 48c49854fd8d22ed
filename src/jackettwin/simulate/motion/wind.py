"""Wind on rotor and tower: time series of loads on an asset at rest, and what its motion changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import (
    AIR_KG_M3,
    Coefficients,
    CompiledRotor,
    MorisonPoints,
    RotorWind,
    compiled_rotor,
    morison_points,
    rotation,
    rotor_wind,
    tower_drag,
    tower_drag_damping,
)
from jackettwin.simulate.motion.model import Aerodynamics
from jackettwin.simulate.scenario.air import Air
from jackettwin.structure import Assembly

_UP = np.array([0.0, 0.0, 1.0])
_TOWER_SPACING_M = 8.0
"""Longest piece of the tower under wind, which is known every 19 m."""
_INSTANTS = 500
"""Times over which the damping is averaged."""
_STEP_M_S = 0.05
"""Velocity by which loads are differenced: small against the wind, large against rounding."""


@dataclass(frozen=True)
class RotorLoads:
    """Loads at the tower top in global axes.

    Attributes
    ----------
    still : (n_times, 6) with the tower at rest
    wind : (n_times, n_places, 3) that the blades see, in the nacelle's axes
    angle : (n_times,) through which the rotor has turned [rad]
    radius : of the rotor [m]
    turn : (n_times, 6, 6) global from nacelle's axes; (1, 6, 6) if it does not yaw
    """

    rotor: CompiledRotor
    radius: float
    still: FloatArray
    wind: FloatArray
    angle: FloatArray
    turn: FloatArray

    def change(self, damping: FloatArray) -> Callable[[int, FloatArray], FloatArray]:
        """Return F(v) − F(0) + C v at step k for a velocity v (6,) of the top: what C leaves out."""
        turns = self.turn.shape[0]

        def at(k: int, velocity: FloatArray) -> FloatArray:
            turn = self.turn[k % turns]
            moving = self.rotor.loads(self.wind[k : k + 1], (velocity @ turn)[None], self.angle[k : k + 1])[0]
            return np.asarray(turn @ moving - self.still[k] + damping @ velocity)

        return at

    def mean_damping(self) -> FloatArray:
        """Return what the loads lose with the top's velocity (6, 6), averaged over the turbulent wind.

        In a gust the flow leaves the blades' straight lift: 4 % less side-side damping than the mean wind's
        at 12 m/s in class B.
        """
        every = max(1, self.angle.size // _INSTANTS)
        wind, angle = self.wind[::every], self.angle[::every]
        damping = np.empty((angle.size, 6, 6))
        for j, step in enumerate((*[_STEP_M_S] * 3, *[_STEP_M_S / self.radius] * 3)):
            velocity = np.zeros((angle.size, 6))
            velocity[:, j] = step
            ahead, behind = (self.rotor.loads(wind, sign * velocity, angle) for sign in (1.0, -1.0))
            damping[:, :, j] = (behind - ahead) / (2.0 * step)
        turn = self.turn[::every] if self.turn.shape[0] > 1 else self.turn
        return np.asarray((turn @ damping @ turn.swapaxes(1, 2)).mean(axis=0))


def wind_field(air: Air, aero: Aerodynamics | None, *, duration: float, step: float) -> RotorWind:
    """Return turbulent wind that repeats after ``duration`` [s], on the tower alone without a rotor."""
    return rotor_wind(
        air.wind,
        None if aero is None else aero.turbine.rotor,
        duration=duration,
        step=step,
        seed=air.seed,
        azimuth=None if aero is None or aero.turns else aero.turbine.azimuth,
        coherent=air.coherent,
        piece=air.piece_m,
        grid=air.grid_m,
    )


def rotor_loads_in(
    field: RotorWind, air: Air, aero: Aerodynamics, *, heading: float | FloatArray | None = None
) -> RotorLoads:
    """Return the rotor's loads in turbulent wind; ``heading`` [rad], one or (n_times,), default the air's."""
    turbine, operation = aero.turbine, aero.operation
    speed = 0.0 if operation is None else operation.rotor_speed
    rotor = compiled_rotor(
        turbine.rotor,
        pitch=turbine.pitch,
        azimuth=turbine.azimuth,
        rotor_speed=speed,
        shaft="free" if turbine.state == "idling" else "locked",
        induced=None if operation is None else operation.induced,
    )
    angle = speed * field.step_s * np.arange(field.n_times, dtype=np.float64)
    yaw = air.yaw if heading is None else heading
    wind, shares = field.seen(turbine.rotor, turbine.azimuth + angle, yaw=yaw)
    rotor = rotor.seeing(shares)
    turn = np.array([np.kron(np.eye(2), rotation(_UP, float(one))) for one in np.atleast_1d(yaw)])
    still = rotor.loads(wind, np.zeros((field.n_times, 6)), angle)
    turned = (turn @ still[:, :, None])[:, :, 0]
    return RotorLoads(rotor, turbine.rotor.radius, turned, wind, angle, turn)


def tower_points(assembly: Assembly, air: Air) -> MorisonPoints | None:
    """Return the points of the tower that wind pushes; None if nothing of it is called tower."""
    others = tuple({m.part for m in assembly.structure.members} - {"tower"})
    if air.tower_drag == 0.0 or not any(m.part == "tower" for m in assembly.structure.members):
        return None
    return morison_points(
        assembly,
        lowest_z=0.0,
        coefficients=Coefficients(drag=air.tower_drag, added_mass=0.0, pressure=0.0, density_kg_m3=AIR_KG_M3),
        spacing=_TOWER_SPACING_M,
        exclude_parts=others,
    )


def tower_loads(field: RotorWind, grid: MorisonPoints, columns: FloatArray) -> FloatArray:
    """Return drag on the tower (n_times, n_columns)."""
    forces = tower_drag(grid, field.at_heights(grid.points[:, 2]))
    return np.asarray(forces.reshape(field.n_times, -1) @ columns)


def tower_damping(air: Air, grid: MorisonPoints, basis: FloatArray) -> FloatArray:
    """Return the damping (n, n) of the mean wind on the tower."""
    mean = np.zeros_like(grid.points)
    mean[:, 0] = air.wind.mean(grid.points[:, 2])
    return np.asarray(basis.T @ (tower_drag_damping(grid, mean) @ basis))
