"""Current: a horizontal flow that depends on the depth only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray


@dataclass(frozen=True)
class Current:
    """Wind-driven and sub-surface current, IEC 61400-3-1 (2019) section 6.4.4.

    The sub-surface part follows (1 + z/d)^(1/7), the wind-driven part decreases linearly to zero at 20 m
    depth, and the uniform part is constant. Speeds [m/s] are those at still water, the heading is from +x
    [rad].
    """

    depth: float
    subsurface_m_s: float = 0.0
    wind_driven_m_s: float = 0.0
    direction: float = 0.0
    uniform_m_s: float = 0.0

    def velocity(self, z: FloatArray) -> FloatArray:
        """Return (n, 3) [m/s] at heights ``z`` from still water; above it, the velocity at the surface."""
        z = np.minimum(z, 0.0)
        speed = self.uniform_m_s + self.subsurface_m_s * np.maximum(1.0 + z / self.depth, 0.0) ** (1.0 / 7.0)
        speed = speed + self.wind_driven_m_s * np.maximum(1.0 + z / 20.0, 0.0)
        heading = np.array([np.cos(self.direction), np.sin(self.direction), 0.0])
        return np.asarray(speed[:, None] * heading)
