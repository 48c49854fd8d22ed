r"""The air about the elements of a turning rotor: its steady flow by azimuth, and small changes of it.

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
from jackettwin.loads.operation.skewed_wake import redistributed
from jackettwin.loads.operation.turning import ORDERS, in_plane, radial, rates, through

_STEP_M_S = 0.01
"""Of velocity by which elements are differenced: within a tenth of the polars' spacing at the tip."""
_STEP_SKEW = 1e-3


@dataclass(frozen=True)
class BladeAir:
    """What changes of the flow do to the elements of all blades; arrays (places, n, ...).

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


def steady_air(
    rotor: Rotor, operation: OperatingPoint, flow: FloatArray, skew: FloatArray, *, density: float
) -> SteadyAir:
    """Return the wake and the forces of a steady ``flow`` (places, n, 2) with the disc's ``skew`` (2,)."""
    lags = np.stack([wake_share(rotor, operation, 1j * m * operation.rotor_speed) for m in ORDERS])
    even = through(_balanced(rotor, operation, flow), lags).real
    wake = _skewed(rotor, even, flow, skew)
    return SteadyAir(even, wake, _forces(rotor, operation, flow, wake, density)[..., :2])


def blade_air(
    rotor: Rotor,
    operation: OperatingPoint,
    pole: complex,
    flow: FloatArray,
    skew: FloatArray,
    *,
    density: float,
) -> BladeAir:
    """Return what small changes with e^{λt} do about a steady ``flow`` (places, n, 2) with ``skew`` (2,)."""
    even, wake, _ = steady_air(rotor, operation, flow, skew, density=density)
    of_wake = _gradient(lambda w: _forces(rotor, operation, flow, w, density), wake)
    of_flow = _gradient(lambda u: _forces(rotor, operation, u, wake, density), flow)
    towards = _STEP_SKEW * np.eye(2)
    turned = [_skewed(rotor, even, flow, skew + s) - _skewed(rotor, even, flow, skew - s) for s in towards]
    seen = np.hypot(flow[..., 0] - wake[..., 0], flow[..., 1] + wake[..., 1]).mean(axis=0)
    by_order = rates(pole, operation.rotor_speed)
    return BladeAir(
        of_flow=of_flow + of_wake @ _gradient(lambda u: _skewed(rotor, even, u, skew), flow),
        of_wake=of_wake @ _gradient(lambda w: _skewed(rotor, w, flow, skew), even),
        of_skew=of_wake @ np.stack(turned, axis=-1) / (2.0 * _STEP_SKEW),
        balance=_gradient(lambda u: _balanced(rotor, operation, u), flow),
        of_lift=_of_lift(rotor, operation, flow, wake, density),
        wake_gain=np.stack([wake_share(rotor, operation, complex(s)) for s in by_order]),
        lift_gain=lift_share(by_order[:, None] * rotor.blade.chord / (2.0 * seen)),
    )


def _balanced(rotor: Rotor, operation: OperatingPoint, flow: FloatArray) -> FloatArray:
    return balanced_wake(rotor, flow[..., 0], flow[..., 1], operation.pitch)


def _skewed(rotor: Rotor, even: FloatArray, flow: FloatArray, skew: FloatArray) -> FloatArray:
    pointing, share = radial(rotor) @ in_plane(rotor).T, ring_radius(rotor) / rotor.radius
    return redistributed(even, flow[..., 0], skew, pointing=pointing, share=share)


def _forces(
    rotor: Rotor, operation: OperatingPoint, flow: FloatArray, wake: FloatArray, density: float
) -> FloatArray:
    """Return both forces [N] and the inflow angle [rad] of the elements, (places, n, 3)."""
    both = ring_forces(rotor, flow[..., 0], flow[..., 1], operation.pitch, wake, density=density)
    return np.stack([*both, _inflow_angle(flow, wake)], axis=-1)


def _inflow_angle(flow: FloatArray, wake: FloatArray) -> FloatArray:
    return np.asarray(np.arctan2(flow[..., 0] - wake[..., 0], flow[..., 1] + wake[..., 1]))


def _gradient(function: Callable[[FloatArray], FloatArray], at: FloatArray) -> FloatArray:
    """Return central differences with the last axis of ``at``, (..., out, in)."""
    steps = _STEP_M_S * np.eye(at.shape[-1])
    return np.stack([(function(at + s) - function(at - s)) / (2.0 * _STEP_M_S) for s in steps], axis=-1)


def _of_lift(
    rotor: Rotor, operation: OperatingPoint, flow: FloatArray, wake: FloatArray, density: float
) -> FloatArray:
    blade = rotor.blade
    squared = (flow[..., 0] - wake[..., 0]) ** 2 + (flow[..., 1] + wake[..., 1]) ** 2
    phi, step = _inflow_angle(flow, wake), _STEP_M_S / np.sqrt(squared)
    alpha = phi - operation.pitch - blade.twist
    slope = (blade.coefficients(alpha + step)[0] - blade.coefficients(alpha - step)[0]) / (2.0 * step)
    scale = 0.5 * density * squared * blade.chord * blade.weight * rotor.n_blades * slope
    return np.stack([scale * np.cos(phi), scale * np.sin(phi)], axis=-1)
