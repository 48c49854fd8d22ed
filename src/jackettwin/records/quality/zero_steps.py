r"""Steps in the zero of a channel, from one level to another.

The sum :math:`S_k = \sum_{j \le k} (y_j - \bar y)` of a vibration stays small, as its velocity does.
A step of its zero by a at sample k adds a triangle of height a k (n − k)/n. A step is accepted if it explains
most of the slow motion, which neither a drift nor a few slow oscillations do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.findings import Finding
from jackettwin.records.processing.filters import bridge
from jackettwin.records.record import Record
from jackettwin.signals import of_fast_length

SLOW = 20
"""Cycles in the record below which motion is slow."""
EXPLAINED = 0.85
"""Smallest share of the slow power that a step must explain;
the best step explains 0.75 of a linear drift."""
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


def zero_step(y: FloatArray) -> ZeroStep | None:
    """Return the step of the zero of a channel, None if it has none.

    Parameters
    ----------
    y : (n_samples,)
        NaN marks a missing sample.

    Examples
    --------
    >>> y = np.sin(0.3 * np.arange(3000.0))
    >>> y[1000:] += 2.0
    >>> step = zero_step(y)
    >>> abs(step.at - 1000) < 10, round(step.by, 1)
    (True, 2.0)
    """
    n, there = len(y), np.isfinite(y)
    if n < 10 * SLOW or there.mean() < 0.5:
        return None
    x = bridge(y)
    x = x - x.mean()
    k = np.arange(1, n)
    inside = (k > END_SHARE * n) & (k < (1.0 - END_SHARE) * n)
    # reduction of the sum of squares by a step at each sample
    gain = np.where(inside, np.cumsum(x)[:-1] ** 2 * n / (k * (n - k)), 0.0)
    at = int(k[np.argmax(gain)])
    by = float(x[at:].mean() - x[:at].mean())
    rest = x - np.where(np.arange(n) >= at, by, 0.0)
    rms = float(rest.std())
    if rms == 0.0 or abs(by) < MIN_STEP_SIZE * rms:
        return None
    slow = [float(np.sum(np.abs(np.fft.rfft(of_fast_length(s - s.mean()))[1:SLOW]) ** 2)) for s in (x, rest)]
    if slow[1] > (1.0 - EXPLAINED) * slow[0]:
        return None
    return ZeroStep(at, by, abs(by) / rms)


def without_step(y: FloatArray, step: ZeroStep, sample_rate_hz: float) -> FloatArray:
    """Return a channel with its step removed and samples around it missing."""
    out = y.copy()
    out[step.at :] -= step.by
    gap = max(round(GAP_S * sample_rate_hz), 3)
    out[max(step.at - gap, 0) : step.at + gap] = np.nan
    return out


def zeros_in_line(record: Record) -> tuple[Record, tuple[Finding, ...]]:
    """Remove zero steps of accelerations and velocities; steps that most channels share are only reported."""
    data, findings, at = record.data, [], []
    rows = [i for i, c in enumerate(record.channels) if c.quantity in ("acceleration", "velocity")]
    for i in rows:
        step = zero_step(record.data[i])
        if step is not None:
            data = record.data.copy() if data is record.data else data
            data[i] = without_step(record.data[i], step, record.sample_rate_hz)
            params = {"size": step.over_rms, "time_s": step.at / record.sample_rate_hz}
            findings.append(Finding("zero_steps", record.channels[i].name, params))
            at.append(params["time_s"])
    if len(at) > 0.5 * len(rows):
        findings.insert(0, Finding("zero_steps_together", params={"time_s": float(np.median(at))}))
    return replace(record, data=data) if findings else record, tuple(findings)
