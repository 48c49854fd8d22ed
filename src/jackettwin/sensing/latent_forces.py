r"""Unmeasured forces as Gaussian processes on load patterns.

A force is a pattern on the structure times a process of unit variance times a level that the record decides.
Gusts are an Ornstein–Uhlenbeck process, whose density falls with :math:`f^{-2}` above its corner, or with f⁻⁴
above a second one where a rotor averages them. Waves are a band about their peak that is nothing at rest and
falls with f⁻⁶, as short waves do not reach down:

.. math:: S_{gust}(ω) = \frac{2a}{a^2 + ω^2}, \qquad
          S_{wave}(ω) ∝ \frac{ω^2}{(ω_p^2 - ω^2)^2 + (2ζω_pω)^2} \, \frac{1}{(b^2 + ω^2)(c^2 + ω^2)}

(two-sided, :math:`∫ S\,dω/2π = 1`; Särkkä & Solin 2019, sections 12.3 and 12.5). Both are states of linear
equations driven by white noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import exp, log, pi, sqrt
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray

_APART = 1.05
"""Of the two corners of a band's tail from their mean: apart, so that each decays for itself."""


@dataclass(frozen=True)
class LatentForce:
    """A pattern of load with an unknown history.

    Attributes
    ----------
    name : str
    load : (n_dof,) on the assembly's DOFs per unit of the process
    along : (n_elements, 12) what of it acts along elements, as loads on their ends in local axes
    kind : "gust", "disc" or "wave"
    rate : corner a or peak ω_p [rad/s]
    level : standard deviation of the process that multiplies the pattern: what to expect, then what was found
    level_log_std, rate_log_std : how far the logarithms of level and rate may lie from what is expected
    beside : name of another force, at whose level over its expected one this one's is expected, too
    shared_log_std : how far the levels of all forces of its band may lie away together, beside its own
    width : of waves: damping ratio of the band
    tail : corner of what falls beyond it over its peak; of a disc the upper corner over the lower one
    """

    name: str
    load: FloatArray
    along: FloatArray
    kind: Literal["gust", "disc", "wave"]
    rate: float
    level: float = 1.0
    level_log_std: float = 3.0
    rate_log_std: float = 0.2
    beside: str | None = None
    shared_log_std: float = 0.0
    width: float = 0.1
    tail: float = 1.5

    @property
    def _tail(self) -> tuple[float, float, float]:
        """Both corners of the tail over the peak, and the share of the band's variance that it leaves."""
        b, c = self.tail / _APART, self.tail * _APART
        rest = [1.0 / (x**2 + 2.0 * self.width * x + 1.0) for x in (b, c)]
        return b, c, b**2 * c**2 / (c**2 - b**2) * (rest[0] - rest[1])

    def dynamics(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return A (s, s), the density G Gᵀ (s, s) of the noise that drives it, and h (s,): f = h x."""
        a = self.rate
        if self.kind == "gust":
            return np.array([[-a]]), np.array([[2.0 * a]]), np.array([self.level])
        if self.kind == "disc":
            b = self.tail * a
            through = np.array([0.0, self.level * sqrt((a + b) / b)])
            return np.array([[-a, 0.0], [b, -b]]), np.diag([2.0 * a, 0.0]), through
        b, c, passed = self._tail
        A = np.zeros((4, 4))
        A[0, 1], A[1, :2] = a, (-a, -2.0 * self.width * a)
        A[2, 1:3], A[3, 2:4] = (b * a, -b * a), (c * a, -c * a)
        return (
            A,
            np.diag([0.0, 4.0 * self.width * a, 0.0, 0.0]),
            np.array([0.0, 0.0, 0.0, self.level / sqrt(passed)]),
        )

    def density(self, omega: FloatArray) -> FloatArray:
        """Return the two-sided density S(ω) (n,) [1/Hz] of the process, its level included."""
        a, square = self.rate, self.level**2
        if self.kind == "gust":
            return np.asarray(square * 2.0 * a / (a**2 + omega**2))
        if self.kind == "disc":
            b = self.tail * a
            return np.asarray(square * 2.0 * a * b * (a + b) / ((a**2 + omega**2) * (b**2 + omega**2)))
        x, (b, c, passed) = omega / a, self._tail
        width = 2.0 * self.width
        band = 2.0 * width * x**2 / ((1.0 - x**2) ** 2 + (width * x) ** 2) / a
        return np.asarray(square / passed * band * b**2 / (b**2 + x**2) * c**2 / (c**2 + x**2))

    def drawn(self, number: int, step_s: float, rng: np.random.Generator) -> FloatArray:
        """Return a history (number,) of the process."""
        omega = np.asarray(2.0 * pi * np.fft.rfftfreq(number, step_s), dtype=np.float64)
        size = np.sqrt(0.5 * number * self.density(omega) / step_s)
        return np.fft.irfft(size * (rng.standard_normal((2, omega.size)).T @ [1.0, 1j]), number)

    def with_level(self, level: float, rate: float | None = None) -> LatentForce:
        """Return the force at another level, and another corner or peak."""
        return replace(self, level=level, rate=self.rate if rate is None else rate)


@dataclass(frozen=True)
class LocalWaves:
    """What waves of a band do beside its principal patterns: they bend members and move no sensor.

    Attributes
    ----------
    beside : the band's principal patterns as they are expected, whose process they follow
    load : (n_dof, n) of the patterns
    along : (n, n_elements, 12) what of them acts along elements
    """

    beside: tuple[LatentForce, ...]
    load: FloatArray
    along: FloatArray

    def force(self, found: Mapping[str, LatentForce]) -> LatentForce:
        """Return their process at the level and rate that are likely beside those found of the patterns.

        What all of a band share of the n logarithms δ of levels over the expected ones is
        Σδ / (n + b²/s²), of independent deviations b and a shared one s.
        """
        first = self.beside[0]
        away = sum(log(found[force.name].level / force.level) for force in self.beside)
        own = (first.level_log_std / first.shared_log_std) ** 2
        return first.with_level(first.level * exp(away / (len(self.beside) + own)), found[first.name].rate)
