"""Causes of change: the direction of their effect on all quantities, and their usual size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import PchipInterpolator

from jackettwin.arrays import BoolArray, FloatArray, IntArray
from jackettwin.watching.directions import PAIR, SIZES

SOMETHING_ELSE = "something else"
SENSOR = "sensor"
"""Prefix of the names of causes that concern a sensor."""
_SENSOR_SHIFT = 0.002
"""Standard deviation of the shift of ln f at a failing sensor, in addition to increased scatter; that of ln ζ
is two hundred times as large."""
_DAMPING_OVER_FREQUENCY = 200.0
REACH = 2.0
"""Range of ln size about its middle within which all are equally likely, in spreads."""
_LARGER = 0.05
"""Prior probability of a size beyond that, up to twice as far: without them, a mass of seven per cent
was called marine growth or something else with certainty."""
_STEP = 0.025
"""Step of ln size: a third of the accuracy of a size whose direction is that of the best available model."""
MISFIT = 0.12
"""Error of a direction in any quantity, relative to its length, if its model's accuracy is unknown."""
_LARGEST = 4.0
"""Largest size of a pattern without a model, in multiples of the largest tested size: 20 % of a frequency."""
_SENSOR_PRIOR = 5.0
"""Prior weight of sensor and cable failures relative to that of a structural cause."""


@dataclass(frozen=True)
class Cause:
    """One cause of a change.

    Attributes
    ----------
    name : name in reports
    draws : (n_draws, m) change of the logarithms of all quantities per unit of size, for draws from the
        posterior of the structural model, so that the direction is as uncertain as the model
    sizes : (n_sizes,) in ``unit``; negative ones are included where a cause can act in both senses
    log_size_weights : (n_sizes,) ln of their prior probabilities
    unit : unit of the size
    louder : (m,) mode of each quantity if the scatter of any mode may increase, else empty; ``draws`` is then
        the square root of the covariance of the accompanying shift
    prior : prior weight; the weights of all causes need not sum to one
    bent_at, bend : (n_bent,) sizes from 0 on, and (n_bent, m) deviation of the change per unit of size from
        ``draws`` there, for effects that are not proportional to the size, e.g. a brace that loses stiffness
    alike : names of other causes of the same effect, which this one represents
    misfit : error of the model's direction in any quantity, as a share of its length
    mixing : (k, m) further errors per unit of size, independent of each other, of modes that are mixed
        otherwise than in the model; None if there are none
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
    mixing: FloatArray | None = None

    @property
    def usual(self) -> float:
        """Median of the sizes."""
        order = np.argsort(np.abs(self.sizes))
        share = np.cumsum(np.exp(self.log_size_weights[order]))
        return float(np.abs(self.sizes)[order[np.searchsorted(share, 0.5 * share[-1])]])

    def steps(self, sizes: FloatArray) -> FloatArray:
        """Return the mean change of all quantities, (n_sizes, m).

        The deviation ``bend`` is constant beyond the last size and antisymmetric in the size.
        """
        sizes, J = np.asarray(sizes, dtype=np.float64), self.draws.mean(axis=0)
        if self.bent_at.size:
            at = np.minimum(np.abs(sizes), self.bent_at[-1])
            bend = PchipInterpolator(self.bent_at, self.bend)(at)
            J = J + np.where(sizes[:, None] < 0.0, 2.0 * self.bend[0] - bend, bend)
        return np.asarray(sizes[:, None] * J)


def sizes_about(
    middle: float,
    spread: float,
    *,
    both_ways: bool = False,
    larger: bool = False,
    largest: float = np.inf,
    finer: int = 1,
) -> tuple[FloatArray, FloatArray]:
    """Return sizes within ``REACH`` spreads of ln size about a middle, and equal ln weights.

    Only the order of magnitude of a size is known. A uniform prior of ln size favours no cause whose usual
    size happens to explain a change (Jeffreys 1961, section 3.1).

    Parameters
    ----------
    larger : whether some are beyond, up to twice as far
    largest : no size reaches it
    finer : how many times as many, where a direction is known better than a model's
    """
    reach = REACH * spread
    n = finer * int(np.ceil(reach / _STEP))
    beyond = reach * (1.0 + np.arange(2, n + 1, 2) / n) if larger else np.zeros(0)
    sizes = middle * np.exp(np.concatenate([np.linspace(-reach, reach, 2 * n + 1), beyond]))
    share = np.array([1.0 - _LARGER, _LARGER]) / [2 * n + 1, max(n // 2, 1)]
    weights = np.repeat(share, [2 * n + 1, beyond.size])
    sizes, weights = sizes[sizes < largest], weights[sizes < largest]
    if both_ways:
        sizes, weights = np.concatenate([-sizes, sizes]), np.tile(weights, 2)
    return sizes, np.log(weights / weights.sum())


def general_causes(
    quantities: Sequence[tuple[str, int]], labels: Sequence[str], frequency_hz: FloatArray
) -> tuple[Cause, ...]:
    """Return the causes distinguishable without a model: patterns over modes, damping, and failing sensors.

    Parameters
    ----------
    quantities : (m,) kind and mode of each quantity
    frequency_hz : (n_modes,) frequencies, from which pairs are recognised
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
    """Return the cause "failing sensor": the scatter of some modes increases, and they shift slightly."""
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
