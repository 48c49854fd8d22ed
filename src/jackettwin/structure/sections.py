"""Section properties of circular tubes and of rectangular beams."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.structure.two_node import BeamSection


class TubeProperties(NamedTuple):
    """Area A [m²], second moment I about a diameter, torsion constant J = 2I [m⁴], shear coefficient κ."""

    A: FloatArray
    I: FloatArray  # noqa: E741 - the symbol of the textbooks
    J: FloatArray
    kappa: FloatArray


def tube_properties(D: FloatArray, t: FloatArray, nu: FloatArray | float = 0.3) -> TubeProperties:
    """Return the section properties of tubes with outer diameter ``D`` and wall ``t`` [m], any shape.

    κ is the shear coefficient of a hollow circle that SubDyn uses (Steinboeck, Saxinger & Kugi 2013):
    ``κ = 6(1+ν)²(1+m²)² / ((1+m²)²(7+14ν+8ν²) + 4m²(5+10ν+4ν²))``, m the ratio of the radii.

    >>> round(float(tube_properties(np.array(2.0), np.array(1.0)).A), 6)  # a solid circle of radius 1
    3.141593
    """
    d = D - 2.0 * t
    A = 0.25 * np.pi * (D**2 - d**2)
    I = np.pi / 64.0 * (D**4 - d**4)  # noqa: E741
    m2 = (d / D) ** 2
    nu = np.asarray(nu, dtype=np.float64)
    kappa = (6.0 * (1.0 + nu) ** 2 * (1.0 + m2) ** 2) / (
        (1.0 + m2) ** 2 * (7.0 + 14.0 * nu + 8.0 * nu**2) + 4.0 * m2 * (5.0 + 10.0 * nu + 4.0 * nu**2)
    )
    return TubeProperties(A, I, 2.0 * I, kappa)


def rectangular_section(a: float, b: float, t: float, *, poisson_ratio: float) -> BeamSection:
    """Return the section of a rectangle, ``a`` along its x, ``b`` along its y; the wall ``t`` of 0 is solid.

    Shear: Cowper (1966, J. Appl. Mech. 33:335), solid 10(1 + ν)/(12 + 11ν). Torsion: Roark's formulas for
    stress and strain, table 10.1, cases 4 and 16. Of solid ones SubDyn's printed frequencies tell both.

    Raises
    ------
    InputError
        If a side is not positive, or the walls fill the section.

    Examples
    --------
    >>> section = rectangular_section(2.0, 1.0, 0.0, poisson_ratio=0.3)
    >>> section.A, round(section.I_x, 4), round(section.I_y, 4), round(section.J, 4)
    (2.0, 0.1667, 0.6667, 0.4578)
    """
    if not (min(a, b) > 0.0 and 0.0 <= t < 0.5 * min(a, b)):
        raise InputError(
            "not a rectangle",
            field="XsecSa, XsecSb, XsecT",
            value=[a, b, t],
            allowed="sides > 0, a wall of 0 (solid) or below half the shorter side",
        )
    inner = (a - 2.0 * t, b - 2.0 * t) if t > 0.0 else (0.0, 0.0)
    A = a * b - inner[0] * inner[1]
    I_x = (a * b**3 - inner[0] * inner[1] ** 3) / 12.0
    I_y = (b * a**3 - inner[1] * inner[0] ** 3) / 12.0
    if t == 0.0:
        kappa = 10.0 * (1.0 + poisson_ratio) / (12.0 + 11.0 * poisson_ratio)
        return BeamSection(A, kappa * A, kappa * A, I_x, I_y, I_x + I_y, _solid_torsion(a, b))
    J = 2.0 * t * (a - t) ** 2 * (b - t) ** 2 / (a + b - 2.0 * t)
    along_x, along_y = (_box_shear(h, w, poisson_ratio) for h, w in ((a - t, b - t), (b - t, a - t)))
    return BeamSection(A, along_x * A, along_y * A, I_x, I_y, I_x + I_y, J)


def i_section(width: float, height: float, flange: float, web: float) -> BeamSection:
    """Return an I of two equal flanges, ``width`` along its x and ``height`` overall along its y [m].

    Torsion: Σ b t³/3 of its plates, free to warp. Shear along y is the web's between the flanges' middles,
    along x 5/6 of the flanges.

    Examples
    --------
    >>> section = i_section(0.3, 0.6, 0.03, 0.015)
    >>> round(section.A, 4), round(section.I_x, 6), round(section.I_y, 6), round(section.J * 1e6, 3)
    (0.0261, 0.00166, 0.000135, 6.007)
    """
    h = height - 2.0 * flange
    A = 2.0 * width * flange + h * web
    I_x = (width * height**3 - (width - web) * h**3) / 12.0
    I_y = (2.0 * flange * width**3 + h * web**3) / 12.0
    J = (2.0 * width * flange**3 + h * web**3) / 3.0
    return BeamSection(A, 5.0 / 3.0 * width * flange, (height - flange) * web, I_x, I_y, I_x + I_y, J)


def _solid_torsion(a: float, b: float) -> float:
    long, short = 0.5 * max(a, b), 0.5 * min(a, b)
    share = short / long
    return long * short**3 * (16.0 / 3.0 - 3.36 * share * (1.0 - share**4 / 12.0))


def _box_shear(h: float, w: float, nu: float) -> float:
    """Return Cowper's coefficient of a thin box of even wall, ``h`` along the shear, ``w`` across it."""
    m = n = w / h
    below = 12.0 + 72.0 * m + 150.0 * m**2 + 90.0 * m**3
    below += nu * (11.0 + 66.0 * m + 135.0 * m**2 + 90.0 * m**3)
    below += 10.0 * n**2 * ((3.0 + nu) * m + 3.0 * m**2)
    return 10.0 * (1.0 + nu) * (1.0 + 3.0 * m) ** 2 / below
