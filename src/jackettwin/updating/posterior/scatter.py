r"""Hierarchical prior of legs that scatter about a common mean, with the scatter marginalised.

The logarithms of d legs are :math:`z = \bar z + Qy` with orthonormal deviations y, :math:`y ∼ N(0, s^2 I)`,
and an unknown scatter s, :math:`s^2 ∼ ν s_0^2/χ^2_ν`. After marginalising s the deviations have a
multivariate Student distribution (Gelman et al. 2013, section 5),

.. math:: p(y) ∝ \left(1 + \frac{y^T y}{ν s_0^2}\right)^{-(ν + d - 1)/2},

and given y the scatter has the distribution :math:`s^2 ∼ (ν s_0^2 + y^T y)/χ^2_{ν + d - 1}`. The mean
:math:`\bar z` has the prior of one leg.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import lgamma, log, pi, sqrt

import numpy as np
import scipy  # scipy.stats is loaded where it is used: half a second
import scipy.linalg as la
from scipy.special import chdtri, stdtrit

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.intervals import QUANTILES
from jackettwin.updating.prior import BoxPrior, Prior

FREEDOM = 3.0
"""ν: one leg in ten scatters by more than 1.6 s₀, one in a hundred by more than 4.5 s₀."""
_REDRAWS = 20
_LOG2_POINTS = 12
"""Exponent of the number of Sobol points (2ⁿ) for the mass between bounds, whose error is about 1e-3."""


@dataclass(frozen=True)
class Legs:
    """One kind of parameter of all legs.

    Attributes
    ----------
    name : name of the parameter without that of the leg
    columns : (d,) indices of the legs in z
    scale : s₀
    """

    name: str
    columns: IntArray
    scale: float

    @property
    def Q(self) -> FloatArray:
        """Orthonormal basis (d, d − 1) of deviations from the mean of the legs."""
        return np.asarray(la.null_space(np.ones((1, self.columns.size))))

    def deviations(self, z: FloatArray) -> FloatArray:
        """Return y (n, d − 1) of points (n, n_parameters)."""
        return np.asarray(z[:, self.columns] @ self.Q)

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return ln p(y) (n,) of points (n, n_parameters)."""
        p = self.columns.size - 1
        q = (self.deviations(z) ** 2).sum(axis=1) / self.scale**2
        constant = lgamma(0.5 * (FREEDOM + p)) - lgamma(0.5 * FREEDOM)
        constant -= 0.5 * p * log(FREEDOM * pi * self.scale**2)
        return np.asarray(constant - 0.5 * (FREEDOM + p) * np.log1p(q / FREEDOM))

    def from_unit(self, u: FloatArray) -> FloatArray:
        """Return deviations of the legs (..., d) from their mean at probabilities u (..., d − 1).

        Given the previous components, each y is Student distributed with one more degree of freedom.
        """
        y = np.zeros_like(u)
        square = np.zeros(u.shape[:-1])
        for i in range(u.shape[-1]):
            freedom = FREEDOM + i
            width = np.sqrt((FREEDOM * self.scale**2 + square) / freedom)
            y[..., i] = width * stdtrit(freedom, np.clip(u[..., i], 1e-12, 1.0 - 1e-12))
            square = square + y[..., i] ** 2
        return np.asarray(y @ self.Q.T)

    def rows(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return residuals (d − 1,), squares adding up to −2 ln p(y) + constant, and their Jacobian by y."""
        y = z[self.columns] @ self.Q / self.scale
        q, power = float(y @ y), FREEDOM + y.size
        if q < 1e-8:
            weight, slope = power / FREEDOM, -0.5 * power / FREEDOM**2
        else:
            weight = power * np.log1p(q / FREEDOM) / q
            slope = (power / (FREEDOM + q) - weight) / q
        root = sqrt(weight)
        jacobian = root * np.eye(y.size) + slope / root * np.outer(y, y)
        return root * y, jacobian / self.scale

    def draw_scatter(self, z: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Return draws (n,) of the scatter s given the legs at points (n, n_parameters)."""
        y = self.deviations(z)
        square = FREEDOM * self.scale**2 + (y * y).sum(axis=1)
        return np.asarray(np.sqrt(square / rng.chisquare(FREEDOM + y.shape[1], len(z))))


@dataclass(frozen=True)
class ScatteredPrior:
    """Independent priors, except for legs that scatter about a common mean; truncated at the bounds.

    Attributes
    ----------
    box : BoxPrior
        Prior of each parameter; for legs it is that of their mean.
    legs : tuple of Legs
    """

    box: BoxPrior
    legs: tuple[Legs, ...]

    @property
    def low(self) -> FloatArray:
        """Lower bounds of z, (d,)."""
        return self.box.low

    @property
    def high(self) -> FloatArray:
        """Upper bounds of z, (d,)."""
        return self.box.high

    @property
    def std(self) -> FloatArray:
        """Standard deviation of each z, (d,)."""
        std = self.box.std.copy()
        for group in self.legs:
            apart = (1.0 - 1.0 / group.columns.size) * group.scale**2 * FREEDOM / (FREEDOM - 2.0)
            std[group.columns] = np.sqrt(std[group.columns] ** 2 + apart)
        return std

    def draw(self, n: int, rng: np.random.Generator) -> FloatArray:
        """Return draws (n, d)."""
        z = self._unbounded(rng.random((n, self.low.size)))
        for _ in range(_REDRAWS):
            outside = np.flatnonzero(np.any((z < self.low) | (z > self.high), axis=1))
            z[outside] = self._unbounded(rng.random((outside.size, self.low.size)))
        return np.clip(z, self.low, self.high)

    def from_unit(self, u: FloatArray) -> FloatArray:
        """Return the z of independent uniform numbers u (..., d), limited to the bounds."""
        return np.clip(self._unbounded(u), self.low, self.high)

    def _unbounded(self, u: FloatArray) -> FloatArray:
        """Return z; the first number of a group gives its mean, the others its deviations."""
        z = self.box.from_unit(u)
        for group in self.legs:
            first = z[..., group.columns[:1]]
            z[..., group.columns] = first + group.from_unit(u[..., group.columns[1:]])
        return z

    @cached_property
    def log_mass(self) -> float:
        """Logarithm of the probability that all legs are between the bounds if their mean is."""
        u = scipy.stats.qmc.Sobol(self.low.size, rng=0).random_base2(_LOG2_POINTS)
        z = self._unbounded(u)
        return log(float(np.mean(np.all((z >= self.low) & (z <= self.high), axis=1))))

    def log_density(self, z: FloatArray) -> FloatArray:
        """Return ln p (n,) of points (n, d); −inf outside the bounds."""
        centred, total = self._centred(z), np.zeros(len(z))
        alone = self.box.log_densities(centred)
        for group in self.legs:
            # the density of the mean replaces those of the legs; Q and 1/√d are orthonormal
            total += group.log_density(z) - 0.5 * log(group.columns.size)
            alone[:, group.columns[1:]] = 0.0
        total += alone.sum(axis=1)
        inside = np.all((z >= self.low) & (z <= self.high), axis=1)
        return np.where(inside, total - self.log_mass, -np.inf)

    def rows(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the priors as residuals (n,) and their Jacobian (n, d)."""
        normal = np.isfinite(self.box.scale)
        mean = np.eye(z.size)
        for group in self.legs:
            mean[np.ix_(group.columns, group.columns)] = 1.0 / group.columns.size
            normal[group.columns[1:]] = False
        values = [((mean @ z - self.box.mean) / self.box.scale)[normal]]
        jacobians = [(mean / self.box.scale[:, None])[normal]]
        for group in self.legs:
            value, by_y = group.rows(z)
            jacobian = np.zeros((value.size, z.size))
            jacobian[:, group.columns] = by_y @ group.Q.T
            values.append(value)
            jacobians.append(jacobian)
        return np.concatenate(values), np.concatenate(jacobians)

    def _centred(self, z: FloatArray) -> FloatArray:
        centred = z.copy()
        for group in self.legs:
            centred[:, group.columns] = z[:, group.columns].mean(axis=1, keepdims=True)
        return centred


@dataclass(frozen=True)
class Scatter:
    """Scatter of legs about their mean, as standard deviation of ln θ.

    Attributes
    ----------
    draws : (n,) draws from the posterior
    before : (low, high) 90 % interval of the prior
    """

    name: str
    draws: FloatArray
    before: tuple[float, float]


def leg_scatter(prior: Prior, z: FloatArray) -> tuple[Scatter, ...]:
    """Return the scatters for draws z (n, d) of the parameters; empty without legs.

    Examples
    --------
    >>> from jackettwin.updating.prior import BoxPrior
    >>> box = BoxPrior(np.full(2, -9.0), np.full(2, 9.0), np.zeros(2), np.full(2, np.inf))
    >>> legs = Legs("k", np.array([0, 1]), scale=0.3)
    >>> (found,) = leg_scatter(ScatteredPrior(box, (legs,)), np.zeros((2000, 2)))
    >>> [round(v, 2) for v in found.before], bool(np.median(found.draws) < 0.3)
    ([0.19, 0.88], True)
    """
    rng = np.random.default_rng(0)
    groups = prior.legs if isinstance(prior, ScatteredPrior) else ()
    found = []
    for group in groups:
        low, high = group.scale * np.sqrt(FREEDOM / chdtri(FREEDOM, QUANTILES[::2]))
        found.append(Scatter(group.name, group.draw_scatter(z, rng), (float(low), float(high))))
    return tuple(found)
