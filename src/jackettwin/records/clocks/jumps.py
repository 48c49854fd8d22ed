"""Jumps in short series, one per channel, from one level or line to another."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.intervals import NORMAL_OF_MAD

SIGMAS = 6.0
"""Change in standard deviations of the scatter between windows above which it is a jump."""


@dataclass(frozen=True)
class SeriesJump:
    """A jump of some series between two runs of windows.

    Attributes
    ----------
    rows : tuple of int
        Series that jump.
    by : (n_series,)
        Level after minus level before, of all series.
    before, after : int
        Last window (excluded) of the run before and first window of the run after.
    """

    rows: tuple[int, ...]
    by: FloatArray
    before: int
    after: int


def scatter(series: FloatArray) -> FloatArray:
    """Return the standard deviation of each series in a window, from differences between windows.

    Parameters
    ----------
    series : (n_windows, n_series)
    """
    changes = np.diff(series, axis=0)
    spread = np.median(np.abs(changes - np.median(changes, axis=0)), axis=0)
    return np.asarray(NORMAL_OF_MAD * spread / np.sqrt(2.0))


def lines(series: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Theil's slope of each series, (n_series,), and the misfits, (n_windows, n_series)."""
    n = len(series)
    i, j = np.triu_indices(n, 1)
    slope = np.median((series[j] - series[i]) / (j - i)[:, None], axis=0)
    rest = series - slope * np.arange(n)[:, None]
    return np.asarray(slope), np.asarray(rest - np.median(rest, axis=0))


def runs(series: FloatArray, reach: float) -> list[tuple[int, int]]:
    """Return first and last window (excluded) of the runs between which a series leaves its line.

    Examples
    --------
    >>> runs(np.repeat([[0.0], [1.0]], [4, 6], axis=0), 0.1)
    [(0, 4), (4, 10)]
    """
    tolerance = _tolerance(series, reach)
    _, rest = lines(series)
    change = np.diff(series, axis=0)
    change = change - np.median(change, axis=0)
    # a line follows half of a jump in the middle
    off = np.abs(rest).max(axis=0) > 0.5 * tolerance
    broken = 1 + np.flatnonzero((off & (np.abs(change) > tolerance)).any(axis=1))
    edges = [0, *(int(k) for k in broken), len(series)]
    return [(a, b) for a, b in pairwise(edges) if b > a]


def series_jumps(series: FloatArray, between: list[tuple[int, int]], reach: float) -> list[SeriesJump]:
    """Return the jumps between runs; a run of one window is the window of a jump.

    A clock does not jump back. A series that does, after one window or a whole run, has two delays that
    explain the phases equally well, and neither jump is reported.
    """
    tolerance = _tolerance(series, reach)
    kept = [run for run in between if run[1] - run[0] > 1] or between
    single = np.array([run[0] for run in between if run not in kept], dtype=np.intp)
    level = np.array([np.median(series[slice(*run)], axis=0) for run in kept])
    returning = _returning(np.diff(level, axis=0), tolerance)
    out = []
    for k, (before, after) in enumerate(pairwise(kept)):
        old, new = level[k], level[k + 1]
        by = new - old
        other = np.where(single[:, None] < after[0], new, old)
        back = (np.abs(series[single] - other) < tolerance).any(axis=0)
        rows = tuple(int(i) for i in np.flatnonzero((np.abs(by) > tolerance) & ~back & ~returning[k]))
        if rows:
            out.append(SeriesJump(rows, by, before[1], after[0]))
    return out


def _returning(by: FloatArray, tolerance: FloatArray) -> BoolArray:
    """Return which jumps the next one of the same series undoes, or undo the last, (n_jumps, n_series).

    >>> _returning(np.array([[0.02], [-0.021], [0.3]]), np.array([0.005])).ravel()
    array([ True,  True, False])
    """
    clear = np.abs(by) > tolerance
    undone = clear[1:] & clear[:-1] & (np.abs(by[1:] + by[:-1]) < tolerance)
    out = np.zeros(by.shape, dtype=bool)
    out[:-1] |= undone
    out[1:] |= undone
    return out


def _tolerance(series: FloatArray, reach: float) -> FloatArray:
    """Return the smallest difference of each series that is a jump."""
    return np.asarray(np.maximum(reach, SIGMAS * scatter(series)))
