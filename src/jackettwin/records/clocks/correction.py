r"""Correction of clock errors: lost time, delays, drifts and changes of sensitivity.

A band-limited signal is known between its samples, so that multiplying its transform by
:math:`e^{2\pi i f\tau}` shifts it exactly. The ends are extended by point reflection;
a gap remains, widened by the sample that the shift affects. For a drifting clock the delay grows,
and the signal is interpolated by a spline at four times the sample rate.
"""

from __future__ import annotations

import numpy as np
import scipy  # scipy.interpolate is loaded where it is used

from jackettwin.arrays import FloatArray
from jackettwin.records.clocks.results import LoggerClocks, LostTime
from jackettwin.records.processing.filters import bridge, remove_line

PAD = 256
"""Number of reflected samples at each end."""
OVERSAMPLING = 4
"""Oversampling before the spline: at least eight points per period."""
DEGREE = 5
"""Degree of the spline; its error is 3e-4 for a sine of eight points per period, 4e-6 of sixteen."""


def shifted_earlier(y: FloatArray, delay: float, growth: float = 0.0, bend: float = 0.0) -> FloatArray:
    """Return :math:`y(t + d + g t + b t^2)`, the samples of a channel that was late by that delay.

    Parameters
    ----------
    y : (n_samples,)
        NaN marks a missing sample.
    delay : float
        d, in samples.
    growth : float
        g, samples a sample.
    bend : float
        b, samples a squared sample.

    Returns
    -------
    (n_samples,)
        NaN where there is no sample.

    Examples
    --------
    >>> t = np.arange(1000.0)
    >>> late = np.sin(0.3 * (t - 2.6))
    >>> bool(np.allclose(shifted_earlier(late, 2.6)[300:700], np.sin(0.3 * t[300:700]), atol=1e-4))
    True
    """
    n = len(y)
    at = np.arange(n) * (1.0 + growth + bend * np.arange(n)) + delay
    line = bridge(y) - remove_line(bridge(y)[None, :])[0]
    pad = min(PAD, n - 1)
    padded = np.pad(bridge(y) - line, pad, mode="reflect", reflect_type="odd")
    if growth == 0.0 and bend == 0.0:
        moved = _turned(padded, delay - np.floor(delay))
        index = np.arange(n) + int(np.floor(delay)) + pad
        out = moved[np.clip(index, 0, len(moved) - 1)]
    else:
        fine = _finer(padded)
        place = np.arange(len(fine)) / OVERSAMPLING - pad
        out = scipy.interpolate.make_interp_spline(place, fine, k=DEGREE)(np.clip(at, place[0], place[-1]))
    out = out + np.interp(at, np.arange(n), line)
    missing = ~np.isfinite(y)
    below, above = np.floor(at).astype(int), np.ceil(at).astype(int)
    outside = (below < 0) | (above > n - 1)
    touched = missing[np.clip(below, 0, n - 1)] | missing[np.clip(above, 0, n - 1)]
    return np.asarray(np.where(outside | touched, np.nan, out))


def _turned(y: FloatArray, share: float) -> FloatArray:
    """Return the periodic signal shifted by a number of samples."""
    f = np.fft.rfftfreq(len(y))
    return np.asarray(np.fft.irfft(np.fft.rfft(y) * np.exp(2j * np.pi * f * share), len(y)))


def _finer(y: FloatArray) -> FloatArray:
    """Return the periodic signal at ``OVERSAMPLING`` times the rate."""
    return np.asarray(np.fft.irfft(np.fft.rfft(y), OVERSAMPLING * len(y)) * OVERSAMPLING)


def in_step(data: FloatArray, clocks: LoggerClocks, sample_rate_hz: float) -> FloatArray:
    """Return samples corrected for certain delays, NaN where no clock is known; ``data`` if all agree."""
    if clocks == LoggerClocks(stop=data.shape[1], judged=clocks.judged, jumps=clocks.jumps):
        return data
    data = data.copy()
    for i in (i for one in clocks.strangers if one.backwards for i in one.rows):
        data[i] = data[i, ::-1]
    for lost in clocks.lost:
        for i in lost.rows:
            data[i] = with_lost_samples(data[i], lost)
    out = data.copy()
    for late in clocks.late:
        if late.certain:
            for i in late.rows:
                delay, bend = late.delay_s * sample_rate_hz, late.bend / sample_rate_hz
                out[i] = shifted_earlier(data[i], delay, late.drift, bend)
    for jump in clocks.gains:
        rows = list(jump.rows)
        out[rows, : jump.start] /= jump.factor[0]
        out[rows, jump.stop :] /= jump.factor[1]
        out[rows, jump.start : jump.stop] = np.nan
    time = np.linspace(-0.5, 0.5, data.shape[1])
    for gain in clocks.growing:
        out[list(gain.rows)] *= np.exp(-gain.rate * time)
    out[:, : clocks.start] = np.nan
    out[:, clocks.stop :] = np.nan
    return out


def stretch(clocks: LoggerClocks, n_samples: int, sample_rate_hz: float) -> tuple[int, int]:
    """Return first and last sample (excluded) that all channels share once corrected."""
    ends = [
        late.delay_at(share * n_samples / sample_rate_hz) * sample_rate_hz
        for late in clocks.late
        if late.certain
        for share in np.linspace(0.0, 1.0, 17)
    ]
    first = max(clocks.start, int(np.ceil(-min(ends, default=0.0))))
    last = min(clocks.stop, n_samples - int(np.ceil(max(ends, default=0.0))))
    return max(first, 0), last


def with_lost_samples(y: FloatArray, lost: LostTime) -> FloatArray:
    """Return a channel with NaN inserted for lost samples; if the number is negative, samples are removed.

    >>> with_lost_samples(np.arange(8.0), LostTime((0,), 3, 4, 2))
    array([ 0.,  1.,  2., nan, nan, nan,  4.,  5.])
    """
    out = np.full_like(y, np.nan)
    out[: lost.start] = y[: lost.start]
    first = max(lost.stop, lost.stop - lost.samples)
    after = y[first : len(y) - max(lost.samples, 0)]
    at = first + lost.samples
    out[at : at + len(after)] = after
    return out
