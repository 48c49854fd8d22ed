r"""Whether measured modes move as the fitted model's do, and follow each other in the same order.

Close modes mix in any measured shape, so that a shape m is held against the plane of all modes of the model
near it: with Q an orthonormal basis of these at the sensors, :math:`1 - \|Q^H m\|^2/\|m\|^2` of it lies
outside. Errors of σ at n sensors put :math:`(1 - k/n) Σσ^2/\|m\|^2` outside of k modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
import scipy.linalg as la
from scipy.special import ndtri

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.updating.data.misfit import UNLIKELY
from jackettwin.updating.data.pairing import MIXING

_REMAINDER = 0.01
"""Share of a shape's square that beams, joints and the places of sensors may miss (standard deviation): of
bending modes in the shipped records 0.001 to 0.3 % lie outside the model's, of torsion 0.03 to 2 %."""


@dataclass(frozen=True)
class CheckedShape:
    """The measured shape of a mode at some sensors.

    Attributes
    ----------
    mode : int
        Number in the model.
    shape : (n,) complex
    std : (n,) standard deviations of its entries
    """

    mode: int
    shape: ComplexArray
    std: FloatArray


@dataclass(frozen=True)
class ShapeCheck:
    """A measured shape beside the fitted model's.

    Attributes
    ----------
    mode : int
    outside : float
        Share of its square that lies outside the model's modes near it.
    expected : float
        What the sensors' errors put there on average.
    std : float
        Of what chance and a model of beams may put there.
    objects : bool
    """

    mode: int
    outside: float
    expected: float
    std: float
    objects: bool


@dataclass(frozen=True)
class OrderCheck:
    """Two neighbours among the measured frequencies, and how the model has them.

    Attributes
    ----------
    lower, upper : int
        Numbers in the model, by measured frequency.
    apart, predicted : float
        ln of the upper's frequency over the lower's: measured, and of the model.
    std : float
        Of their difference.
    objects : bool
        Whether the model surely has them the other way round, and chance does not explain it.
    """

    lower: int
    upper: int
    apart: float
    predicted: float
    std: float
    objects: bool


def shape_checks(
    measured: Sequence[CheckedShape],
    at_sensors: Sequence[ComplexArray],
    frequency_hz: FloatArray,
    own_hz: Sequence[float],
) -> tuple[ShapeCheck, ...]:
    """Return how measured shapes lie to a model's; none for a shape with no more sensors than modes near it.

    Parameters
    ----------
    at_sensors : of each measured shape, (n, n_modes) the model's modes at its sensors
    frequency_hz : (n_modes,) of the model
    own_hz : of each measured shape, the model's frequency of its mode
    """
    limit = -float(ndtri(UNLIKELY / max(len(measured), 1)))
    found = []
    for m, shapes, hz in zip(measured, at_sensors, own_hz, strict=True):
        basis = la.orth(shapes[:, np.abs(np.log(frequency_hz / hz)) < MIXING])
        n, k = basis.shape
        if not 0 < k < n:
            continue
        square = float(np.vdot(m.shape, m.shape).real)
        outside = 1.0 - float(np.sum(np.abs(basis.conj().T @ m.shape) ** 2)) / square
        expected = (1.0 - k / n) * float(m.std @ m.std) / square
        # a sum of n − k squares of both parts
        std = float(np.hypot(expected / sqrt(n - k), _REMAINDER))
        found.append(ShapeCheck(m.mode, outside, expected, std, outside > expected + limit * std))
    return tuple(found)


def order_checks(
    modes: Sequence[int], ln_f: FloatArray, std: FloatArray, predicted: FloatArray
) -> tuple[OrderCheck, ...]:
    """Return how neighbours among measured frequencies follow each other in the model.

    Parameters
    ----------
    modes : (n,) numbers in the model
    ln_f, std : (n,) of the measured frequencies
    predicted : (n_draws, n) of the model, its errors included
    """
    by_f = np.argsort(ln_f)
    limit = -float(ndtri(UNLIKELY / max(by_f.size - 1, 1)))
    found = []
    for a, b in zip(by_f, by_f[1:], strict=False):
        ahead = predicted[:, b] - predicted[:, a]
        middle, apart = float(np.mean(ahead)), float(ln_f[b] - ln_f[a])
        own = float(np.std(ahead))
        both = float(np.sqrt(own**2 + std[a] ** 2 + std[b] ** 2))
        objects = middle < -limit * own and apart - middle > limit * both
        found.append(OrderCheck(int(modes[a]), int(modes[b]), apart, middle, both, objects))
    return tuple(found)
