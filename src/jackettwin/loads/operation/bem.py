r"""Power production: steady blade element momentum theory.

The inflow angle φ of each annulus solves sin φ/(1 − a) = (V/Ωr) cos φ/(1 + a′) (Ning 2014, Wind Energy
17:1327), with Prandtl's tip and hub losses and Buhl's (2005) thrust at high induction. Of tilt
and cone the annuli see the wind's component normal to the blades; yaw affects loads, not the induction.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.loads.aerodynamics.rotor import AIR_KG_M3, Rotor
from jackettwin.loads.operation.schedule import Schedule


@dataclass(frozen=True)
class Control:
    """Set points of the controller: optimal tip-speed ratio, limits of the speed, rated aerodynamic power."""

    rated_power_w: float
    tip_speed_ratio: float
    lowest_speed_rad_s: float
    highest_speed_rad_s: float
    efficiency: float = 0.957
    """Generator power over aerodynamic power (IEA 15 MW: 95.756 %)."""
    wind_speeds_m_s: tuple[float, float] | None = None
    """Cut-in and cut-out; None if not known."""
    schedule: Schedule | None = None
    """Speed and pitch by wind speed; None holds the tip-speed ratio, then the power."""

    def scaled(self, factor: float) -> Control:
        """Return the control of the similar rotor at the same tip speeds: power grows with the swept area."""
        schedule = self.schedule
        if schedule is not None:
            schedule = schedule._replace(rotor_speed=schedule.rotor_speed / factor)
        return replace(
            self,
            rated_power_w=self.rated_power_w * factor**2,
            lowest_speed_rad_s=self.lowest_speed_rad_s / factor,
            highest_speed_rad_s=self.highest_speed_rad_s / factor,
            schedule=schedule,
        )


class OperatingPoint(NamedTuple):
    """A steady operating point.

    ``induced`` (n, 2) are the axial and tangential induced velocities at the stations [m/s].
    """

    wind_speed: float
    rotor_speed: float
    pitch: float
    thrust: float
    torque: float
    induced: FloatArray

    @property
    def power(self) -> float:
        """Aerodynamic power [W]."""
        return self.torque * self.rotor_speed


def steady_operation(
    rotor: Rotor, wind_speed: float, *, rotor_speed: float, pitch: float, density: float = AIR_KG_M3
) -> OperatingPoint:
    """Return thrust along the shaft, torque and induction of a rotor that is not yawed.

    Raises
    ------
    InputError
        If the wind speed or the rotor speed is zero.
    """
    if not (wind_speed > 0.0 and rotor_speed > 0.0):
        raise InputError(
            "power production needs wind and a rotating rotor",
            field="wind_speed, rotor_speed",
            value=(wind_speed, rotor_speed),
            allowed="> 0",
        )
    r = ring_radius(rotor)
    wind = normal_wind(rotor, wind_speed)
    induced = balanced_wake(rotor, wind, rotor_speed * r, pitch)
    axial, tangential = ring_forces(rotor, wind, rotor_speed * r, pitch, induced, density=density)
    thrust = float(np.cos(rotor.cone) * axial.sum())
    return OperatingPoint(wind_speed, rotor_speed, pitch, thrust, float(r @ tangential), induced)


def normal_wind(rotor: Rotor, wind_speed: float) -> FloatArray:
    """Return the wind's component normal to the coned, tilted blades at the stations (n,) [m/s]."""
    return np.full(rotor.blade.z.size, wind_speed * np.cos(rotor.tilt) * np.cos(rotor.cone))


def ring_radius(rotor: Rotor) -> FloatArray:
    """Return the distance (n,) of the blade's stations from the shaft [m]."""
    return np.asarray(
        (rotor.hub_radius + rotor.blade.z) * np.cos(rotor.cone) + rotor.blade.prebend * np.sin(rotor.cone)
    )


def balanced_wake(rotor: Rotor, wind: FloatArray, swirl: FloatArray, pitch: float) -> FloatArray:
    """Return the induced velocities (..., n, 2), axial and tangential [m/s], that balance rings' momentum.

    ``wind`` and ``swirl`` (..., n) are the air's velocity along the shaft and around it, relative to the
    blade and without the wake [m/s].
    """
    r = ring_radius(rotor)
    low, high = np.full(swirl.shape, 1e-6), np.full(swirl.shape, 0.5 * np.pi)
    for _ in range(50):
        phi = 0.5 * (low + high)
        a, da = _induction(rotor, r, phi, pitch)
        residual = np.sin(phi) / (1.0 - a) - wind / swirl * np.cos(phi) / (1.0 + da)
        low, high = np.where(residual < 0.0, phi, low), np.where(residual < 0.0, high, phi)
    a, da = _induction(rotor, r, 0.5 * (low + high), pitch)
    # swirl rotates opposite to the rotor: it adds to the tangential wind
    return np.stack([wind * a, swirl * da], axis=-1)


def ring_forces(
    rotor: Rotor,
    wind: FloatArray,
    swirl: FloatArray,
    pitch: float,
    induced: FloatArray,
    *,
    density: float = AIR_KG_M3,
) -> tuple[FloatArray, FloatArray]:
    """Return the forces of all blades (..., n) along the shaft, and around it with the rotation [N]."""
    blade = rotor.blade
    axial, tangential = wind - induced[..., 0], swirl + induced[..., 1]
    phi = np.arctan2(axial, tangential)
    cl, cd = blade.coefficients(phi - pitch - blade.twist)
    scale = 0.5 * density * (axial**2 + tangential**2) * blade.chord * blade.weight * rotor.n_blades
    return scale * (cl * np.cos(phi) + cd * np.sin(phi)), scale * (cl * np.sin(phi) - cd * np.cos(phi))


def _induction(rotor: Rotor, r: FloatArray, phi: FloatArray, pitch: float) -> tuple[FloatArray, FloatArray]:
    """Return (a, a′) of an annulus at inflow angle φ by momentum theory; Ning eqs. (10)–(17)."""
    blade, B = rotor.blade, rotor.n_blades
    cl, cd = blade.coefficients(phi - pitch - blade.twist)
    sin, cos = np.sin(phi), np.cos(phi)
    cn, ct = cl * cos + cd * sin, cl * sin - cd * cos
    sigma = B * blade.chord / (2.0 * np.pi * r)
    tip = np.maximum(rotor.radius - r, 1e-3) / (r * sin)
    hub = np.maximum(r - rotor.hub_radius, 1e-3) / (rotor.hub_radius * sin)
    F = np.ones_like(r)
    for distance in (tip, hub):
        F = F * 2.0 / np.pi * np.arccos(np.exp(-0.5 * B * distance))
    F = np.maximum(F, 1e-4)
    k, dk = sigma * cn / (4.0 * F * sin**2), sigma * ct / (4.0 * F * sin * cos)
    g1 = 2.0 * F * k - (10.0 / 9.0 - F)
    g2 = np.maximum(2.0 * F * k - F * (4.0 / 3.0 - F), 1e-12)
    g3 = 2.0 * F * k - (25.0 / 9.0 - 2.0 * F)
    near = np.abs(g3) < 1e-6
    high = np.where(near, 1.0 - 0.5 / np.sqrt(g2), (g1 - np.sqrt(g2)) / np.where(near, 1.0, g3))
    a = np.where(k <= 2.0 / 3.0, k / (1.0 + np.maximum(k, -0.5)), high)
    return np.minimum(a, 0.999), np.clip(dk / (1.0 - np.minimum(dk, 0.9)), -0.9, 10.0)


def operating_point(
    rotor: Rotor, control: Control, wind_speed: float, *, density: float = AIR_KG_M3
) -> OperatingPoint:
    """Return the point the controller holds: its schedule's, or optimal speed and no pitch, then rated power.

    Raises
    ------
    InputError
        If a schedule does not reach that wind.
    """
    if control.schedule is not None:
        speed, pitch = control.schedule.at(wind_speed)
        return steady_operation(rotor, wind_speed, rotor_speed=speed, pitch=pitch, density=density)
    speed = float(
        np.clip(
            control.tip_speed_ratio * wind_speed / rotor.radius,
            control.lowest_speed_rad_s,
            control.highest_speed_rad_s,
        )
    )

    def at(pitch: float) -> OperatingPoint:
        return steady_operation(rotor, wind_speed, rotor_speed=speed, pitch=pitch, density=density)

    wanted = control.rated_power_w / control.efficiency
    if at(0.0).power <= wanted:
        return at(0.0)
    return at(float(brentq(lambda pitch: at(pitch).power - wanted, 0.0, np.radians(45.0), xtol=1e-8)))
