"""Shapes of soil reaction curves: reaction per metre of pile against displacement, odd about zero."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from jackettwin.arrays import FloatArray


class Curve(Protocol):
    """A reaction p(y); p-y and t-z in N/m per m of pile, q-z in N."""

    @property
    def initial_stiffness(self) -> float:
        """Slope the curve starts with [N/m² or N/m]."""
        ...

    @property
    def capacity(self) -> float:
        """Largest reaction [N/m or N]."""
        ...

    def force(self, y: FloatArray | float) -> FloatArray:
        """Return the reaction at displacement ``y`` [m]."""
        ...


@dataclass(frozen=True)
class Tanh:
    """p = P tanh(k y / P)."""

    capacity: float
    initial_stiffness: float

    def force(self, y: FloatArray | float) -> FloatArray:
        """Return the reaction at displacement ``y`` [m]."""
        y = np.asarray(y, dtype=np.float64)
        if self.capacity == 0.0:
            return np.zeros_like(y)
        return np.asarray(self.capacity * np.tanh(self.initial_stiffness * y / self.capacity))


@dataclass(frozen=True)
class TabulatedCurve:
    """Straight lines between points that start at the origin, constant beyond the last."""

    y: tuple[float, ...]
    p: tuple[float, ...]

    @property
    def initial_stiffness(self) -> float:
        """Slope of the first line."""
        return self.p[1] / self.y[1]

    @property
    def capacity(self) -> float:
        """The peak."""
        return max(self.p)

    def force(self, y: FloatArray | float) -> FloatArray:
        """Return the reaction at displacement ``y`` [m]."""
        y = np.asarray(y, dtype=np.float64)
        return np.asarray(np.sign(y) * np.interp(np.abs(y), self.y, self.p))


@dataclass(frozen=True)
class CubeRoot:
    """p = ½ pu (y/y50)^⅓ up to pu; its slope at zero is infinite, so the initial stiffness is given."""

    capacity: float
    y50: float
    initial_stiffness: float

    def force(self, y: FloatArray | float) -> FloatArray:
        """Return the reaction at displacement ``y`` [m]."""
        y = np.asarray(y, dtype=np.float64)
        return np.asarray(np.sign(y) * np.minimum(0.5 * np.cbrt(np.abs(y) / self.y50), 1.0) * self.capacity)


@dataclass(frozen=True)
class ScaledCurve:
    """A curve whose reaction is ``factor`` times another's at the same displacement."""

    of: Curve
    factor: float

    @property
    def initial_stiffness(self) -> float:
        """The other's, times the factor."""
        return self.factor * self.of.initial_stiffness

    @property
    def capacity(self) -> float:
        """The other's, times the factor."""
        return self.factor * self.of.capacity

    def force(self, y: FloatArray | float) -> FloatArray:
        """Return the reaction at displacement ``y`` [m]."""
        return np.asarray(self.factor * self.of.force(y))


NOTHING = TabulatedCurve((0.0, 1.0), (0.0, 0.0))
"""The curve of ground that is not there."""


def secant_stiffness(curve: Curve, y: FloatArray | float) -> FloatArray:
    """Return p(y)/y, the initial stiffness where y is zero [N/m² or N/m]."""
    y = np.abs(np.asarray(y, dtype=np.float64))
    moving = y > 1e-12
    return np.where(moving, curve.force(y) / np.where(moving, y, 1.0), curve.initial_stiffness)


def force_and_tangent(curve: Curve, y: float) -> tuple[float, float]:
    """Return p(y), and dp/dy by central differences over a millionth of y [m], at least a nanometre."""
    h = max(1e-6 * abs(y), 1e-9)
    here, ahead, behind = curve.force(np.array([y, y + h, y - h]))
    return float(here), float(ahead - behind) / (2.0 * h)
