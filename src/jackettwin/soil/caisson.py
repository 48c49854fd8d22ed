r"""Static stiffness of a rigid suction caisson whose enclosed soil moves with it.

A rigid cylinder of radius R embedded by its skirt d in an elastic stratum of shear modulus G, Poisson's ratio
ν and depth H over rock, or a half-space (Kausel 1974 and Elsabee 1975, MIT, for sway, rocking and twist;
Kausel & Ushijima 1979 for heave; collected by Gazetas 1983, Soil Dyn. Earthq. Eng. 2:2, and in DNV-ST-0126):

.. math::

    K_H &= \frac{8GR}{2-ν}\Big(1+\frac{R}{2H}\Big)\Big(1+\frac{2d}{3R}\Big)\Big(1+\frac{5d}{4H}\Big), \qquad
    K_V = \frac{4GR}{1-ν}\Big(1+1.28\frac{R}{H}\Big)\Big(1+\frac{d}{2R}\Big)
          \Big(1+\big(0.85-0.28\frac{d}{R}\big)\frac{d/H}{1-d/H}\Big)

    K_R &= \frac{8GR^3}{3(1-ν)}\Big(1+\frac{R}{6H}\Big)\Big(1+\frac{2d}{R}\Big)\Big(1+\frac{0.7d}{H}\Big),
    \qquad K_{HR} = 0.4\,d\,K_H, \qquad K_T = \frac{16GR^3}{3}\Big(1+\frac{8d}{3R}\Big)

K_R and K_HR are about the centre of the base; they are moved to the lid at the mudline here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import require, require_between

DEEPEST = 2.0
"""Skirt over radius up to which the formulas hold (Gazetas 1983); a longer one is a pile."""


@dataclass(frozen=True)
class Caisson:
    """A caisson by diameter and skirt, in ground of one shear modulus; ``bedrock_m`` below the mudline."""

    diameter_m: float
    skirt_m: float
    shear_modulus_pa: float
    poisson_ratio: float = 0.5
    bedrock_m: float | None = None

    def __post_init__(self) -> None:
        require_between("diameter_m", self.diameter_m, 0.5, 100.0, "m")
        require_between("skirt_m", self.skirt_m, 0.0, 0.5 * DEEPEST * self.diameter_m, "m")
        require_between("shear_modulus_pa", self.shear_modulus_pa, 1e5, 1e11, "Pa")
        require_between("poisson_ratio", self.poisson_ratio, 0.0, 0.5)
        if self.bedrock_m is not None:
            require(
                self.bedrock_m >= 2.0 * max(self.skirt_m, 0.5 * self.diameter_m),
                "rock is too near",
                field="bedrock_m",
                value=self.bedrock_m,
                allowed="twice the skirt and a diameter, or more",
                remedy="leave it out, or take finite elements",
            )

    def stiffness(self) -> FloatArray:
        """Return the stiffness (6, 6) at the lid's centre: x, y, z [N/m], rotations about them [N·m/rad]."""
        G, nu, R, d = self.shear_modulus_pa, self.poisson_ratio, 0.5 * self.diameter_m, self.skirt_m
        near = 0.0 if self.bedrock_m is None else 1.0 / self.bedrock_m
        K_H = (
            8.0
            * G
            * R
            / (2.0 - nu)
            * (1.0 + 0.5 * R * near)
            * (1.0 + d / (1.5 * R))
            * (1.0 + 1.25 * d * near)
        )
        K_V = 4.0 * G * R / (1.0 - nu) * (1.0 + 1.28 * R * near) * (1.0 + 0.5 * d / R)
        K_V *= 1.0 + (0.85 - 0.28 * d / R) * d * near / (1.0 - d * near)
        K_R = 8.0 * G * R**3 / (3.0 * (1.0 - nu)) * (1.0 + R * near / 6.0) * (1.0 + 2.0 * d / R)
        K_R *= 1.0 + 0.7 * d * near
        K_T = 16.0 / 3.0 * G * R**3 * (1.0 + 8.0 * d / (3.0 * R))
        K = np.diag([K_H, K_H, K_V, K_R, K_R, K_T])
        # at the base: held at the lid's height the ground's push on the skirt acts 0.4 d above it
        K[0, 4] = K[4, 0] = 0.4 * d * K_H
        K[1, 3] = K[3, 1] = -0.4 * d * K_H
        up = np.eye(6)
        up[0, 4], up[1, 3] = -d, d
        # u_base = u_lid − d θ_y, v_base = v_lid + d θ_x
        return np.asarray(up.T @ K @ up)
