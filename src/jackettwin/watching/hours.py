"""Hourly averages of rows without outliers, and the scatter within each hour.

The model has no variation within an hour, so that mean and scatter of an hour's records are independent:
means inform on the level, scatter on the noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray, IntArray

OUTLIER = 4.5
"""Distance from its neighbours, in standard deviations, above which a value is rejected:
one in 150,000 of normal noise."""
DOUBTED = 2.2
"""Distance in standard deviations above which a value is down-weighted: one in 36 of normal noise."""
NEIGHBOURS = 9
"""Number of neighbouring values with whose median a value is compared."""
ENOUGH = 3
"""Fewest values of a day that are compared with each other. Fewer values are compared with earlier days.
Since a step is distant from these too, a rejection then does not count as scatter, and after five values the
neighbours are replaced. So are values of which half would be rejected, as of two outliers of four, and three
of which one would be: the two that agree may be outliers."""


@dataclass(frozen=True)
class Hours:
    """Averages of the records of an hour and one operating state.

    Attributes
    ----------
    days : (n,) mean times [days]
    rows : (n, p) regressors
    values : (n, m) mean values, NaN where there is none
    noise : (n, m) stated variances of the means
    chi2, freedom : (n, m) scatter within the hour over stated variances, and its degrees of freedom
    """

    days: FloatArray
    rows: FloatArray
    values: FloatArray
    noise: FloatArray
    chi2: FloatArray
    freedom: FloatArray

    def of(self, chosen: list[int]) -> Hours:
        """Return the hours in which any of some quantities was observed."""
        seen = np.isfinite(self.values[:, chosen]).any(axis=1)
        rest = (a[seen][:, chosen] for a in (self.values, self.noise, self.chi2, self.freedom))
        return Hours(self.days[seen], self.rows[seen], *rest)

    def at(self, chosen: BoolArray) -> Hours:
        """Return some of the hours."""
        arrays = (self.days, self.rows, self.values, self.noise, self.chi2, self.freedom)
        return Hours(*(a[chosen] for a in arrays))


def outliers(
    rest: FloatArray, variance: FloatArray, tail: FloatArray
) -> tuple[BoolArray, FloatArray, FloatArray]:
    """Return which values of a day are outliers, factors on variances, and the neighbours of the next day.

    A common step of all neighbours does not affect rejection, so that no change is hidden. The variance of a
    distant value that is not rejected is multiplied by a factor that puts it at ``DOUBTED`` deviations: it
    then says less of the level than by Huber's weight, and the less the more distant it is.

    Parameters
    ----------
    rest : (n, m) residuals after conditions, NaN where missing
    variance : (n, m) variances of their noise and of variation within a day
    tail : (NEIGHBOURS, m) preceding residuals
    """
    apart, doubt = np.zeros(rest.shape, dtype=np.bool_), np.ones(rest.shape)
    after = tail.copy()
    for q in range(rest.shape[1]):
        seen = np.flatnonzero(np.isfinite(rest[:, q]))
        today = rest[seen, q]
        if not seen.size:
            continue
        before = tail[np.isfinite(tail[:, q]), q][-max(NEIGHBOURS - seen.size, 1) :]
        std = np.sqrt(variance[seen, q])
        distance = np.zeros(seen.size)
        if seen.size >= ENOUGH:
            distance = np.abs(today - _running_median(today)) / std
        far = int(np.sum(distance > OUTLIER))
        # the middle itself is in doubt: of three values, the two that agree may be the outliers
        if seen.size < ENOUGH or 2 * far >= seen.size or (far and seen.size == ENOUGH):
            around = np.concatenate([before, today])
            if around.size >= ENOUGH:
                distance = np.abs(today - _running_median(around)[-seen.size :]) / std
        apart[seen, q] = distance > OUTLIER
        doubt[seen, q] = np.maximum(distance / DOUBTED, 1.0) ** 2
        after[:, q] = np.concatenate([tail[:, q], today])[-NEIGHBOURS:]
    return apart, doubt, after


def _running_median(x: FloatArray) -> FloatArray:
    """Return the median of the values nearest in time to each, so that slow variation causes no rejection."""
    width = min(NEIGHBOURS, x.size)
    medians = np.median(np.lib.stride_tricks.sliding_window_view(x, width), axis=1)
    return np.asarray(medians[np.clip(np.arange(x.size) - width // 2, 0, medians.size - 1)])


def by_hour(
    days: FloatArray,
    states: IntArray,
    rows: FloatArray,
    values: FloatArray,
    noise: FloatArray,
    window_days: float,
) -> Hours:
    """Return weighted means over windows on the clock.

    Parameters
    ----------
    days : (n,) times [days], ascending
    states : (n,) operating states, averaged separately
    rows : (n, p) regressors
    values, noise : (n, m) values and variances of their noise, NaN where missing
    window_days : length of a window [days]
    """
    key = np.floor(days / window_days + 1e-9) * (states.max(initial=0) + 1) + states
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    number = first.size
    weight = np.where(np.isfinite(values), 1.0 / noise, 0.0)
    filled = np.where(np.isfinite(values), values, 0.0)

    def total(x: FloatArray) -> FloatArray:
        out = np.zeros((number, x.shape[1]))
        np.add.at(out, group, x)
        return out

    count = total(np.ones((days.size, 1)))
    precision = total(weight)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total(weight * filled) / precision
        variance = 1.0 / precision
    off = np.where(weight > 0.0, filled - mean[group], 0.0)
    freedom = np.maximum(total((weight > 0.0).astype(np.float64)) - 1.0, 0.0)
    order = np.argsort(days[first], kind="stable")
    return Hours(
        (total(days[:, None]) / count)[order, 0],
        (total(rows) / count)[order],
        mean[order],
        np.where(precision > 0.0, variance, np.nan)[order],
        total(weight * off**2)[order],
        freedom[order],
    )
