"""Causes as directions: what each would do to all quantities, and how large it usually is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.watching.directions import PAIR, SIZES

SOMETHING_ELSE = "something else"
SENSOR = "sensor"
"""What the names of sensors' causes begin with."""
_SENSOR_SHIFT = 0.002
"""Standard deviation by which the modes of a failing sensor move besides scattering, in ln f; two hundred
times as much in ln ζ."""
_DAMPING_OVER_FREQUENCY = 200.0
BENT = 4.0
"""Of the median size: up to there the bend of a direction goes on."""
MISFIT = 0.12
"""By how much of its length a direction misses in any quantity, if nothing says how good its model is."""
_SENSOR_PRIOR = 5.0
"""Sensors and their cables fail some times as often as anything in the structure."""


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
    bend : (m,) change of the direction from one unit to the next, if a large one is not many small ones: a
        brace that carries less and less, soil under ever longer free piles
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
    bend: FloatArray = field(default_factory=lambda: np.zeros(0))
    misfit: float = MISFIT

    def steps(self, sizes: FloatArray) -> FloatArray:
        """Return the mean change of all quantities, (n_sizes, m), bent up to ``BENT`` medians."""
        sizes, J = np.asarray(sizes, dtype=np.float64), self.draws.mean(axis=0)
        if self.bend.size:
            middle = float(np.median(np.abs(self.sizes)))
            J = J + np.clip(np.abs(sizes)[:, None] / middle - 1.0, -1.0, BENT - 1.0) * self.bend
        return np.asarray(sizes[:, None] * J)


def lognormal_sizes(
    median: float, spread: float, *, both_ways: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return sizes over ±2.5 standard deviations of ln size, a third of one apart or less, and ln weights."""
    z = np.linspace(-2.5, 2.5, 31)
    sizes, weights = median * np.exp(spread * z), np.exp(-0.5 * z**2)
    if both_ways:
        sizes, weights = np.concatenate([-sizes, sizes]), np.concatenate([weights, weights])
    return sizes, np.log(weights / weights.sum())


def general_causes(
    quantities: Sequence[tuple[str, int]], labels: Sequence[str], frequency_hz: FloatArray
) -> tuple[Cause, ...]:
    """Return what can be told apart without a model: patterns over modes, damping, and failing sensors.

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
        # equal chances to each factor of two, both ways
        fine, weights = lognormal_sizes(float(np.sqrt(size[0] * size[-1])), 0.8, both_ways=True)
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
    """Return a failing sensor: any of the modes scatter more, and move a little."""
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
