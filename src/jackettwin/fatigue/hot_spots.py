r"""Hot-spot stress at eight points around a brace and around its chord.

From the brace's nominal stresses (axial, in-plane and out-of-plane bending) at 45° from crown to crown,
DNV-RP-C203 (3.3.1), figure 3-6: crown, between, saddle, between, crown, between, saddle, between.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.fatigue.efthymiou import ConcentrationFactors

SIDES = ("chord", "brace")
POSITIONS = ("crown 0°", "45°", "saddle 90°", "135°", "crown 180°", "225°", "saddle 270°", "315°")
_ANGLE = np.arange(8) * 0.25 * np.pi


def hot_spot_matrix(factors: ConcentrationFactors) -> FloatArray:
    r"""Return the hot-spot stresses per nominal stress, (2 sides, 8 points, 3 components).

    .. math::

        σ(φ) = \left[\cos^2 φ\, K_{AC} + \sin^2 φ\, K_{AS}\right] σ_x + \cos φ\, K_{MIP}\, σ_{my}
        - \sin φ\, K_{MOP}\, σ_{mz}

    which at multiples of 45° are the eight sums of the recommended practice.
    """
    axial = np.array(
        [
            [factors.axial_chord_crown, factors.axial_chord_saddle],
            [factors.axial_brace_crown, factors.axial_brace_saddle],
        ]
    )
    bending = np.array(
        [
            [factors.in_plane_chord, factors.out_of_plane_chord],
            [factors.in_plane_brace, factors.out_of_plane_brace],
        ]
    )
    cosine, sine = np.cos(_ANGLE), np.sin(_ANGLE)
    around = np.stack([cosine**2, sine**2])
    return np.stack(
        [axial @ around, bending[:, :1] * cosine, -bending[:, 1:] * sine],
        axis=-1,
    )
