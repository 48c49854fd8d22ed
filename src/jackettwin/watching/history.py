"""Monitored data: time series of modes and conditions, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray

Kind = Literal["frequency", "damping", "angle"]

_NEAR_DAYS = 0.25
"""Difference in time below which two records are of the same structure [days]."""
_FEWEST_PAIRS = 30


def typical(values: FloatArray) -> FloatArray:
    """Return the median of the positive values of each column, (m,); NaN where there is none."""
    columns = [column[np.isfinite(column) & (column > 0.0)] for column in values.T]
    return np.array([np.median(x) if x.size else np.nan for x in columns])


@dataclass(frozen=True)
class History:
    """Time series of modes and conditions.

    Attributes
    ----------
    days : (n,) times in days from any origin, ascending; whole numbers are midnights
    labels : names of the m modes
    frequency, damping : (n, m) frequencies [Hz] and damping ratios; NaN where a mode was not identified
    frequency_std, damping_std : (n, m) stated standard deviations; NaN where none is stated
    conditions : (n, k) measured conditions; NaN where missing
    condition_names : names of the k conditions
    states : (n,) number of the operating state of each row
    state_names : names of the operating states
    angle, angle_std : (n, m) horizontal direction in which the lower mode of a pair moves, from x towards y,
        modulo π, and its standard deviation [rad]; NaN where unknown. None for a table without directions
    """

    days: FloatArray
    labels: tuple[str, ...]
    frequency: FloatArray
    frequency_std: FloatArray
    damping: FloatArray
    damping_std: FloatArray
    conditions: FloatArray
    condition_names: tuple[str, ...]
    states: IntArray
    state_names: tuple[str, ...] = ("all",)
    angle: FloatArray | None = None
    angle_std: FloatArray | None = None

    def seen(self, kind: Kind) -> tuple[FloatArray, FloatArray]:
        """Return values of a kind and their standard deviations, (n, m) each; NaN where there is none."""
        none = np.full(self.frequency.shape, np.nan)
        value, std = getattr(self, kind), getattr(self, f"{kind}_std")
        return none if value is None else value, none if std is None else std

    def rows(self, chosen: BoolArray | IntArray) -> History:
        """Return some of the rows, by a mask or by their numbers."""
        arrays = (
            "days", "frequency", "frequency_std", "damping", "damping_std", "conditions", "states", "angle",
            "angle_std",
        )  # fmt: skip
        there = [name for name in arrays if getattr(self, name) is not None]
        return replace(self, **{name: getattr(self, name)[chosen] for name in there})

    def between(self, first: float, last: float) -> History:
        """Return the rows with first ≤ days < last."""
        return self.rows((self.days >= first) & (self.days < last))

    def by_day(self) -> tuple[History, ...]:
        """Return the rows of each whole day that has any."""
        day = np.floor(self.days)
        return tuple(self.rows(day == d) for d in np.unique(day))


def middles(history: History, kind: Kind, kept: IntArray) -> FloatArray:
    """Return the typical values of some columns, (m,); for directions, the mean axis."""
    value = history.seen(kind)[0][:, kept]
    if kind == "angle":
        return np.asarray(0.5 * np.angle(np.nansum(np.exp(2j * value), axis=0)))
    return typical(value)


@dataclass(frozen=True)
class NearestModes:
    """The mode nearest in frequency to each of m modes, and how far it is.

    Attributes
    ----------
    mode : (m,) index of its column in the history
    gap : (m,) typical absolute ln of the ratio of both frequencies
    """

    mode: IntArray
    gap: FloatArray


def nearest_modes(history: History, kept: IntArray) -> NearestModes:
    """Return the modes nearest to those of some columns; the gap is NaN where no record has both."""
    ln_f = np.log(typical(history.frequency))
    away = np.abs(ln_f - ln_f[kept, None])
    away[range(len(kept)), kept] = np.nan
    mode = np.argmin(np.where(np.isfinite(away), away, np.inf), axis=1)
    gaps = [x[np.isfinite(x)] for x in _gaps(history, kept, mode).T]
    return NearestModes(mode, np.array([np.median(x) if x.size else np.nan for x in gaps]))


def _gaps(history: History, kept: IntArray, mode: IntArray) -> FloatArray:
    return np.asarray(np.abs(np.log(history.frequency[:, kept] / history.frequency[:, mode])))


def deviations(
    history: History,
    kind: Kind,
    kept: IntArray,
    typical: FloatArray,
    power: FloatArray,
    near: NearestModes | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return ln of the ratios to typical values, and relative standard deviations, both (n, m).

    For directions it returns the rotation from the typical direction [rad], at most a right angle.
    Uncertain frequencies mix the modes of a pair by the ratio of their standard deviation to the distance of
    the pair, which a record can only state with its own distance. Records in which noise moves the pair apart
    would gain weight: this part of the variance, too, is evaluated at the typical distance.

    A stated standard deviation may depend on its value: that of ζ is proportional to √ζ by Au's law (2014),
    or to ζ if a coefficient of variation was stated. So that a record whose ζ happens to be low gains no
    weight, this dependence is evaluated at the typical value.

    Parameters
    ----------
    kept : (m,) indices of columns
    typical : (m,) typical values over the baseline
    power : (m,) power of the value to which stated standard deviations are proportional
    near : of directions, the other mode of each pair; None to take standard deviations as stated
    """
    value, std = (x[:, kept] for x in history.seen(kind))
    if kind == "angle":
        std = np.where(std > 0.0, std, np.nan)
        std = std if near is None else _at_typical_gap(history, kept, std, near)
        return 0.5 * np.angle(np.exp(2j * (value - typical))), std
    good = np.where(value > 0.0, value, np.nan)
    relative = std / (good**power * typical ** (1.0 - power))
    return np.log(good / typical), np.where(relative > 0.0, relative, np.nan)


def _at_typical_gap(history: History, kept: IntArray, std: FloatArray, near: NearestModes) -> FloatArray:
    """Return the standard deviations of directions as if each pair were as far apart as usual, (n, m)."""
    relative = history.frequency_std / history.frequency
    mixed = np.hypot(relative[:, kept], relative[:, near.mode])
    with np.errstate(divide="ignore", invalid="ignore"):
        shape = np.maximum(std**2 - (mixed / _gaps(history, kept, near.mode)) ** 2, 0.0)
        usual = np.sqrt(shape + (mixed / near.gap) ** 2)
    return np.where(np.isfinite(usual), usual, std)


def std_power(history: History, kind: Kind, kept: IntArray) -> FloatArray:
    """Return the power of the value to which stated standard deviations are proportional, (m,)."""
    out = np.ones(len(kept))
    near = np.diff(history.days) < _NEAR_DAYS
    for k, q in enumerate(kept):
        value, std = getattr(history, kind)[:, q], getattr(history, f"{kind}_std")[:, q]
        with np.errstate(invalid="ignore", divide="ignore"):
            moved, with_it = (np.diff(np.log(x))[near] for x in (value, std))
        both = np.isfinite(moved) & np.isfinite(with_it)
        both[both] &= np.abs(moved[both]) < 4.0 * np.median(np.abs(moved[both])) if both.any() else False
        if both.sum() >= _FEWEST_PAIRS:
            square = float(moved[both] @ moved[both])
            out[k] = np.clip(moved[both] @ with_it[both] / square, 0.0, 1.0) if square > 0.0 else 1.0
    return out
