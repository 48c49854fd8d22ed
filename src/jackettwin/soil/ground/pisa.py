r"""Reaction curves of stocky piles, the PISA form: force and moment along the shaft, both at the base.

Each is a conic of Byrne et al. (2020, Géotechnique 70:1030) in normalised displacement x and reaction y,

.. math:: -n\Big(\frac{y}{y_u}-\frac{x}{x_u}\Big)^2 + (1-n)\Big(\frac{y}{y_u}-\frac{kx}{y_u}\Big)
   \Big(\frac{y}{y_u}-1\Big) = 0, \qquad y = y_u \text{ beyond } x_u,

with parameters that vary over the depth z/D or z/L, or the pile's L/D: of Cowden till (the same paper) and of
dense Dunkirk sand at a relative density D_R (Burd et al. 2020, Géotechnique 70:1048). Displacements are
normalised by D s_u/G₀ and D σ'_v/G₀, rotations by s_u/G₀ and σ'_v/G₀; forces per length by s_u D and σ'_v D,
moments per length by s_u D² and |p| D, at the base by s_u D², s_u D³ and σ'_v D², σ'_v D³.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import exp

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.soil.ground.profile import Clay, Point, Sand

_LEAST = 1e-3
"""Of stiffness and strength factors, which fall with depth: the fits end where they would be negative."""


@dataclass(frozen=True)
class Conic:
    """A conic of stiffness k, curvature n, ultimate (x_u, y_u), and scales of displacement and reaction."""

    k: float
    n: float
    x_u: float
    y_u: float
    x_scale: float
    y_scale: float

    @property
    def initial_stiffness(self) -> float:
        """Slope the curve starts with."""
        return self.k * self.y_scale / self.x_scale if self.y_scale > 0.0 else 0.0

    @property
    def capacity(self) -> float:
        """Largest reaction."""
        return self.y_u * self.y_scale

    def force(self, y: FloatArray | float) -> FloatArray:
        """Return the reaction at a displacement [m] or rotation [rad]."""
        moved = np.asarray(y, dtype=np.float64)
        if self.y_scale == 0.0:
            return np.zeros_like(moved)
        x = np.minimum(np.abs(moved) / self.x_scale, self.x_u)
        X, K = x / self.x_u, self.k * x / self.y_u
        a, b = 1.0 - 2.0 * self.n, 2.0 * self.n * X - (1.0 - self.n) * (1.0 + K)
        c = (1.0 - self.n) * K - self.n * X**2
        root = np.sqrt(np.maximum(b**2 - 4.0 * a * c, 0.0))
        # one root in two forms, each where it loses no digits
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(b < 0.0, 2.0 * c / (root - b), -(b + root) / (2.0 * a or np.nan))
        return np.asarray(np.sign(moved) * self.capacity * np.where(X >= 1.0, 1.0, share))


@dataclass(frozen=True)
class StockyGround:
    """Ground at one depth of a stocky pile of diameter D and length L in the ground [m]."""

    point: Point
    D: float
    L: float

    def __post_init__(self) -> None:
        soil = self.point.soil
        missing = "shear_modulus_pa" if self.point.shear_modulus_pa <= 0.0 else None
        if isinstance(soil, Sand) and soil.relative_density is None:
            missing = "relative_density"
        if missing is not None:
            raise InputError(
                "PISA's curves need it of every layer",
                field=missing,
                remedy=f"give {missing}, or take others",
            )

    def _conic(
        self, stress: float, k: float, n: float, x_u: float, y_u: float, *, x: float, y: float
    ) -> Conic:
        shape = max(k, _LEAST), float(np.clip(n, 0.0, 1.0)), x_u, max(y_u, _LEAST)
        return Conic(*shape, x * stress / self.point.shear_modulus_pa, y * stress)

    @property
    def lateral(self) -> Conic:
        """Force per length against displacement [N/m]."""
        z, D, L = self.point.depth_m, self.D, self.L
        if isinstance(self.point.soil, Clay):
            y_u = 10.7 - 7.101 * exp(-0.3085 * z / D)
            shape = 10.6 - 1.650 * z / D, 0.9390 - 0.03345 * z / D, 241.4, y_u
            return self._conic(self.point.strength_pa, *shape, x=D, y=D)
        d = self._density
        y_u = 0.3667 + 25.89 * d + (0.3375 - 8.900 * d) * z / L
        shape = 8.731 - 0.6982 * d - 0.9178 * z / D, 0.9170 + 0.06193 * d, 146.1 - 92.11 * d, y_u
        return self._conic(self.point.stress_pa, *shape, x=D, y=D)

    @property
    def moment(self) -> Conic:
        """Moment per length against rotation [N]; in sand for each N/m of lateral force."""
        z, D, L = self.point.depth_m, self.D, self.L
        if isinstance(self.point.soil, Clay):
            k, y_u = 1.420 - 0.09643 * z / D, 0.2899 - 0.04775 * z / D
            k, y_u = max(k, _LEAST), max(y_u, _LEAST)
            return self._conic(self.point.strength_pa, k, 0.0, y_u / k, y_u, x=1.0, y=D**2)
        k, y_u = 17.0, max(0.2605 - (0.1989 - 0.2019 * self._density) * z / L, _LEAST)
        return Conic(k, 0.0, y_u / k, y_u, max(self.point.stress_pa, 1.0) / self.point.shear_modulus_pa, D)

    @property
    def moment_grows_with_force(self) -> bool:
        """Whether ``moment`` is for each N/m of lateral force."""
        return isinstance(self.point.soil, Sand)

    @property
    def base_shear(self) -> Conic:
        """Shear under the tip against its displacement [N]."""
        D, slender = self.D, self.L / self.D
        if isinstance(self.point.soil, Clay):
            shape = 2.717 - 0.3575 * slender, 0.8793 - 0.03150 * slender, 235.7, 0.4038 + 0.04812 * slender
            return self._conic(self.point.strength_pa, *shape, x=D, y=D**2)
        d = self._density
        k = 6.505 - 2.985 * d - (0.007969 + 0.4299 * d) * slender
        n = 0.09978 + 0.7974 * d + (0.004994 - 0.07005 * d) * slender
        x_u = 0.5150 + 2.883 * d + (0.1695 - 0.7018 * d) * slender
        y_u = 0.09952 + 0.7996 * d + (0.03988 - 0.1606 * d) * slender
        return self._conic(self.point.stress_pa, k, n, max(x_u, _LEAST), y_u, x=D, y=D**2)

    @property
    def base_moment(self) -> Conic:
        """Moment under the tip against its rotation [N·m]."""
        D, slender = self.D, self.L / self.D
        if isinstance(self.point.soil, Clay):
            k, n, y_u = 0.2146 - 0.002132 * slender, 1.079 - 0.1087 * slender, 0.8192 - 0.08588 * slender
            return self._conic(self.point.strength_pa, k, n, 173.1, y_u, x=1.0, y=D**3)
        d = self._density
        y_u = 0.09981 + 0.3710 * d + (0.01998 - 0.09041 * d) * slender
        return self._conic(self.point.stress_pa, 0.3515, 0.3 + 0.4986 * d, 44.89, y_u, x=1.0, y=D**3)

    @property
    def _density(self) -> float:
        soil = self.point.soil
        assert isinstance(soil, Sand) and soil.relative_density is not None
        return soil.relative_density
