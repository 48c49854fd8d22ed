r"""Forces that nobody measured, as Gaussian processes on patterns of load.

A force is a pattern on the structure times a process of unit variance times a level that the record decides.
Gusts are an Ornstein–Uhlenbeck process, whose density falls with :math:`f^{-2}` above its corner as a rotor's
share of turbulence does; waves are a band about their peak that is nothing at rest and falls with
f⁻⁶, as short waves do not reach down:

.. math:: S_{gust}(ω) = \frac{2a}{a^2 + ω^2}, \qquad
          S_{wave}(ω) ∝ \frac{ω^2}{(ω_p^2 - ω^2)^2 + (2ζω_pω)^2} \, \frac{1}{(b^2 + ω^2)^2}

(two-sided, :math:`∫ S\,dω/2π = 1`; Särkkä & Solin 2019, sections 12.3 and 12.5). Both are states of linear
equations driven by white noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, sin, sqrt
from typing import Literal

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.loads import Coefficients, loads_along, morison_points, point_forces, wave_number, wetness
from jackettwin.response import nodal_load
from jackettwin.structure import Assembly

_INTEGRAL_SCALE_M = 340.2
"""8.1 Λ₁ of hubs above 60 m, IEC 61400-1 (2019) annex C."""
_USUAL_WIND_M_S = 10.0
_BAND = 0.25
"""Damping ratio that makes a band as wide as a wind sea's."""
_TAIL = 1.5
"""Beyond which multiple of its peak a sea's band falls twice as fast."""
_PASSED = _TAIL**3 * (_TAIL + _BAND) / (_TAIL**2 + 2.0 * _BAND * _TAIL + 1.0) ** 2
"""Share of a band's variance that its tail leaves."""
_SPACING_M = 4.0
_USUAL_HEIGHT_M, _USUAL_PERIOD_S = 1.5, 7.0
_ACROSS = 0.5
"""Of a sea that spreads as cos² about its mean direction, across it over along it, a little less."""
_KNOWN, _UNKNOWN = 0.3, 1.5
"""Of the logarithm of a sea's level, whose height is stated or not."""
_QUICK = 25.0
"""How much quicker the quick gusts are: two processes make Kaimal's f^(-5/3) within a factor of 1.6."""
_TOP = {0: "Fx", 1: "Fy", 3: "Mx", 4: "My", 5: "Mz"}
_TOWER = "tower"


@dataclass(frozen=True)
class LatentForce:
    """A pattern of load with an unknown history.

    Attributes
    ----------
    name : str
    load : (n_dof,) on the assembly's DOFs per unit of the process
    along : (n_elements, 12) what of it acts along elements, as loads on their ends in local axes
    kind : "gust" or "wave"
    rate : corner a or peak ω_p [rad/s]
    level : standard deviation of the process that multiplies the pattern: what to expect, then what was found
    level_log_std, rate_log_std : how far the logarithms of level and rate may lie from what is expected
    """

    name: str
    load: FloatArray
    along: FloatArray
    kind: Literal["gust", "wave"]
    rate: float
    level: float = 1.0
    level_log_std: float = 3.0
    rate_log_std: float = 0.2

    def dynamics(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return A (s, s), the density G Gᵀ (s, s) of the noise that drives it, and h (s,): f = h x."""
        a = self.rate
        if self.kind == "gust":
            return np.array([[-a]]), np.array([[2.0 * a]]), np.array([self.level])
        b = _TAIL * a
        A = np.zeros((4, 4))
        A[0, 1], A[1, :2] = a, (-a, -2.0 * _BAND * a)
        A[2, 1:3], A[3, 2:4] = (b, -b), (b, -b)
        return (
            A,
            np.diag([0.0, 4.0 * _BAND * a, 0.0, 0.0]),
            np.array([0.0, 0.0, 0.0, self.level / sqrt(_PASSED)]),
        )

    def density(self, omega: FloatArray) -> FloatArray:
        """Return the two-sided density S(ω) (n,) [1/Hz] of the process, its level included."""
        a, square = self.rate, self.level**2
        if self.kind == "gust":
            return np.asarray(square * 2.0 * a / (a**2 + omega**2))
        x = omega / a
        width = 2.0 * _BAND
        band = 2.0 * width * x**2 / ((1.0 - x**2) ** 2 + (width * x) ** 2) / a
        return np.asarray(square / _PASSED * band * (_TAIL**2 / (_TAIL**2 + x**2)) ** 2)

    def with_level(self, level: float, rate: float | None = None) -> LatentForce:
        """Return the force at another level, and another corner or peak."""
        return replace(self, level=level, rate=self.rate if rate is None else rate)


def gust_corner(wind_m_s: float | None) -> float:
    """Return the corner a [rad/s] of gusts in a mean wind: U/6L of Kaimal's spectrum, IEC 61400-1 (C.14)."""
    return 2.0 * pi * (_USUAL_WIND_M_S if wind_m_s is None else wind_m_s) / (6.0 * _INTEGRAL_SCALE_M)


def wind_forces(assembly: Assembly, *, wind_m_s: float | None = None) -> tuple[LatentForce, ...]:
    """Return the wind's forces and moments on the tower top and its drag along the tower.

    Each pattern has slow gusts and quick ones, whose levels the record tells apart: together they fall as
    slowly with frequency as turbulence does, or as fast as what a rotor lets through.
    """
    corner, nothing = gust_corner(wind_m_s), np.zeros((assembly.mesh.start.size, 12))
    patterns = {f"rotor {name}": _on_top(assembly, k) for k, name in _TOP.items()}
    patterns |= {f"tower {'xy'[k]}": load for k, load in enumerate(_on_tower(assembly))}
    return tuple(
        LatentForce(f"{name}, {kind}", load, nothing, "gust", corner * times, _usual(name), 3.0, std)
        for kind, times, std in (("slow", 1.0, 0.2), ("quick", _QUICK, 1.0))
        for name, load in patterns.items()
    )


def _on_top(assembly: Assembly, component: int) -> FloatArray:
    return nodal_load(assembly, {assembly.structure.top_node: tuple(np.eye(6)[component])})


def _on_tower(assembly: Assembly) -> tuple[FloatArray, ...]:
    """Return the drag (n_dof,) of unit wind along x and along y on the tower; nothing without one."""
    others = tuple({m.part for m in assembly.structure.members} - {_TOWER})
    if all(m.part != _TOWER for m in assembly.structure.members):
        return ()
    grid = morison_points(assembly, lowest_z=0.0, spacing=_SPACING_M, exclude_parts=others)
    still = np.zeros_like(grid.points)
    return tuple(
        np.asarray(grid.N @ point_forces(grid, still + unit, still).ravel()) for unit in np.eye(3)[:2]
    )


def wave_forces(
    assembly: Assembly,
    *,
    height_m: float | None = None,
    period_s: float | None = None,
    direction_rad: float = 0.0,
    depth_m: float | None = None,
    coefficients: Coefficients | None = None,
) -> tuple[LatentForce, ...]:
    """Return a sea's forces: along and across its direction, at crests and between them.

    The inertia force of a regular wave of the peak period and unit acceleration at the surface acts on all
    members at the phase of their place, so that legs that stand half a wave apart are pushed apart.

    Raises
    ------
    InputError
        If no tube reaches into the water.
    """
    structure = assembly.structure
    depth = depth_m or structure.sea_level_z_m - min(z for _, _, z in structure.nodes.values())
    grid = morison_points(
        assembly, highest_z=0.0, lowest_z=-depth, coefficients=coefficients, spacing=_SPACING_M
    )
    omega = 2.0 * pi / (period_s or _USUAL_PERIOD_S)
    # of the water's acceleration at the surface, σ = ω_p² Hs/4
    level = omega**2 * (height_m or _USUAL_HEIGHT_M) / 4.0
    k = float(wave_number(omega, depth))
    wet = wetness(grid, np.zeros(grid.weight.size))
    z = np.minimum(grid.points[:, 2], 0.0)
    across, up = np.cosh(k * (z + depth)) / np.sinh(k * depth), np.sinh(k * (z + depth)) / np.sinh(k * depth)
    spread, found = loads_along(assembly, grid), []
    for angle, way, share in ((direction_rad, "along", 1.0), (direction_rad + 0.5 * pi, "across", _ACROSS)):
        d = np.array([cos(angle), sin(angle), 0.0])
        phase = k * (grid.points @ d)
        for turn, place in ((0.0, "between crests"), (0.5 * pi, "at crests")):
            acceleration = np.outer(across * np.cos(phase + turn), d)
            acceleration[:, 2] = up * np.sin(phase + turn)
            forces = point_forces(grid, np.zeros_like(acceleration), acceleration, wet=wet)
            load = np.asarray(grid.N @ forces.ravel())
            beside = np.asarray(spread @ forces.ravel()).reshape(-1, 12)
            std = _KNOWN if height_m else _UNKNOWN
            name = f"waves {way}, {place}"
            found.append(LatentForce(name, load, beside, "wave", omega, share * level, std))
    return tuple(found)


def _usual(name: str) -> float:
    """Return a level to start from [N, N·m], or the wind's variance times its mean on a tower [m²/s²]."""
    return 10.0 if name.startswith(_TOWER) else 1e6 if " M" in name else 1e5
