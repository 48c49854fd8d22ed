"""Conversion of time stamps to a regular grid; gaps become missing samples and jitter is measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray, Int64Array, IntArray
from jackettwin.constants import HOUR_S
from jackettwin.errors import InputError
from jackettwin.records.record import RATES_HZ

RATE_TOLERANCE = 1e-3
"""Largest relative difference between the stated sample rate and that of the stamps."""
MAX_PLACED_JITTER = 0.05
"""Jitter, as a share of the step, up to which samples are placed on the grid without interpolation."""
MAX_GRID_POINTS = 20
"""Most grid points per stamp; beyond, the stamps contain a jump, not a gap."""
MAX_DISORDER = 0.05
"""Largest share of repeated or backward stamps in an accepted time column."""
MAX_SHARED_S = 60.0
"""Longest usual step of stamps whose clock may have been put on by an hour [s]."""
MIN_TICKS = 10
"""Fewest ticks of a coarse clock that show how many samples share one."""


@dataclass(frozen=True)
class Clock:
    """Properties of the logger's clock derived from the stamps.

    ``jitter_s`` is the rms distance of the stamps from the regular grid, ``missing`` the number of
    grid points without a stamp, ``disordered`` the number of stamps dropped because they were
    repeated, unreadable or out of order.
    """

    sample_rate_hz: float
    jitter_s: float
    missing: int
    disordered: int


def regularise(
    times_s: FloatArray, data: FloatArray, *, sample_rate_hz: float | None = None
) -> tuple[FloatArray, Clock]:
    """Bring stamped samples onto a regular grid that starts at the first stamp.

    The rate is the stated one, if it agrees with the stamps, else the least-squares slope of the
    stamps. Samples are placed at the nearest grid point; with more jitter than a twentieth of the
    step they are interpolated to the grid, but never across a gap.

    Parameters
    ----------
    times_s : (n_samples,) array
    data : (n_channels, n_samples) array
    sample_rate_hz : float, optional
        The stated rate.

    Returns
    -------
    data : (n_channels, n_grid) array
    clock : Clock

    Raises
    ------
    InputError
        If the stamps do not increase, jump, or contradict the stated rate.
    """
    keep = _increasing(times_s)
    t, y = times_s[keep] - times_s[keep][0], data[:, keep]
    _refuse_absurd(t)
    index, step, offset = _grid(t)
    if index[-1] > MAX_GRID_POINTS * len(t):
        raise InputError(
            "time stamps jump",
            field="time",
            value=float(np.diff(t).max()),
            allowed="gaps shorter than the record",
            remedy="split the file at the jump",
        )
    residual = t - offset - step * index
    jitter = float(np.sqrt(np.mean(residual**2)))
    rate = _agreed_rate(1.0 / step, sample_rate_hz, jitter, index)
    n_grid = int(index[-1]) + 1
    if jitter <= MAX_PLACED_JITTER * step:
        out = np.full((len(y), n_grid), np.nan)
        out[:, index] = y
    else:
        # where every grid point has its stamp, no long step is a gap, only jitter
        longest = 1.5 / rate if len(np.unique(index)) < n_grid else np.inf
        out = _interpolate(np.arange(n_grid) / rate + offset, t, y, longest)
    dropped = int(len(times_s) - len(t))
    return out, Clock(rate, jitter, n_grid - len(np.unique(index)), dropped)


def without_hours(times_s: FloatArray) -> tuple[FloatArray, tuple[float, float] | None]:
    """Return stamps less the full hours by which their clock is once put on, and when and how many, both [s].

    To summer time, or another zone: before and after the jump, samples follow each other as everywhere else.

    Examples
    --------
    >>> t = np.arange(200) / 10.0
    >>> back, (when, by) = without_hours(np.where(t < 5.0, t, t + 3600.0))
    >>> bool(np.allclose(back, t)), round(when, 1), by
    (True, 4.9, 3600.0)
    >>> without_hours(np.where(t < 5.0, t, t + 3000.0))[1] is None
    True
    """
    steps = np.diff(times_s)
    if len(steps) < 3 or not np.isfinite(steps).all():
        return times_s, None
    usual = float(np.median(steps))
    long = np.flatnonzero(steps > 0.5 * HOUR_S)
    if len(long) != 1 or usual <= 0.0 or usual > MAX_SHARED_S:
        return times_s, None
    hours_s = HOUR_S * round(float(steps[long[0]] - usual) / HOUR_S)
    if hours_s == 0.0 or abs(float(steps[long[0]]) - usual - hours_s) > 0.5 * usual:
        return times_s, None
    at = int(long[0])
    later = np.where(np.arange(len(times_s)) > at, hours_s, 0.0)
    return times_s - later, (float(times_s[at] - times_s[0]), hours_s)


def between_ticks(times_s: FloatArray) -> FloatArray | None:
    """Return the stamps of a coarse clock spread evenly over its ticks; None if the clock is not coarse.

    A coarse clock has evenly spaced ticks, each of which, except the first and the last,
    is shared by the same number of samples within one: e.g. full seconds for twenty samples each.

    Examples
    --------
    >>> stamps = np.repeat(np.arange(12.0), 4)[1:]
    >>> between_ticks(stamps)[:5].tolist(), between_ticks(np.arange(12.0))
    ([0.25, 0.5, 0.75, 1.0, 1.25], None)
    """
    if not np.isfinite(times_s).all() or np.any(np.diff(times_s) < 0.0):
        return None
    ticks, first, count = np.unique(times_s, return_index=True, return_counts=True)
    inner = count[1:-1]
    if len(inner) < MIN_TICKS or inner.min() < 2 or np.abs(inner - np.median(inner)).max() > 1:
        return None
    steps = np.diff(ticks)
    if np.ptp(steps) > MAX_PLACED_JITTER * steps.mean():
        return None
    n = first[-1] - first[1]
    rate = shortest_decimal(n / (ticks[-1] - ticks[1]), 1.0 / n)
    return np.asarray(ticks[1] + (np.arange(len(times_s)) - first[1]) / rate)


def _increasing(times_s: FloatArray) -> IntArray:
    """Return the indices of the stamps that are finite and later than all before them."""
    finite = np.where(np.isfinite(times_s), times_s, -np.inf)
    latest = np.concatenate([[-np.inf], np.maximum.accumulate(finite)[:-1]])
    keep = np.flatnonzero(finite > latest)
    if len(keep) < 2 or len(keep) < (1.0 - MAX_DISORDER) * len(times_s):
        raise InputError(
            "time stamps do not increase",
            field="time",
            value=f"{len(times_s) - len(keep)} of {len(times_s)} out of order",
            allowed="increasing times",
            remedy="remove the time column and state sample_rate_hz; sort only a file of mixed rows",
        )
    return keep


def _refuse_absurd(t: FloatArray) -> None:
    rate = (len(t) - 1) / t[-1]
    if not RATES_HZ[0] <= rate <= RATES_HZ[1]:
        raise InputError(
            "time stamps are no logger's",
            field="time",
            value=f"{rate:g} stamps a second",
            allowed=f"{RATES_HZ[0]:g} to {RATES_HZ[1]:g}",
            remedy="check the unit of the time column",
        )


def _grid(t: FloatArray) -> tuple[Int64Array, float, float]:
    """Return each stamp's grid point, the step and the fitted time of grid point 0.

    The fit is extended from the first stamps to all, so that the step is always known precisely enough to
    count across the next part: jitter does not accumulate, and a gap does not shift the count.
    """
    steps = np.diff(t)
    usual = np.median(steps)
    step = float(np.mean(steps[np.abs(steps - usual) <= 0.5 * usual]))
    size = 16
    while size < len(t):
        size = min(int(1.5 * size), len(t))
        step, _ = _line(_count(t[:size], step), t[:size], step)
    index = _count(t, step)
    step, offset = _line(index, t, step)
    return (index - index[0]).astype(np.int64), step, offset + step * float(index[0])


def _count(t: FloatArray, step: float) -> FloatArray:
    """Return the nearest multiples of the step, counted from the stamps' mean phase."""
    phase = np.angle(np.mean(np.exp(2j * np.pi * t / step))) / (2.0 * np.pi)
    count: FloatArray = np.round(t / step - phase)
    return count


def _line(index: FloatArray, t: FloatArray, step: float) -> tuple[float, float]:
    """Return slope and intercept of the least-squares line; the old slope if it is undetermined."""
    x = index - index.mean()
    power = float(x @ x)
    slope = float(x @ t) / power if power > 0.0 else step
    return slope, float(t.mean() - slope * index.mean())


def _agreed_rate(fitted: float, stated: float | None, jitter_s: float, index: Int64Array) -> float:
    if stated is None:
        # stamps are rounded: use the shortest decimal within their uncertainty
        spread = float(np.std(index)) * np.sqrt(len(index))
        return shortest_decimal(fitted, max(4.0 * jitter_s / spread * fitted, 1e-9))
    if abs(fitted / stated - 1.0) > RATE_TOLERANCE:
        raise InputError(
            "stated sample rate contradicts the time stamps",
            field="sample_rate_hz",
            value=stated,
            allowed=f"{fitted:.6g} within 0.1 %",
            remedy="correct or remove sample_rate_hz",
        )
    return stated


def shortest_decimal(rate: float, tolerance: float) -> float:
    """Return the shortest decimal within a relative tolerance of a rate.

    >>> shortest_decimal(49.9998, 1e-5)
    50.0
    """
    short = (float(f"{rate:.{digits}g}") for digits in range(1, 10))
    return next((r for r in short if abs(r / rate - 1.0) <= tolerance), rate)


def _interpolate(grid: FloatArray, t: FloatArray, y: FloatArray, longest: float) -> FloatArray:
    """Interpolate linearly, leaving NaN where the neighbouring stamps are farther apart than ``longest``.

    A channel of a slower logger, which has samples at some of the stamps only, has longer steps of its own.
    """
    out = np.full((len(y), grid.size), np.nan)
    for row, samples in zip(out, y, strict=True):
        there = np.isfinite(samples)
        own = t[there]
        if own.size < 2:
            continue
        right = np.clip(np.searchsorted(own, grid), 1, own.size - 1)
        # a lost stamp leaves two steps between its neighbours, plus or minus the jitter
        near = own[right] - own[right - 1] <= max(longest, 1.5 * float(np.median(np.diff(own))))
        near &= (grid > own[0] - longest) & (grid < own[-1] + longest)
        row[near] = np.interp(grid[near], own, samples[there])
    return out
