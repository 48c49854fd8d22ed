"""Zero-phase filters on arrays in which NaN marks a missing sample: a gap stays a gap.

Missing samples are never replaced by numbers. Slow parts are weighted means of the samples present.
Low-pass filters bridge a gap by a straight line, and an output is missing if bridges carry
more than ``MISSING_WEIGHT`` of the filter. Bridges of at most half an output step are ignored,
since the passed signal hardly changes over so short a time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from scipy import ndimage

from jackettwin import signals
from jackettwin.arrays import BoolArray, FloatArray

if TYPE_CHECKING:
    from collections.abc import Iterable

STOPBAND_DB = 80.0
"""Attenuation beyond the stop edge [dB]; the pass-band ripple is 1e-4."""
MISSING_WEIGHT = 0.1
"""Share of a low-pass filter's absolute weight that may fall on bridged samples."""
FADE = 1.0 / 40.0
"""Length over which samples beside a long gap are faded out, as a share of the record: half a period of
motion with twenty cycles, the slowest that is compared between channels."""
SHORT_GAP = 1.0 / 2000.0
"""Longest gap that is bridged instead, as a share of the record: a hundredth of that period."""


def remove_line(y: FloatArray) -> FloatArray:
    """Subtract each row's least-squares line, fitted to its finite samples.

    >>> remove_line(np.array([[1.0, np.nan, 3.0, 4.0]])).round(12)
    array([[ 0., nan,  0.,  0.]])
    """
    finite = np.isfinite(y)
    if finite.all():
        return _less_line(y)
    count = np.maximum(finite.sum(axis=1, keepdims=True), 1)
    t = np.where(finite, np.linspace(-1.0, 1.0, y.shape[1]), 0.0)
    t = np.where(finite, t - t.sum(axis=1, keepdims=True) / count, 0.0)
    x = np.where(finite, y, 0.0)
    x = np.where(finite, x - x.sum(axis=1, keepdims=True) / count, np.nan)
    power = np.sum(t * t, axis=1, keepdims=True)
    slope = np.sum(t * np.where(finite, x, 0.0), axis=1, keepdims=True) / np.where(power > 0.0, power, 1.0)
    out: FloatArray = x - slope * t
    return out


def _less_line(y: FloatArray) -> FloatArray:
    """Subtract the least-squares line of rows without gaps, in a fifth of the time that gaps need."""
    t = np.linspace(-1.0, 1.0, y.shape[1])
    power = float(t @ t)
    out: FloatArray = y - y.mean(axis=1, keepdims=True) if y.size else y.copy()
    if power > 0.0:
        for row, slope in zip(out, out @ t / power, strict=True):
            row -= slope * t
    return out


def remove_slow(y: FloatArray, cutoff: float) -> FloatArray:
    """High-pass by subtracting a Gaussian-weighted moving mean of the finite samples.

    The amplitude gain is ``1 − (1 − 1/√2)^((f/cutoff)²)``: 0.707 at the cutoff, 0.993 at twice the
    cutoff, 0.012 at a tenth of it, and phase zero. Near the ends and beside gaps the mean runs over
    the samples that exist, so nothing is lost there.

    Parameters
    ----------
    y : (n_channels, n_samples) array
    cutoff : float
        Cycles per sample.
    """
    sigma = np.sqrt(-np.log(1.0 - np.sqrt(0.5)) / 2.0) / (np.pi * cutoff)
    half = min(int(np.ceil(5.0 * sigma)), y.shape[1] - 1)
    kernel = np.exp(-0.5 * (np.arange(-half, half + 1) / sigma) ** 2)
    out = remove_line(y)
    same, summed = slice(half, half + y.shape[1]), signals.convolution(kernel, y.shape[1])
    of_all = summed(np.ones(y.shape[1]))[same]
    for x in out:  # row by row, as every term is as long as a channel
        finite = np.isfinite(x)
        weight = of_all if finite.all() else summed(finite.astype(float))[same]
        # At a finite sample the weight is at least the kernel's centre, 1.
        x -= summed(np.where(finite, x, 0.0))[same] / np.where(finite, weight, 1.0)
    return out


def lowpass_taps(pass_edge: float, stop_edge: float) -> FloatArray:
    """Symmetric Kaiser-window FIR of odd length with unit gain at zero frequency.

    Parameters
    ----------
    pass_edge, stop_edge : float
        Cycles per sample.
    """
    return signals.lowpass_taps(pass_edge, stop_edge, STOPBAND_DB)


def resample(y: FloatArray, taps: FloatArray, up: int = 1, down: int = 1) -> FloatArray:
    """Filter with symmetric ``taps`` at ``up`` times the rate and keep every ``down``-th sample.

    Output sample k belongs to input time ``k·down/up``: sample 0 keeps its time. The ends are
    extended by point reflection over half the filter.

    Parameters
    ----------
    y : (n_channels, n_samples) array
        Rows longer than ``half_length(taps, up)``.
    taps : (odd,) array
        Unit gain at zero frequency, designed at the raised rate.
    """
    pad = half_length(taps, up)
    half = len(taps) // 2
    lead = -(pad * up + half) % down
    padded_taps = np.concatenate([np.zeros(lead), taps])
    kept = {"first": (pad * up + half + lead) // down, "n_out": (y.shape[1] - 1) * up // down + 1}

    def filtered(rows: Iterable[FloatArray], weights: FloatArray, kind: Literal["odd", "even"]) -> FloatArray:
        padded = (np.pad(row, pad, mode="reflect", reflect_type=kind) for row in rows)
        return signals.resample(padded, y.shape[1] + 2 * pad, weights, up, down, **kept)

    out = filtered(map(bridge, y), up * padded_taps, "odd")
    finite = np.isfinite(y)
    if not finite.all():
        missing = _long_gaps(~finite, shortest=down // (2 * up) + 1)
        lost = filtered(missing.astype(float), up * np.abs(padded_taps) / np.abs(taps).sum(), "even")
        out[lost > MISSING_WEIGHT] = np.nan
    return out


def half_length(taps: FloatArray, up: int = 1) -> int:
    """Return the number of input samples on either side that one output of ``resample`` uses."""
    return -(-(len(taps) // 2) // up)


def _long_gaps(missing: BoolArray, *, shortest: int) -> BoolArray:
    """Keep only runs of at least ``shortest`` missing samples."""
    if shortest <= 1 or not missing.any():
        return missing
    line = np.ones((1, shortest), dtype=np.bool_)
    padded = np.pad(missing, ((0, 0), (shortest, shortest)), constant_values=False)
    opened: BoolArray = ndimage.binary_opening(padded, structure=line)
    return opened[:, shortest:-shortest]


def fade_weight(y: FloatArray) -> FloatArray:
    """Return the weight of every sample, (n_samples,): 0 in long gaps of any row, rising to 1 beside them.

    The line that joins the ends of a long gap is slow motion, and the corners at both ends are pulses: in
    records with a gap in common, the same pulses in every channel, the length of the gap apart.

    Parameters
    ----------
    y : (n_channels, n_samples)
        NaN marks a missing sample; a row without any counts as one without gaps.

    Examples
    --------
    >>> y = np.ones((1, 400))
    >>> y[0, 100:140] = np.nan
    >>> fade_weight(y)[[0, 94, 99, 100, 139, 140, 145, 399]].round(2).tolist()
    [1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 1.0]
    """
    n = y.shape[1]
    weight = np.ones(n)
    reach = int(FADE * n)
    rise = np.sin(0.5 * np.pi * np.arange(reach) / max(reach, 1)) ** 2
    for row in y:
        missing = ~np.isfinite(row)
        if not missing.any() or missing.all():
            continue
        for start, length in signals.runs(missing):
            if length <= SHORT_GAP * n:
                continue
            end = start + length
            weight[start:end] = 0.0
            for beside in (weight[max(start - reach, 0) : start][::-1], weight[end : end + reach]):
                np.minimum(beside, rise[: len(beside)], out=beside)
    return weight


def bridge(y: FloatArray) -> FloatArray:
    """Join the ends of every gap of one row by a line; a row without any sample becomes zero."""
    finite = np.isfinite(y)
    if finite.all():
        return y
    if not finite.any():
        return np.zeros_like(y)
    t = np.arange(len(y))
    out: FloatArray = np.interp(t, t[finite], y[finite])
    return out
