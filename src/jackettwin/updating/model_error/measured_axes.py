r"""Bending pairs of a symmetric structure, on the axes in which they were measured.

The two modes of a symmetric structure's pair have equal frequencies, and any two axes are theirs. What makes
the real structure unsymmetric, such as a soft foot, chooses them: its modes are u₁ and u₂ along the measured
axes. Then, exactly, λᵢ = uᵢᵀ(A + E)uᵢ for the pair's 2 × 2 matrix A of the model and its disturbance E. On
the axes that a solver happened to return, a soft foot on the diagonal would move both frequencies alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.response import Condensed, NumberedModes

_SYMMETRIC = 0.1
"""Difference of the model's frequencies over that of the measured ones below which the disturbance, not the
model, chooses the axes. What the model parts is then taken for as much as it is along the measured axes."""


@dataclass(frozen=True, eq=False)
class PairDirection:
    """A measured direction of the lower mode of a pair.

    Attributes
    ----------
    modes : (int, int)
        Numbers in the model of the lower and the upper of the measured modes.
    angle_rad, std_rad : float
        Angle from x towards y, and its standard deviation.
    apart : float
        Difference of the two measured frequencies over their mean.
    motion : (n_places, 2, assembly.n_dof) horizontal motion of the measured places
    """

    modes: tuple[int, int]
    angle_rad: float
    std_rad: float
    apart: float
    motion: FloatArray

    @property
    def datum(self) -> str:
        """Name of the datum, ``α1``, by the lower of the two numbers."""
        return f"α{min(self.modes)}"

    def chosen_by_disturbance(self, apart: float) -> bool:
        """Whether a model whose frequencies differ by ``apart`` leaves the axes to what is not in it."""
        return apart < _SYMMETRIC * self.apart


def on_measured_axes(
    found: NumberedModes, condensed: Condensed, pairs: Sequence[PairDirection]
) -> NumberedModes:
    """Return modes whose shapes in symmetric pairs are along the measured axes."""
    shapes = found.shapes
    for pair in pairs:
        if not {*pair.modes} <= {*found.modes}:
            continue
        lower, upper = (found.modes.index(mode) for mode in pair.modes)
        size = np.abs(found.poles[:, [lower, upper]])
        apart = np.abs(size[:, 1] - size[:, 0]) / size.mean(axis=1)
        chosen = [k for k in np.flatnonzero(np.isfinite(apart)) if pair.chosen_by_disturbance(apart[k])]
        if not chosen:
            continue
        omega = condensed.pinned.omega[pair.modes[0] - 1]
        motion = pair.motion @ condensed.expansion(1j * omega).real
        shapes = shapes.copy()
        for k in chosen:
            shapes[k, lower], shapes[k, upper] = _turned(
                shapes[k, lower], shapes[k, upper], motion, pair.angle_rad
            )
    return found if shapes is found.shapes else replace(found, shapes=shapes)


def _turned(
    one: ComplexArray, other: ComplexArray, motion: FloatArray, angle: float
) -> tuple[ComplexArray, ComplexArray]:
    """Return both shapes of a pair combined so that the first moves along a direction [rad].

    Both are scaled to equal motion first, which in a symmetric structure makes xᵀF′x equal.
    """
    one, other = (x / np.sqrt(np.sum((motion @ x) ** 2)) for x in (one, other))
    across = np.array([-np.sin(angle), np.cos(angle)])
    away = np.stack([(motion @ x).real @ across for x in (one, other)], axis=1)
    c, d = np.linalg.svd(away)[2][-1]
    return c * one + d * other, c * other - d * one
