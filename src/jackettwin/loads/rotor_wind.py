"""Turbulent wind over a rotor and its tower, sampled on rings and spokes about the hub.

The rotor's disc stands across the wind, which blows along +x; blades that turn cut through the rings
(rotational sampling). Heights count from still water.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jackettwin.loads.kernels import wind_on_blades
from jackettwin.loads.rotor import Rotor, rotation
from jackettwin.loads.wind import Wind, turbulence

FloatArray = npt.NDArray[np.float64]

RINGS = (0.3, 0.55, 0.8, 1.0)
"""Radii of the rings over the rotor's."""
SPOKES = 12
TOWER_SHARES = (0.1, 0.4, 0.7)
"""Heights of the tower's points over the hub's."""


@dataclass(frozen=True)
class RotorWind:
    """Wind about the mean (n_times, n_points, 3) [m/s] at the hub, on the rings, then down the tower."""

    wind: Wind
    fluctuation: FloatArray
    step_s: float
    radius: float

    @property
    def n_times(self) -> int:
        """Number of samples; the wind repeats after them."""
        return int(self.fluctuation.shape[0])

    def at_hub(self) -> FloatArray:
        """Return the hub's wind, mean included (n_times, 3) [m/s]."""
        return np.asarray(self.fluctuation[:, 0] + [self.wind.speed_m_s, 0.0, 0.0])

    def on_blades(self, rotor: Rotor, azimuth: FloatArray, *, yaw: float = 0.0) -> FloatArray:
        """Return the wind at the blade elements (n_times, n_elements, 3), in the nacelle's axes.

        Parameters
        ----------
        azimuth : (n_times,) [rad]
        yaw : heading of the nacelle, anticlockwise from +x seen from above [rad]
        """
        blade, n_disc = rotor.blade, 1 + len(RINGS) * SPOKES
        r = (rotor.hub_radius + blade.z) / self.radius
        knots = np.array([0.0, *RINGS])
        ring = np.clip(np.searchsorted(knots, r, side="right") - 1, 0, len(RINGS) - 1)
        share = np.clip((r - knots[ring]) / (knots[ring + 1] - knots[ring]), 0.0, 1.0)
        spoke = np.repeat(np.arange(rotor.n_blades) * SPOKES / rotor.n_blades, r.size)
        samples = self.fluctuation[:, :n_disc] + self._mean(_disc(self.wind.hub_height_m, self.radius)[:, 1])
        turned = np.ascontiguousarray(samples @ rotation(np.array([0.0, 0.0, 1.0]), yaw))
        n = rotor.n_blades
        return np.asarray(wind_on_blades(turned, azimuth, spoke, np.tile(ring, n), np.tile(share, n), SPOKES))

    def at_heights(self, z: FloatArray) -> FloatArray:
        """Return the wind on the tower's axis at heights ``z`` (n,) [m], (n_times, n, 3)."""
        hub = self.wind.hub_height_m
        knots = np.array([*TOWER_SHARES, 1.0]) * hub
        known = self.fluctuation[:, [*range(1 + len(RINGS) * SPOKES, self.fluctuation.shape[1]), 0]]
        low = np.clip(np.searchsorted(knots, z) - 1, 0, knots.size - 2)
        share = np.clip((z - knots[low]) / (knots[low + 1] - knots[low]), 0.0, 1.0)[:, None]
        return np.asarray(known[:, low] * (1.0 - share) + known[:, low + 1] * share + self._mean(z))

    def _mean(self, z: FloatArray) -> FloatArray:
        mean = np.zeros((z.size, 3))
        mean[:, 0] = self.wind.mean(z)
        return mean


def rotor_wind(wind: Wind, *, radius: float, duration: float, step: float, seed: int) -> RotorWind:
    """Return the wind of ``duration`` [s], which it repeats, in steps of ``step`` [s]."""
    tower = np.array([[0.0, share * wind.hub_height_m] for share in TOWER_SHARES])
    points = np.vstack([_disc(wind.hub_height_m, radius), tower])
    fluctuation = turbulence(wind, points, duration=duration, sample_rate_hz=1.0 / step, seed=seed)
    return RotorWind(wind, fluctuation, step, radius)


def _disc(hub_height: float, radius: float) -> FloatArray:
    """Return (y, z) of the hub and the rings; spoke 0 points up, the next as the rotor turns."""
    angle = 2.0 * np.pi * np.arange(SPOKES) / SPOKES
    rings = [radius * share * np.stack([-np.sin(angle), np.cos(angle)], axis=1) for share in RINGS]
    return np.asarray(np.vstack([np.zeros((1, 2)), *rings]) + [0.0, hub_height])
