r"""Flow at the blade elements of a turning rotor: steady by azimuth, and linearised about that.

Forces (normal to the blade, around in the sense of rotation) are functions of the flow u (normal, swirl), of
the induced velocity w and of the lift's lag. Of a small change with e^{λt}

.. math:: δf = f_u δu + f_w (w_u δu + w_v δv + w_s δs), \quad δv = H δv_{balanced}, \quad δv_{balanced} = D δu

with v the wake without skew, H its lag at λ + imΩ by order m of the azimuth, and δs the change of the disc's
skew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.loads.aerodynamics.rotor import Rotor
from jackettwin.loads.operation.bem import (
    OperatingPoint,
    balanced_wake,
    ring_forces,
    ring_radius,
)
from jackettwin.loads.operation.dynamic_inflow import lift_share, wake_share
from jackettwin.loads.operation.rotor_kinematics import ORDERS, in_plane, radial, rates, through
from jackettwin.loads.operation.skewed_wake import redistributed

_STEP_M_S = 0.01
"""Of velocity by which elements are differenced: within a tenth of the polars' spacing at the tip."""
_STEP_SKEW = 1e-3
"""Of the skew by which the wake is differenced centrally: the error is of its square."""


@dataclass(frozen=True)
class BladeAir:
    """Derivatives of the elements' loads by changes of the flow, all blades; arrays (places, n, ...).

    Attributes
    ----------
    of_flow, of_wake : (places, n, 3, 2) changes of the two forces and of the angle of attack with the flow
        and with the wake without skew
    of_skew : (places, n, 3, 2)
    balance : (places, n, 2, 2) change of the balanced wake with the flow
    of_lift : (places, n, 2) forces' change with the angle of attack through lift alone [N/rad]
    wake_gain, lift_gain : (places, n) shares of wake and of lift that follow, by order
    """

    of_flow: FloatArray
    of_wake: FloatArray
    of_skew: FloatArray
    balance: FloatArray
    of_lift: FloatArray
    wake_gain: ComplexArray
    lift_gain: ComplexArray

    def answer(self, flow: ComplexArray, skew: ComplexArray) -> ComplexArray:
        """Return the forces' changes (places, n, 2, k) with flow (places, n, 2, k) and skew (2, k)."""
        wake = through(self.balance @ flow, self.wake_gain)
        change = self.of_flow @ flow + self.of_wake @ wake + self.of_skew @ skew
        late = through(change[:, :, 2], self.lift_gain - 1.0)
        return np.asarray(change[:, :, :2] + self.of_lift[..., None] * late[:, :, None])


class SteadyAir(NamedTuple):
    """Of a steady flow: the wake (places, n, 2) without and with skew [m/s], and forces of all blades [N]."""

    even: FloatArray
    wake: FloatArray
    forces: FloatArray


@dataclass(frozen=True)
class BladeElements:
    """The elements of a turning rotor in air of a density, ``skew`` (2,) of the wind that the disc sees.

    A ``flow`` (places, n, 2) is normal to the blade, and swirl, [m/s]; a wake alike.
    """

    rotor: Rotor
    operation: OperatingPoint
    density: float
    skew: FloatArray

    def steady(self, flow: FloatArray) -> SteadyAir:
        """Return the wake and the forces of a steady flow."""
        turn = self.operation.rotor_speed
        lags = np.stack([wake_share(self.rotor, self.operation, 1j * m * turn) for m in ORDERS])
        even = through(self._balanced(flow), lags).real
        wake = self._skewed(even, flow, self.skew)
        return SteadyAir(even, wake, self._forces(flow, wake)[..., :2])

    def changes(self, pole: complex, flow: FloatArray, air: SteadyAir) -> BladeAir:
        """Return what small changes with e^{λt} do about a steady flow with its ``air``."""
        even, wake, _ = air
        of_wake = _gradient(lambda w: self._forces(flow, w), wake)
        of_flow = _gradient(lambda u: self._forces(u, wake), flow)
        towards = _STEP_SKEW * np.eye(2)
        turned = [
            self._skewed(even, flow, self.skew + s) - self._skewed(even, flow, self.skew - s) for s in towards
        ]
        seen = np.hypot(flow[..., 0] - wake[..., 0], flow[..., 1] + wake[..., 1]).mean(axis=0)
        by_order = rates(pole, self.operation.rotor_speed)
        return BladeAir(
            of_flow=of_flow + of_wake @ _gradient(lambda u: self._skewed(even, u, self.skew), flow),
            of_wake=of_wake @ _gradient(lambda w: self._skewed(w, flow, self.skew), even),
            of_skew=of_wake @ np.stack(turned, axis=-1) / (2.0 * _STEP_SKEW),
            balance=_gradient(self._balanced, flow),
            of_lift=self._of_lift(flow, wake),
            wake_gain=np.stack([wake_share(self.rotor, self.operation, complex(s)) for s in by_order]),
            lift_gain=lift_share(by_order[:, None] * self.rotor.blade.chord / (2.0 * seen)),
        )

    def _balanced(self, flow: FloatArray) -> FloatArray:
        return balanced_wake(self.rotor, flow[..., 0], flow[..., 1], self.operation.pitch)

    def _skewed(self, even: FloatArray, flow: FloatArray, skew: FloatArray) -> FloatArray:
        rotor = self.rotor
        pointing, share = radial(rotor) @ in_plane(rotor).T, ring_radius(rotor) / rotor.radius
        return redistributed(even, flow[..., 0], skew, pointing=pointing, share=share)

    def _forces(self, flow: FloatArray, wake: FloatArray) -> FloatArray:
        """Return both forces [N] and the inflow angle [rad] of the elements, (places, n, 3)."""
        both = ring_forces(
            self.rotor, flow[..., 0], flow[..., 1], self.operation.pitch, wake, density=self.density
        )
        return np.stack([*both, _inflow_angle(flow, wake)], axis=-1)

    def _of_lift(self, flow: FloatArray, wake: FloatArray) -> FloatArray:
        blade = self.rotor.blade
        squared = (flow[..., 0] - wake[..., 0]) ** 2 + (flow[..., 1] + wake[..., 1]) ** 2
        phi, step = _inflow_angle(flow, wake), _STEP_M_S / np.sqrt(squared)
        alpha = phi - self.operation.pitch - blade.twist
        slope = (blade.coefficients(alpha + step)[0] - blade.coefficients(alpha - step)[0]) / (2.0 * step)
        scale = 0.5 * self.density * squared * blade.chord * blade.weight * self.rotor.n_blades * slope
        return np.stack([scale * np.cos(phi), scale * np.sin(phi)], axis=-1)


def _inflow_angle(flow: FloatArray, wake: FloatArray) -> FloatArray:
    return np.asarray(np.arctan2(flow[..., 0] - wake[..., 0], flow[..., 1] + wake[..., 1]))


def _gradient(function: Callable[[FloatArray], FloatArray], at: FloatArray) -> FloatArray:
    """Return central differences with the last axis of ``at``, (..., out, in)."""
    steps = _STEP_M_S * np.eye(at.shape[-1])
    return np.stack([(function(at + s) - function(at - s)) / (2.0 * _STEP_M_S) for s in steps], axis=-1)
