r"""Steps in the zero of a channel, from one level to another.

The sum :math:`S_k = \sum_{j \le k} (y_j - \bar y)` of a vibration stays small, as its velocity does.
A step of its zero by a at sample k adds a triangle of height a k (n − k)/n. One to three steps are accepted
if they explain most of the slow motion, which they do of neither a drift nor a few slow oscillations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.findings import Finding
from jackettwin.records.record import Record
from jackettwin.signals import of_fast_length

SLOW = 20
"""Cycles in the record below which motion is slow."""
MOST_STEPS, UNEXPLAINED = 3, 0.6
"""Most steps of a channel, and the share of the slow power that k steps may leave, times (k + 1)²: the best k
steps leave 1/(k + 1)² of a linear drift."""
MIN_STEP_SIZE = 0.5
"""Smallest size of a step over the rms of the rest."""
END_SHARE = 0.05
"""Share of the record at each end in which a step cannot be told from a trend."""
GAP_S = 0.5
"""Time on each side of a step that becomes missing, at least three samples [s]."""


@dataclass(frozen=True)
class ZeroStep:
    """A channel whose zero rises by some amount at a sample."""

    at: int
    by: float
    over_rms: float


def zero_steps(y: FloatArray) -> tuple[ZeroStep, ...]:
    """Return the steps of the zero of a channel, in the order of time; none if a drift explains as much.

    Parameters
    ----------
    y : (n_samples,)
        NaN marks a missing sample.

    Examples
    --------
    >>> y = np.sin(0.3 * np.arange(3000.0))
    >>> y[1000:] += 2.0
    >>> y[2000:] -= 3.0
    >>> first, second = zero_steps(y)
    >>> abs(first.at - 1000) < 10, round(first.by, 1), abs(second.at - 2000) < 10, round(second.by, 1)
    (True, 2.0, True, -3.0)
    """
    there = np.flatnonzero(np.isfinite(y))
    if len(y) < 10 * SLOW or len(there) < 0.5 * len(y):
        return ()
    # without the gaps: a line across one has the level of its two ends
    x = y[there] - y[there].mean()
    n = len(x)
    slow = _slow_power(x)
    ends = [0, n]
    for number in range(1, MOST_STEPS + 1):
        splits = [_best_split(x, a, b, round(END_SHARE * n)) for a, b in pairwise(ends)]
        ends = sorted([*ends, max(splits)[1]])
        levels = np.array([x[a:b].mean() for a, b in pairwise(ends)])
        rest = x - np.repeat(levels, np.diff(ends))
        rms, by = float(rest.std()), np.diff(levels)
        if rms == 0.0 or np.abs(by).min() < MIN_STEP_SIZE * rms:
            return ()
        if _slow_power(rest) <= UNEXPLAINED / (number + 1) ** 2 * slow:
            return tuple(
                ZeroStep(int(there[at]), float(one), abs(float(one)) / rms)
                for at, one in zip(ends[1:-1], by, strict=True)
            )
    return ()


def _best_split(x: FloatArray, start: int, stop: int, least: int) -> tuple[float, int]:
    """Return by how much one step within a stretch reduces the sum of squares at most, and its sample."""
    own, n = x[start:stop] - x[start:stop].mean(), stop - start
    k = np.arange(1, n)
    inside = (k > least) & (k < n - least)
    gain = np.where(inside, np.cumsum(own)[:-1] ** 2 * n / (k * (n - k)), 0.0)
    best = int(np.argmax(gain))
    return float(gain[best]), start + best + 1


def _slow_power(x: FloatArray) -> float:
    return float(np.sum(np.abs(np.fft.rfft(of_fast_length(x - x.mean()))[1:SLOW]) ** 2))


def without_steps(y: FloatArray, steps: Sequence[ZeroStep], sample_rate_hz: float) -> FloatArray:
    """Return a channel with its steps removed and samples around them missing."""
    out = y.copy()
    gap = max(round(GAP_S * sample_rate_hz), 3)
    for step in steps:
        out[step.at :] -= step.by
    for step in steps:
        out[max(step.at - gap, 0) : step.at + gap] = np.nan
    return out


def zeros_in_line(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Remove zero steps of accelerations and velocities; steps that most channels share are only reported."""
    data, findings, at = record.data, [], []
    rows = [i for i, c in enumerate(record.channels) if c.quantity in ("acceleration", "velocity")]
    for i in rows:
        steps = zero_steps(record.data[i])
        if steps:
            data = record.data.copy() if data is record.data else data
            data[i] = without_steps(record.data[i], steps, record.sample_rate_hz)
            at.append(steps[0].at / record.sample_rate_hz)
        for step in steps:
            params = {"size": step.over_rms, "time_s": step.at / record.sample_rate_hz}
            findings.append(Finding("zero_steps", record.channels[i].name, params))
    if len(at) > 0.5 * len(rows):
        findings.insert(0, Finding("zero_steps_together", params={"time_s": float(np.median(at))}))
    return replace(record, data=data) if findings else record, tuple(findings)
