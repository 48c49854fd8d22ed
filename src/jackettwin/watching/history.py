"""Data to be monitored: modes through time with their conditions, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray

Kind = Literal["frequency", "damping", "angle"]

_NEAR_DAYS = 0.25
"""Records closer in time than this saw the same structure [days]."""
_FEWEST_PAIRS = 30


def typical(values: FloatArray) -> FloatArray:
    """Return the median of the positive values of each column, (m,); NaN where there is none."""
    columns = [column[np.isfinite(column) & (column > 0.0)] for column in values.T]
    return np.array([np.median(x) if x.size else np.nan for x in columns])


@dataclass(frozen=True)
class History:
    """Modes through time.

    Attributes
    ----------
    days : (n,) times in days from any origin, ascending; whole numbers are midnights
    labels : of the m modes
    frequency, damping : (n, m) in Hz and as ratios; NaN where a mode was not seen
    frequency_std, damping_std : (n, m) stated standard deviations; NaN where none is stated
    conditions : (n, k) what was measured beside; NaN where missing
    condition_names : of the k columns
    states : (n,) number of the operating state of each row
    state_names : of the operating states
    angle, angle_std : (n, m) [rad] the horizontal direction in which the lower mode of a pair moves, from x
        towards y and as good as its opposite; NaN where none is known. None for a table without any
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

    def rows(self, chosen: BoolArray) -> History:
        """Return some of the rows."""
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


def deviations(
    history: History, kind: Kind, kept: IntArray, typical: FloatArray, power: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return ln of the values over typical ones, and relative standard deviations, both (n, m).

    For directions it is the rotation from the typical one [rad], at most a right angle.

    A stated standard deviation may depend on its value: that of ζ is proportional to √ζ by Au's law (2014),
    or to ζ if a coefficient of variation was stated. A record whose ζ happens to be low must not gain weight
    from that, so that this part is evaluated at the typical value.

    Parameters
    ----------
    kept : (m,) columns
    typical : (m,) values of the baseline
    power : (m,) by which standard deviations follow values
    """
    value, std = (x[:, kept] for x in history.seen(kind))
    if kind == "angle":
        return 0.5 * np.angle(np.exp(2j * (value - typical))), np.where(std > 0.0, std, np.nan)
    good = np.where(value > 0.0, value, np.nan)
    relative = std / (good**power * typical ** (1.0 - power))
    return np.log(good / typical), np.where(relative > 0.0, relative, np.nan)


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
