r"""Unmeasured forces as Gaussian processes on load patterns.

A force is a pattern on the structure times a process of unit variance times a level that the record decides.
Gusts are an Ornstein–Uhlenbeck process, whose density falls with :math:`f^{-2}` above its corner; a rotor's
disc averages them, so that its force falls with f⁻⁴ above U/D, and not its moments. Waves are a band about
their peak that is nothing at rest and falls with f⁻⁶, as short waves do not reach down:

.. math:: S_{gust}(ω) = \frac{2a}{a^2 + ω^2}, \qquad
          S_{wave}(ω) ∝ \frac{ω^2}{(ω_p^2 - ω^2)^2 + (2ζω_pω)^2} \, \frac{1}{(b^2 + ω^2)(c^2 + ω^2)}

(two-sided, :math:`∫ S\,dω/2π = 1`; Särkkä & Solin 2019, sections 12.3 and 12.5). Both are states of linear
equations driven by white noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi, sqrt
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import AIR_KG_M3, TOWER_DRAG, Coefficients, morison_points, point_forces
from jackettwin.response import nodal_load
from jackettwin.structure import Assembly

_INTEGRAL_SCALE_M = 340.2
"""8.1 Λ₁ of hubs above 60 m, IEC 61400-1 (2019) annex C."""
_USUAL_WIND_M_S = 10.0
_APART = 1.05
"""Of the two corners of a band's tail from their mean: apart, so that each decays for itself."""
_SPACING_M = 4.0
_DISC_CORNER, _DISC = 0.62, 12.0
"""Lower corner of Kaimal's gusts averaged over a disc of 240 m over U/6L, and the upper one over the lower.

Of S(f) times the mean of the coherence exp(−12 √((fr/U)² + (0.12 r/L)²)) of all pairs of its points (IEC
61400-1 (2019), C.2): from 6 to 24 m/s the lower lies at 0.59 to 0.63 U/6L, the upper 10 to 16 times there."""
_PASSING, _PASSING_LOG_STD, _PASSING_WIDTH = 0.72, 0.3, 0.05
"""Moments at the passing frequency over slow ones, the deviation of its logarithm, and their band.

Three blades in Kaimal's gusts with that coherence, whose moment grows with the radius: 0.72 at 6 to 24 m/s,
of which half lies within 3 to 5 % of the frequency."""
_QUICK = 25.0
"""Ratio of the corners of quick and slow gusts: the two have Kaimal's f^(-5/3) within a factor of 1.6."""
_QUICK_SHARE, _QUICK_LOG_STD, _QUICK_RATE_LOG_STD = 0.3, 1.5, 0.3
"""Expected ratio of quick gusts to slow ones, and the deviations of its logarithm and of their corner's.

With a free corner the quick gusts fit what lies above 1 Hz and slow moments replace them: those were found
three times too large in a simulated record at work."""
_TOP = {
    0: ("rotor Fx", None),
    1: ("rotor Fy", None),
    3: ("rotor Mx", "rotor Fy"),
    4: ("rotor My", "rotor Fx"),
    5: ("rotor Mz", "rotor Fx"),
}
"""Rows of a rotor's load on the tower top, and the force beside which a moment is expected."""
_FORCE_N = 1e5
"""To start from; the record decides."""
_LEVER_M, _LEVER_LOG_STD = 20.0, 1.0
"""Of a rotor's moments over its forces: gusts across a disc of 150 to 240 m, a sixth of its radius."""
_THRUST_LOG_STD = 0.5
"""Of a working rotor's thrust, given how it damps: turbulence is not class B, a controller answers."""
_TURBULENCE, _GUSTS_LOG_STD = 0.14, 0.7
"""I_ref of class B (IEC 61400-1 (2019), eq. (10)): drag on a tower varies by 2Uσ in a wind that is stated."""
_TOWER = "tower"


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
    width, tail : of waves: damping ratio of the band, and the corner of what falls beyond it over its peak
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
            b = _DISC * a
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
            b = _DISC * a
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
    like : name of the force whose process they follow, each at its level
    load : (n_dof, n) of the patterns
    along : (n, n_elements, 12) what of them acts along elements
    """

    like: str
    load: FloatArray
    along: FloatArray


def with_thrust(forces: tuple[LatentForce, ...], level_n: Mapping[str, float]) -> tuple[LatentForce, ...]:
    """Return forces whose rotor is expected to push by so much; moments and quick gusts go with it.

    Parameters
    ----------
    level_n : {"rotor Fx", "rotor Fy"}: standard deviation of its slow gusts
    """
    named = {force.name: force for force in forces}

    def expected(force: LatentForce) -> LatentForce:
        root = force
        while root.beside is not None:
            root = named[root.beside]
        if root.name not in level_n:
            return force
        level = force.level * level_n[root.name] / root.level
        return replace(
            force, level=level, level_log_std=force.level_log_std if force.beside else _THRUST_LOG_STD
        )

    return tuple(expected(force) for force in forces)


def gusts_std(wind_m_s: float) -> float:
    """Return the standard deviation of the wind's speed [m/s]: IEC 61400-1 (2019), eq. (10), class B."""
    return _TURBULENCE * (0.75 * wind_m_s + 5.6)


def gust_corner(wind_m_s: float | None) -> float:
    """Return the corner a [rad/s] of gusts in a mean wind: U/6L of Kaimal's spectrum, IEC 61400-1 (C.14)."""
    return 2.0 * pi * (_USUAL_WIND_M_S if wind_m_s is None else wind_m_s) / (6.0 * _INTEGRAL_SCALE_M)


def wind_forces(assembly: Assembly, *, wind_m_s: float | None = None) -> tuple[LatentForce, ...]:
    """Return the wind's forces and moments on the tower top and its drag along the tower.

    Each pattern has slow gusts and quick ones, whose levels the record tells apart: together they fall as
    slowly with frequency as turbulence does, or as fast as what a rotor lets through. What sensors hardly
    tell apart is expected in proportion: a moment to its force, quick gusts to slow ones.
    """
    corner, nothing = gust_corner(wind_m_s), np.zeros((assembly.mesh.start.size, 12))
    speed = _USUAL_WIND_M_S if wind_m_s is None else wind_m_s
    gusts, known = (
        2.0 * speed * gusts_std(speed),
        3.0 if wind_m_s is None else _GUSTS_LOG_STD,
    )
    slow = []
    for row, (name, of) in _TOP.items():
        at = (_FORCE_N, 3.0, 0.2) if of is None else (_LEVER_M * _FORCE_N, _LEVER_LOG_STD, 0.2)
        # a disc averages the force, and not the gusts across it that make moments
        kind: Literal["gust", "disc"] = "disc" if of is None else "gust"
        rate = _DISC_CORNER * corner if of is None else corner
        slow.append(LatentForce(name, _on_top(assembly, row), nothing, kind, rate, *at, of))
    for axis, load in zip("xy", _on_tower(assembly), strict=False):
        slow.append(LatentForce(f"tower {axis}", load, nothing, "gust", corner, gusts, known))
    quick = [
        replace(
            f,
            name=f"{f.name}, quick",
            kind="gust",
            rate=_QUICK * corner,
            level=_QUICK_SHARE * f.level,
            level_log_std=_QUICK_LOG_STD,
            rate_log_std=_QUICK_RATE_LOG_STD,
            beside=f.name,
        )
        for f in slow
    ]
    return (*slow, *quick)


def passing_forces(forces: tuple[LatentForce, ...], passing_hz: float) -> tuple[LatentForce, ...]:
    """Return the moments of gusts that blades cut as they pass, beside the slow ones of the same rotor."""
    moments = {name for name, of in _TOP.values() if of is not None}
    return tuple(
        replace(
            f,
            name=f"{f.name}, passing",
            kind="wave",
            rate=2.0 * pi * passing_hz,
            level=_PASSING * f.level,
            level_log_std=_PASSING_LOG_STD,
            rate_log_std=0.05,
            beside=f.name,
            width=_PASSING_WIDTH,
        )
        for f in forces
        if f.name in moments
    )


def _on_top(assembly: Assembly, component: int) -> FloatArray:
    return nodal_load(assembly, {assembly.structure.top_node: tuple(np.eye(6)[component])})


def _on_tower(assembly: Assembly) -> tuple[FloatArray, ...]:
    """Return the drag (n_dof,) of unit wind along x and along y on the tower; nothing without one."""
    others = tuple({m.part for m in assembly.structure.members} - {_TOWER})
    if all(m.part != _TOWER for m in assembly.structure.members):
        return ()
    air = Coefficients(TOWER_DRAG, 0.0, 0.0, density_kg_m3=AIR_KG_M3)
    grid = morison_points(assembly, lowest_z=0.0, spacing=_SPACING_M, exclude_parts=others, coefficients=air)
    still = np.zeros_like(grid.points)
    return tuple(
        np.asarray(grid.N @ point_forces(grid, still + unit, still).ravel()) for unit in np.eye(3)[:2]
    )
