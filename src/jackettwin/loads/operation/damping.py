r"""Linearised forces of an operating rotor on its moving tower: air, wake, gyroscopic, bending blades.

The tower top's six motions and the blades' modes, each with its orders of the azimuth, move the elements of
all blades with e^{λt}; forces of air and inertia on the same motions, averaged over azimuth, are Z(λ). The
blades' coordinates are condensed:

.. math:: Z = Z_{tt} - Z_{tb} Z_{bb}^{-1} Z_{bt}, \quad λ C + K = Z, \quad C, K \text{ real}

so that C and K also hold what bending blades add to or take from the rigid rotor's mass at λ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3, Linearised, Rotor, linearise
from jackettwin.loads.operation.bem import OperatingPoint
from jackettwin.loads.operation.blade_air import BladeElements, SteadyAir
from jackettwin.loads.operation.blade_bending import (
    BendingBlades,
    bending_blades,
    centrifugal,
    pieces,
    softening,
    turning_shapes,
)
from jackettwin.loads.operation.rotor_kinematics import (
    AZIMUTH,
    PLACES,
    arms,
    blade_frames,
    flow_directions,
    handed_on,
    in_plane,
    motions,
    prebend,
    rates,
    through,
)
from jackettwin.structure import cross_matrix

OPERATING_LOG_STD = {"fore_aft": 0.2, "side_side": 0.5}
"""Error of the rotor's part of the first bending modes' damping, as a standard deviation of its
logarithm: within a tenth in steady wind (docs/verification/operation.md), and what turbulence, a controller
and a drivetrain of its own change."""
OPERATING_LEAST_RATIO = 1e-3
"""Of damping that is told from none: across light wind the rotor's part is smaller, and may be negative."""
_BLADE_ORDERS = (0, 1, -1, 2, -2)
_SETTLED = 5
"""Rounds in which the blades' deflection and their loads meet: each is some ten times nearer."""


def operating_damping(
    rotor: Rotor,
    operation: OperatingPoint,
    *,
    pole: complex | None = None,
    shaft: str = "locked",
    yaw_error: float = 0.0,
    bending: bool = True,
    density: float = AIR_KG_M3,
) -> Linearised:
    """Return a rotor linearised about an operating point, pitch held, at the tower top.

    Parameters
    ----------
    pole : complex, optional
        λ of the tower's motion e^{λt} [rad/s], iω of a steady one; None freezes the wake, which answers
        within R/V, keeps the blades rigid and leaves out gyroscopic moments.
    shaft : {"locked", "free"}
        Whether the speed against the nacelle is held ("locked"), or the generator's torque ("free"): then the
        inertia of the rotor keeps it turning evenly whatever the tower does, and the torque's changes stay in
        it. A turbine at work is nearer to the latter.
    bending : bool
        Whether blades bend, where the rotor's file has their mass and stiffness; gyroscopic moments are of
        their mass, too.
    """
    if pole is not None:
        wind = operation.wind_speed * np.array([np.cos(yaw_error), np.sin(yaw_error), 0.0])
        return _Moved(rotor, operation, pole, shaft, wind, density).answer(bending=bending)
    still, moving = (
        linearise(
            rotor,
            operation.wind_speed,
            pitch=operation.pitch,
            yaw_error=yaw_error,
            rotor_speed=operation.rotor_speed,
            shaft=of,
            induced=operation.induced,
            density=density,
        )
        for of in ("locked", shaft)
    )
    return Linearised(still.load, moving.damping, still.stiffness)


@dataclass(frozen=True)
class _Standing:
    """A rotor in its steady wind; arrays (places, n, ...) over the aerodynamic stations.

    ``forces`` are those of all blades [N], ``directions`` those of the flow, ``slope`` (n,) dx/dz.
    """

    arm: FloatArray
    slope: FloatArray
    directions: FloatArray
    flow: FloatArray
    air: SteadyAir
    forces: FloatArray


@dataclass(frozen=True)
class _Moved:
    """A rotor at an operating point in a ``wind`` (3,), its tower top moved with e^{λt}."""

    rotor: Rotor
    operation: OperatingPoint
    pole: complex
    shaft: str
    wind: FloatArray
    density: float

    def answer(self, *, bending: bool) -> Linearised:
        """Return load, damping and stiffness (6, 6) at the tower top."""
        rotor, pole, blades = self.rotor, self.pole, None
        if rotor.bending is not None:
            turn = self.operation.rotor_speed
            blades = bending_blades(rotor, pitch=self.operation.pitch, rotor_speed=turn)
        bent = blades if bending else None
        standing = self._standing(bent)
        Z = -self._air_forces(standing, bent)
        if blades is not None:
            Z += self._inertia(blades, bent)
        locked = motions(rotor, standing.arm, shaft="locked")
        load = np.einsum("pnij,pni->j", locked, standing.forces) / PLACES
        if bent is not None:
            Z = Z[:6, :6] - Z[:6, 6:] @ np.linalg.solve(Z[6:, 6:], Z[6:, :6])
        # the mean load turns with the tower top
        for at in (slice(0, 3), slice(3, 6)):
            Z[at, 3:] += cross_matrix(load[at])
        damping = Z.imag / pole.imag
        return Linearised(load, damping, Z.real - pole.real * damping)

    @property
    def _elements(self) -> BladeElements:
        return BladeElements(self.rotor, self.operation, self.density, self._skew)

    @property
    def _skew(self) -> FloatArray:
        """The wind in the disc's plane over that along the shaft, (2,)."""
        return np.asarray(in_plane(self.rotor) @ self.wind / (self.rotor.shaft @ self.wind))

    @property
    def _handed_on(self) -> FloatArray:
        return handed_on(self.rotor, self.shaft)

    def _standing(self, bent: BendingBlades | None) -> _Standing:
        """Return the rotor as the wind and its own turning bend the blades."""
        rotor, speed, pitch = self.rotor, self.operation.rotor_speed, self.operation.pitch
        offset = prebend(rotor, rotor.blade.z, pitch)
        found = self._bent_by(offset)
        if bent is None:
            return found
        shapes = turning_shapes(rotor, bent.aero_shape)
        pull = centrifugal(rotor, bent, pieces(rotor, bent, pitch), speed)
        away = np.einsum("pnik,pni->k", turning_shapes(rotor, bent.shape), pull) / PLACES
        stiffness = bent.stiffness - softening(rotor, bent, speed)
        for _ in range(_SETTLED):
            pushed = np.einsum("pnik,pni->k", shapes, found.forces) / PLACES
            eta = np.linalg.solve(stiffness, pushed + away)
            found = self._bent_by(offset + bent.aero_shape @ eta)
        return found

    def _bent_by(self, offset: FloatArray) -> _Standing:
        z, slope = self.rotor.blade.z, np.gradient(offset[:, 0], self.rotor.blade.z)
        arm = arms(self.rotor, z, offset)
        directions = flow_directions(self.rotor, slope)
        flow = np.einsum("pnai,pni->pna", directions, self._passing(arm))
        air = self._elements.steady(flow)
        forces = np.einsum("pnia,pna->pni", _pushes(directions), air.forces)
        return _Standing(arm, slope, directions, flow, air, forces)

    def _passing(self, arm: FloatArray) -> FloatArray:
        """Return the air's velocity (places, n, 3) that turning elements see without the wake."""
        return np.asarray(self.wind - self.operation.rotor_speed * np.cross(self.rotor.shaft, arm))

    def _air_forces(self, standing: _Standing, bent: BendingBlades | None) -> ComplexArray:
        """Return the air's forces on the tower top's motions and the blades' modes with each of them."""
        rotor, pole, wind = self.rotor, self.pole, self.wind
        tests: ComplexArray = motions(rotor, standing.arm, shaft=self.shaft).astype(np.complex128)
        # what a tower top that turns sees of the wind
        seen = -pole * tests
        seen[..., 3:] += cross_matrix(wind)
        flow = standing.directions @ seen
        tilted = np.zeros_like(seen)
        if bent is not None:
            modes = _turned_modes(turning_shapes(rotor, bent.aero_shape))
            tests = np.concatenate([tests, modes], axis=-1)
            moved = -through(modes, rates(pole, self.operation.rotor_speed))
            seen = np.concatenate([seen, moved], axis=-1)
            turned = _turned_normals(rotor, standing.slope, bent)
            tilted = np.concatenate([tilted, turned], axis=-1)
            flow = standing.directions @ seen
            flow[:, :, 0] += np.einsum("pnik,pni->pnk", tilted, self._passing(standing.arm))
        centre = seen.mean(axis=(0, 1))
        along = rotor.shaft @ wind
        skew = (in_plane(rotor) @ centre - np.outer(self._skew, rotor.shaft @ centre)) / along
        normal = np.einsum("pni,pni->pn", standing.forces, standing.directions[:, :, 0])
        air = self._elements.changes(pole, standing.flow, standing.air)
        forces = _pushes(standing.directions) @ air.answer(flow, skew) + normal[..., None, None] * tilted
        found = np.einsum("pnij,pnik->jk", tests.conj(), forces) / PLACES
        if bent is not None:
            found[3:6, 6:] += self._handed_on @ _moments(modes, standing.forces)
        return np.asarray(found)

    def _inertia(self, blades: BendingBlades, bent: BendingBlades | None) -> ComplexArray:
        """Return inertia and stiffness of turning blades without what a rigid rotor at rest has.

        In the frame of the tower top a piece at rest on the rotor has the acceleration T ẍ + 2 θ̇ × (Ω × r).
        """
        rotor, pole, speed = self.rotor, self.pole, self.operation.rotor_speed
        arm = pieces(rotor, blades, self.operation.pitch)
        fields: ComplexArray = motions(rotor, arm, shaft=self.shaft).astype(np.complex128)
        accelerations = pole**2 * fields
        turning = 2.0 * pole * cross_matrix(speed * np.cross(rotor.shaft, arm)) @ self._handed_on
        accelerations[..., 3:] -= turning
        if bent is not None:
            modes = _turned_modes(turning_shapes(rotor, bent.shape))
            fields = np.concatenate([fields, modes], axis=-1)
            moved = through(modes, rates(pole, speed) ** 2)
            accelerations = np.concatenate([accelerations, moved], axis=-1)
        found = np.einsum("n,pnij,pnik->jk", blades.mass, fields.conj(), accelerations) / PLACES
        rigid = fields[..., :6].real
        found[:6, :6] -= pole**2 * np.einsum("n,pnij,pnik->jk", blades.mass, rigid, rigid) / PLACES
        if bent is not None:
            pull = centrifugal(rotor, blades, arm, speed)
            found[3:6, 6:] -= self._handed_on @ _moments(modes, pull)
            of_order = [bent.stiffness + (pole + 1j * m * speed) * bent.damping for m in _BLADE_ORDERS]
            k = bent.stiffness.shape[0]
            for j, matrix in enumerate(of_order):
                at = slice(6 + j * k, 6 + (j + 1) * k)
                found[at, at] += matrix
        return np.asarray(found)


def _pushes(directions: FloatArray) -> FloatArray:
    """Return directions (places, n, 3, 2) of forces: normal to the blade, and around with the rotation."""
    return np.asarray(np.swapaxes(directions * np.array([1.0, -1.0])[:, None], -1, -2))


def _turned_modes(shapes: FloatArray) -> ComplexArray:
    """Return modes (places, n, ..., k) times e^{imψ} by order, (places, n, ..., orders·k)."""
    return np.concatenate(
        [shapes * np.exp(1j * m * AZIMUTH).reshape((-1,) + (1,) * (shapes.ndim - 1)) for m in _BLADE_ORDERS],
        axis=-1,
    )


def _turned_normals(rotor: Rotor, slope: FloatArray, bent: BendingBlades) -> ComplexArray:
    """Return how the blades' modes turn the normals of the elements, (places, n, 3, orders·k)."""
    frames, angle = blade_frames(rotor)[:, None], np.arctan(slope)[:, None]
    by_angle = -np.sin(angle) * frames[..., 0] - np.cos(angle) * frames[..., 2]
    by_slope = by_angle * np.cos(angle) ** 2
    return _turned_modes(by_slope[..., None] * bent.aero_slope[:, None])


def _moments(modes: ComplexArray, forces: FloatArray) -> ComplexArray:
    """Return moments (3, k) of steady forces (places, n, 3) on places that modes (places, n, 3, k) move."""
    return np.asarray(-np.einsum("pnij,pnjk->ik", cross_matrix(forces), modes) / PLACES)
