"""The few signal-processing functions that every record needs, as ``scipy.signal`` has them.

That package loads ``scipy.stats`` and, with it, half of SciPy: half a second of a command that takes two.
"""

from __future__ import annotations

from functools import cache
from itertools import count
from typing import TYPE_CHECKING, Literal

import numpy as np
import scipy  # scipy.ndimage is loaded where it is used

from jackettwin.arrays import BoolArray, FloatArray, Int64Array, IntArray

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


def hann(n: int) -> FloatArray:
    """Return the periodic Hann window of n samples, for transforms of segments."""
    return np.asarray(0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(n) / n))


def tukey(n: int, share: float) -> FloatArray:
    """Return a symmetric window of n samples that is 1 but for cosine tapers over a share of its length.

    >>> tukey(5, 0.5).round(12).tolist()
    [0.0, 1.0, 1.0, 1.0, 0.0]
    """
    edge = np.minimum(np.arange(n), np.arange(n)[::-1]) / (0.5 * share * (n - 1))
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.minimum(edge, 1.0)))


def lowpass_taps(pass_edge: float, stop_edge: float, attenuation_db: float) -> FloatArray:
    """Return a symmetric low-pass filter of odd length with unit gain at zero frequency, (n_taps,).

    A sinc under a Kaiser window, whose length and shape follow from the attenuation (Kaiser 1974; Oppenheim
    & Schafer, Discrete-Time Signal Processing, 3rd ed., eqs. (7.75), (7.76)).

    Parameters
    ----------
    pass_edge, stop_edge : float
        Cycles per sample.
    attenuation_db : float
        Beyond the stop edge; above 50 dB.
    """
    n = int(np.ceil((attenuation_db - 7.95) / (2.285 * 2.0 * np.pi * (stop_edge - pass_edge)) + 1.0)) | 1
    m = np.arange(n) - n // 2
    taps = np.sinc((pass_edge + stop_edge) * m) * np.kaiser(n, 0.1102 * (attenuation_db - 8.7))
    return np.asarray(taps / taps.sum())


@cache
def next_fast_len(n: int, *, real: bool = False) -> int:
    """Return the length from n on at which a Fourier transform is fast: 11 is its largest prime factor.

    Parameters
    ----------
    real : of real samples, whose transform is fast up to a factor of 5

    >>> next_fast_len(60001), next_fast_len(60001, real=True)
    (60025, 60750)
    """
    return next(k for k in count(n) if _is_smooth(k, 5 if real else 11))


@cache
def prev_fast_len(n: int) -> int:
    """Return the length up to n at which a Fourier transform is fast.

    >>> prev_fast_len(60001)
    60000
    """
    return next(k for k in count(n, -1) if _is_smooth(k, 11))


def of_fast_length(y: FloatArray) -> FloatArray:
    """Return samples, along the last axis, without the few at the end that slow down the transform.

    Ten minutes at 100 Hz, both ends included, are 60,001 = 29 · 2069 samples, whose transform takes ten times
    as long as that of 60,000. For windowed data or the slowest lines, the last samples do not matter.

    >>> of_fast_length(np.zeros((2, 60001))).shape
    (2, 60000)
    """
    return y[..., : prev_fast_len(max(y.shape[-1], 1))]


def _is_smooth(n: int, largest: int) -> bool:
    for prime in (2, 3, 5, 7, 11):
        while prime <= largest and n % prime == 0:
            n //= prime
    return n == 1


def convolution(taps: FloatArray, n: int) -> Callable[[FloatArray], FloatArray]:
    """Return the full convolution of a row of n samples with a filter, as a function of the row.

    One row at a time: the transforms of a day's channels would take gigabytes.

    >>> convolution(np.array([1.0, -1.0]), 3)(np.array([1.0, 0.0, 2.0])).round(12).tolist()
    [1.0, -1.0, 2.0, -2.0]
    """
    length = n + len(taps) - 1
    size = next_fast_len(length, real=True)
    response = np.fft.rfft(taps, size)
    return lambda row: np.asarray(np.fft.irfft(np.fft.rfft(row, size) * response, size)[:length])


def resample(
    rows: Iterable[FloatArray], n: int, taps: FloatArray, up: int, down: int, *, first: int, n_out: int
) -> FloatArray:
    r"""Filter rows of n samples at ``up`` times their rate and keep every ``down``-th, (n_rows, n_out).

    With :math:`h` the filter at the raised rate, :math:`z_k = \sum_m h_{k d - m u}\, y_m` for
    :math:`k` from ``first`` on. Outputs whose :math:`k d` leaves the same remainder :math:`p` by :math:`u`
    see the same taps :math:`h_p, h_{p+u}, …`, so each of the ``up`` phases is one convolution at the rate of
    the input.
    """
    phases = [divmod((first + start) * down, up) for start in range(min(up, n_out))]
    filters = [convolution(taps[p::up], n) for _, p in phases]
    out = []
    for row in rows:
        kept = np.empty(n_out)
        for start, ((m, _), filtered) in enumerate(zip(phases, filters, strict=True)):
            kept[start::up] = filtered(row)[m::down][: len(range(start, n_out, up))]
        out.append(kept)
    return np.array(out).reshape(-1, n_out)


def runs(mask: BoolArray) -> Int64Array:
    """Return start and length of every run of True.

    >>> runs(np.array([True, False, True, True])).tolist()
    [[0, 1], [2, 2]]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return np.column_stack([edges[::2], edges[1::2] - edges[::2]]).astype(np.int64)


def local_peaks(values: FloatArray, prominence: float = 0.0) -> IntArray:
    """Return where values are higher than on both sides, by ``prominence`` above the higher of two valleys.

    A valley reaches from the peak to the next higher value, or to the end. A flat top counts at its middle.

    >>> local_peaks(np.array([0.0, 3.0, 2.0, 2.5, 0.0, 1.0, 1.0, 0.0]), 0.75).tolist()
    [1, 5]
    """
    rise = np.diff(values)
    turns = np.flatnonzero(rise)  # a flat top lies between the last rise and the next fall
    tops = (rise[turns[:-1]] > 0.0) & (rise[turns[1:]] < 0.0)
    peaks = (turns[:-1][tops] + 1 + turns[1:][tops]) // 2
    if prominence <= 0.0 or not peaks.size:
        return np.asarray(peaks)
    return np.array(_standing_out(values, peaks, prominence), dtype=np.intp)


def _standing_out(values: FloatArray, peaks: IntArray, prominence: float) -> list[int]:
    """Return the peaks after a rise and before a fall by a prominence; those of one height count alike."""
    kept: list[int] = []
    tops: list[int] = []
    valleys = np.minimum.reduceat(
        values, np.append(0, peaks)
    ).tolist()  # before each peak, and after the last
    low, highest = valleys[0], -np.inf
    for k, value, after in zip(peaks.tolist(), values[peaks].tolist(), valleys[1:], strict=True):
        if value == highest:
            tops.append(k)
        elif value > highest and (tops or value - low >= prominence):
            highest, tops = value, [k]
        if not tops:
            low = min(low, after)
        elif highest - after >= prominence:
            kept += tops
            low, highest, tops = after, -np.inf, []
    return kept


def running_median(
    x: FloatArray, width: int, *, ends: Literal["nearest", "reflect"] = "nearest"
) -> FloatArray:
    """Return the running median along the last axis over an odd number of values.

    Row by row: SciPy's filter along one axis is up to thirty times as fast as that for several.

    Parameters
    ----------
    x : (..., n) array
    width : int
        Number of values; an even one is increased by one.
    ends : {"nearest", "reflect"}
        How values are continued at the ends.
    """
    rows = x.reshape(-1, x.shape[-1])
    return np.asarray([scipy.ndimage.median_filter(row, size=width | 1, mode=ends) for row in rows]).reshape(
        x.shape
    )
