"""Causes of change as directions: their effect on all quantities, and their usual size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import PchipInterpolator

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.watching.directions import PAIR, SIZES

SOMETHING_ELSE = "something else"
SENSOR = "sensor"
"""Prefix of the names of sensors' causes."""
_SENSOR_SHIFT = 0.002
"""Standard deviation by which modes shift at a failing sensor, besides scattering, in ln f;
two hundred times as much in ln ζ."""
_DAMPING_OVER_FREQUENCY = 200.0
REACH = 2.0
"""Range of ln size considered, in spreads on either side; a factor of 5 for an arbitrary size."""
_STEP = 0.025
"""Step of ln size: a third of the accuracy of a size if a direction is as exact as that of the best model."""
MISFIT = 0.12
"""Error of a direction in any quantity, relative to its length, if its model's accuracy is unknown."""
_LARGEST = 4.0
"""Largest size of a pattern without a model, in the largest that is bet on: a fifth off a frequency."""
_SENSOR_PRIOR = 5.0
"""Prior weight of sensor and cable failures relative to that of a structural cause."""


@dataclass(frozen=True)
class Cause:
    """One cause of a change.

    Attributes
    ----------
    name : as it is reported
    draws : (n_draws, m) change of the logarithms of all quantities by one unit of size: draws from what is
        known of the structure, so that a direction is as uncertain as the model is
    sizes : (n_sizes,) in ``unit``, negative ones as well where a cause has two ways
    log_size_weights : (n_sizes,) ln of their prior probabilities
    unit : of the size
    louder : (m,) the mode of each quantity if any of the modes may scatter more, else empty; then the
        draws are
        the square root of the covariance of what moves besides
    prior : weight before the data; of all causes they need not add up to one
    bent_at, bend : (n_bent,) sizes from 0 on, and (n_bent, m) by how much the change by a unit differs from
        that of the draws there, if a large one is not many small ones: a brace that carries less and less
    alike : names of causes that do the same and are meant as well, without this one's
    misfit : a model's direction is not the structure's: share of its length by which it may miss in any
        quantity
    """

    name: str
    draws: FloatArray
    sizes: FloatArray
    log_size_weights: FloatArray
    unit: str = "-"
    louder: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    prior: float = 1.0
    bent_at: FloatArray = field(default_factory=lambda: np.zeros(0))
    bend: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    misfit: float = MISFIT
    alike: tuple[str, ...] = ()

    def steps(self, sizes: FloatArray) -> FloatArray:
        """Return the mean change of all quantities, (n_sizes, m); beyond the last size the bend is constant.

        The bend of a negative size is the mirror image of that of a positive one.
        """
        sizes, J = np.asarray(sizes, dtype=np.float64), self.draws.mean(axis=0)
        if self.bent_at.size:
            at = np.minimum(np.abs(sizes), self.bent_at[-1])
            bend = PchipInterpolator(self.bent_at, self.bend)(at)
            J = J + np.where(sizes[:, None] < 0.0, 2.0 * self.bend[0] - bend, bend)
        return np.asarray(sizes[:, None] * J)


def sizes_about(middle: float, spread: float, *, both_ways: bool = False) -> tuple[FloatArray, FloatArray]:
    """Return sizes within ``REACH`` spreads of ln size about a middle, and equal ln weights.

    Only the order of magnitude of a size is known. Equal odds for each factor favour no cause whose usual
    size happens to explain a change (Jeffreys 1961, section 3.1).
    """
    reach = REACH * spread
    sizes = middle * np.exp(np.linspace(-reach, reach, 2 * int(np.ceil(reach / _STEP)) + 1))
    sizes = np.concatenate([-sizes, sizes]) if both_ways else sizes
    return sizes, np.full(sizes.size, -np.log(sizes.size))


def general_causes(
    quantities: Sequence[tuple[str, int]], labels: Sequence[str], frequency_hz: FloatArray
) -> tuple[Cause, ...]:
    """Return the causes distinguishable without a model: patterns over modes, damping, and failing sensors.

    Parameters
    ----------
    quantities : (m,) kind and mode
    frequency_hz : (n_modes,) by which pairs are found
    """
    kinds = np.array([kind for kind, _ in quantities])
    modes = np.array([mode for _, mode in quantities])
    found: list[Cause] = []

    def add(name: str, kind: str, chosen: BoolArray, prior: float) -> None:
        size = np.array(SIZES[kind])
        low, high = float(size[0]), _LARGEST * float(size[-1])
        fine, weights = sizes_about(np.sqrt(low * high), np.log(high / low) / (2.0 * REACH), both_ways=True)
        found.append(Cause(name, chosen[None].astype(np.float64), fine, weights, "-", prior=prior))

    for kind, what in (("frequency", ""), ("damping", "damping of "), ("angle", "direction of ")):
        of_kind = kinds == kind
        present = sorted(set(modes[of_kind]), key=lambda q: frequency_hz[q])
        for q in present:
            add(f"{what}{labels[q]} alone", kind, of_kind & (modes == q), 0.5)
        for i, j in zip(present, present[1:], strict=False):
            if frequency_hz[j] / frequency_hz[i] < 1.0 + PAIR:
                pair = of_kind & ((modes == i) | (modes == j))
                add(f"{what}{labels[i]} and {labels[j]} alike", kind, pair, 1.0)
        if len(present) > 1:
            add(f"{what}all modes alike", kind, of_kind, 1.0)
    return (*found, sensor_noise(quantities))


def sensor_noise(quantities: Sequence[tuple[str, int]]) -> Cause:
    """Return the cause of a failing sensor: some of the modes scatter more and shift a little."""
    kinds = np.array([kind for kind, _ in quantities])
    modes = np.array([mode for _, mode in quantities], dtype=np.intp)
    spread = np.where(kinds == "frequency", _SENSOR_SHIFT, _DAMPING_OVER_FREQUENCY * _SENSOR_SHIFT)
    return Cause(
        f"{SENSOR}: more scatter",
        np.diag(spread),
        np.zeros(1),
        np.zeros(1),
        louder=modes,
        prior=_SENSOR_PRIOR,
    )
