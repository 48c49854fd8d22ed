r"""Unload–reload of soil curves: Masing's rule through Iwan's parallel sliders.

A concave backbone cut at displacements :math:`y_j` is the sum of elasto-plastic springs that yield there:
:math:`p(y) = \sum_j k_j \min(y, y_j)`. Each spring remembers where its slider stands, and nothing else is
needed for loops of any amplitude (Iwan 1967, J. Appl. Mech. 34:612): unloading starts with the initial
stiffness, and a closed loop of amplitude Y loses 8 (∫₀^Y p dy − ½ p(Y) Y).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.soil.ground.curves import Curve


@dataclass(frozen=True)
class Sliders:
    """Elasto-plastic springs: (n_springs, n_sliders) stiffness [N/m] and displacement at yield [m]."""

    stiffness: FloatArray
    yield_m: FloatArray

    def at_rest(self) -> FloatArray:
        """Return the state of virgin ground: sliders (n_springs, n_sliders) where the pile stands [m]."""
        return np.zeros_like(self.stiffness)


class SliderStep(NamedTuple):
    """Force (n_springs,) [N], tangent [N/m] and the new state."""

    force: FloatArray
    tangent: FloatArray
    state: FloatArray


def sliders(curves: tuple[Curve, ...], weight: FloatArray, *, largest_m: float, number: int = 24) -> Sliders:
    """Return the sliders of reaction curves, each times the pile length it stands for [m].

    The curves are sampled at ``number`` displacements in geometric progression up to ``largest_m``. Softening
    beyond a peak cannot be had from springs in parallel: the peak is held.
    """
    y = np.concatenate([[0.0], np.geomspace(1e-4 * largest_m, largest_m, number)])
    p = np.array([np.maximum.accumulate(curve.force(y)) for curve in curves]) * weight[:, None]
    slope = np.diff(p, axis=1) / np.diff(y)
    # a backbone that stiffens has no sliders either: the smallest slope so far is held
    slope = np.minimum.accumulate(slope, axis=1)
    stiffness = slope - np.concatenate([slope[:, 1:], np.zeros((len(curves), 1))], axis=1)
    return Sliders(stiffness, np.broadcast_to(y[1:], stiffness.shape))


def move(springs: Sliders, state: FloatArray, y: FloatArray) -> SliderStep:
    """Return forces at displacements ``y`` (n_springs,) [m] coming from ``state``."""
    stretch = y[:, None] - state
    slipped = np.clip(stretch, -springs.yield_m, springs.yield_m)
    sticking = np.abs(stretch) < springs.yield_m
    force = (springs.stiffness * slipped).sum(axis=1)
    tangent = (springs.stiffness * sticking).sum(axis=1)
    return SliderStep(force, tangent, y[:, None] - slipped)
