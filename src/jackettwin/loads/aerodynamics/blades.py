"""A blade as stations, each with position, chord, twist, and lift and drag over the angle of attack."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from jackettwin.arrays import FloatArray

ALPHA = np.radians(np.linspace(-180.0, 180.0, 1441))
"""Angles of attack of the tables [rad], in steps of a quarter degree."""


@dataclass(frozen=True)
class Polar:
    """Lift and drag of one airfoil: ``alpha`` (m,) [rad], ``cl`` and ``cd`` (m,)."""

    relative_thickness: float
    alpha: FloatArray
    cl: FloatArray
    cd: FloatArray


@dataclass(frozen=True)
class Blade:
    """Stations along a blade, arrays (n,); axes of the unpitched blade: x downwind, z to the tip.

    Attributes
    ----------
    z : distance along the blade axis from its root [m]
    prebend : offset along x [m], negative upwind
    chord, twist : [m], [rad]; positive twist turns the nose into the wind, as pitch does
    relative_thickness : thickness over chord
    weight : integration length of each station [m]
    cl, cd : (n, ALPHA.size) tables
    """

    z: FloatArray
    prebend: FloatArray
    chord: FloatArray
    twist: FloatArray
    relative_thickness: FloatArray
    weight: FloatArray
    cl: FloatArray
    cd: FloatArray

    def coefficients(self, alpha: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return (Cl, Cd) at angles of attack (..., n) [rad] in [−π, π]."""
        at = (alpha - ALPHA[0]) / (ALPHA[1] - ALPHA[0])
        low = np.clip(at.astype(np.intp), 0, ALPHA.size - 2)
        share = at - low
        station = np.arange(self.z.size)

        def look_up(table: FloatArray) -> FloatArray:
            return np.asarray(table[station, low] * (1.0 - share) + table[station, low + 1] * share)

        return look_up(self.cl), look_up(self.cd)


def blend_polars(polars: list[Polar], relative_thickness: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return tables (Cl, Cd), each (n, ALPHA.size), at the stations' relative thickness.

    Monotone cubics are used over the angle and over the thickness; linear interpolation over thickness or
    span would increase the drag of the thick root by up to 2 % and change its lift in stall. Polars of equal
    thickness (two cylinders) are averaged.
    """
    thickness, of = np.unique([polar.relative_thickness for polar in polars], return_inverse=True)
    inside = np.clip(relative_thickness, thickness[0], thickness[-1])

    def blended(key: str) -> FloatArray:
        each = np.array([_on_alpha(polar.alpha, getattr(polar, key)) for polar in polars])
        tables = np.array([each[of == k].mean(axis=0) for k in range(thickness.size)])
        if thickness.size == 1:
            return np.asarray(np.repeat(tables, inside.size, axis=0))
        return np.asarray(PchipInterpolator(thickness, tables, axis=0)(inside))

    return blended("cl"), blended("cd")


def stall_delay(
    cl: FloatArray,
    *,
    r: FloatArray,
    chord: FloatArray,
    relative_thickness: FloatArray,
    radius: float,
    tip_speed_ratio: float,
) -> FloatArray:
    """Return lift tables (n, ALPHA.size) with the rotation's stall delay, Du & Selig (1998, AIAA 98-0021).

    Cl + f (Cl_linear − Cl), f = (1.6 (c/r)/0.1267 · (1 − (c/r)^e)/(1 + (c/r)^e) − 1)/m, e = (R/r)/Λ with Λ =
    λ/√(1 + λ²); m and Cl_linear follow from a straight line through −5° to 5°. The correction is limited to
    0.25 and decreases to zero between 25° and 45°; drag and sections thicker than 0.7 are not corrected, as
    in the public OpenFAST model of the IEA 15 MW rotor.
    """
    linear = np.abs(ALPHA) <= np.radians(5.0)
    m, intercept = np.polyfit(ALPHA[linear], cl[:, linear].T, 1)
    e = radius / r * np.hypot(1.0, tip_speed_ratio) / tip_speed_ratio
    power = (chord / r) ** e
    lifting = relative_thickness < 0.7
    f = (1.6 * chord / r / 0.1267 * (1.0 - power) / (1.0 + power) - 1.0) / np.where(lifting, m, 1.0)
    change = (f * lifting)[:, None] * (m[:, None] * ALPHA + intercept[:, None] - cl)
    fade = np.clip((np.radians(45.0) - np.abs(ALPHA)) / np.radians(20.0), 0.0, 1.0)
    return np.asarray(cl + fade * np.clip(change, -0.25, 0.25))


def _on_alpha(alpha: FloatArray, value: FloatArray) -> FloatArray:
    return np.asarray(PchipInterpolator(alpha, value)(np.clip(ALPHA, alpha[0], alpha[-1])))
