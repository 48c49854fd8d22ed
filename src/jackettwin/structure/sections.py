"""Properties of circular tubes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray


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
