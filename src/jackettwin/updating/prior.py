"""Priors of the parameters: densities of z = ln θ between bounds."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt
from typing import Protocol

import numpy as np
from scipy.special import ndtr, ndtri

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.soil import Parameter


class Prior(Protocol):
    """A density of z = ln θ between bounds."""

    @property
    def low(self) -> FloatArray:
        """Lower bounds of z, (d,)."""

    @property
    def high(self) -> FloatArray:
        """Upper bounds of z, (d,)."""

    @property
    def std(self) -> FloatArray:
        """Standard deviation of each z, (d,)."""

    def draw(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Return draws (n, d)."""

    def from_unit(self, u: FloatArray) -> FloatArray:
        """Return the z of independent uniform numbers u (..., d)."""

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return ln p (n,) of points (n, d); −inf outside the bounds."""

    def rows(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the non-uniform part of −2 ln p at a point (d,) as squared residuals, and their Jacobian."""


@dataclass(frozen=True)
class BoxPrior:
    """Independent priors: uniform between two bounds, or normal and truncated at them.

    Attributes
    ----------
    low, high : (d,) bounds of z
    mean, scale : (d,) mean and standard deviation of the untruncated normal; scale is inf for a uniform prior
    """

    low: FloatArray
    high: FloatArray
    mean: FloatArray
    scale: FloatArray

    @classmethod
    def of(cls, parameters: tuple[Parameter, ...]) -> BoxPrior:
        """Return the prior of parameters."""
        low, high = (np.log([getattr(p, side) for p in parameters]) for side in ("low", "high"))
        mean = np.log([1.0 if p.median is None else p.median for p in parameters])
        return cls(low, high, mean, np.array([p.log_std or np.inf for p in parameters]))

    @property
    def _flat(self) -> BoolArray:
        return np.isinf(self.scale)

    def _standard(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the bounds in standard deviations from the mean, and the mass between them."""
        scale = np.where(self._flat, 1.0, self.scale)
        a, b = (self.low - self.mean) / scale, (self.high - self.mean) / scale
        return a, b, ndtr(b) - ndtr(a)

    @property
    def std(self) -> FloatArray:
        """Standard deviation of each z: width over √12 of a uniform prior, or that of a truncated normal."""
        a, b, mass = self._standard()
        phi_a, phi_b = (np.exp(-0.5 * t * t) / sqrt(2.0 * pi) for t in (a, b))
        with np.errstate(divide="ignore", invalid="ignore"):
            shift = (phi_a - phi_b) / mass
            cut = self.scale * np.sqrt(1.0 + (a * phi_a - b * phi_b) / mass - shift**2)
        return np.where(self._flat, (self.high - self.low) / sqrt(12.0), cut)

    def draw(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Return draws (n, d)."""
        return self.from_unit(rng.random((n, self.low.size)))

    def from_unit(self, u: FloatArray) -> FloatArray:
        """Return the z whose cumulative probabilities are u (..., d)."""
        a, _, mass = self._standard()
        with np.errstate(invalid="ignore"):
            normal = self.mean + self.scale * ndtri(ndtr(a) + u * mass)
        z = np.where(self._flat, self.low + (self.high - self.low) * u, normal)
        return np.clip(z, self.low, self.high)

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return ln p (n,) of points (n, d); −inf outside the bounds."""
        inside = np.all((z >= self.low) & (z <= self.high), axis=1)
        return np.where(inside, self.log_densities(z).sum(axis=1), -np.inf)

    def log_densities(self, z: FloatArray) -> FloatArray:
        """Return ln p of every coordinate (n, d) of points between the bounds."""
        _, _, mass = self._standard()
        scale = np.where(self._flat, 1.0, self.scale)
        normal = -0.5 * ((z - self.mean) / scale) ** 2 - np.log(scale * np.maximum(mass, 1e-300))
        return np.where(self._flat, -np.log(self.high - self.low), normal - 0.5 * log(2.0 * pi))

    def rows(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the normal priors as residuals (n_normal,) and their Jacobian (n_normal, d)."""
        normal = ~self._flat
        return ((z - self.mean) / self.scale)[normal], np.diag(1.0 / self.scale)[normal]
