r"""Delays between channels and their change in time, from the phases between channels.

Where two points of a structure move together they do so in phase or in antiphase:
the phase of their cross spectrum is 0 or π, and twice that phase is 0. A clock that is late by τ adds
:math:`-2\pi f\tau` over *all* bands in which they move together. No mode does so, since the phase of a
complex mode is limited to its own band. The delay of channel i behind channel j is therefore where

.. math:: J_{ij}(\tau) = \sum_b w_{ij,b}\,\cos 2(\varphi_{ij,b} + 2\pi f_b\tau), \qquad
          w = \frac{\gamma^2}{1-\gamma^2+\varepsilon}

is largest (generalised correlation of the doubled phase with weights of the maximum-likelihood kind:
Knapp & Carter 1976). :math:`R = J(\tau)/\sum w` is the share of the phases that it explains.
The *change* of a delay follows from the phases of one window relative to another,
which do not depend on the modes and need no doubling.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.records.processing.spectra import hann_lines
from jackettwin.signals import next_fast_len, of_fast_length

MIN_LINES = 4
"""Fewest lines over which a cross spectrum is averaged; the coherence of independent lines is then biased by
a quarter, which is corrected."""
MIN_SAMPLES = 200
"""Shortest record that is examined, in samples."""
WANTED_BINS = 12
"""Number of frequency bins that takes precedence over the number of windows."""
MAX_BINS = 80
"""Most frequency bins; in a wide band more lines are averaged instead."""
CYCLES_PER_WINDOW = 7.0
"""Length of a window in cycles of the lower edge of the band; shorter ones have too few lines."""
WINDOWS = (4, 20)
"""Fewest and most windows."""
BAND = (0.05, 0.98)
"""Shares of the power above the noise floor below the lower and the upper edge of the band."""
BELOW, ABOVE = 0.7, 1.5
"""Factors by which the band is then extended: modes of little power also have clear phases."""
FLOOR = 3.0
"""Noise floor of a channel over its median line; five per cent of noise lines exceed it."""
MIN_COHERENCE = 0.3
"""Squared coherence below which a bin is ignored."""
WEIGHT_OFFSET = 0.1
"""ε, which limits the weight of a bin to ten times that at half coherence."""
MIN_BINS = 6
"""Fewest bins that distinguish a delay from a constant phase."""
MAX_PHASE_DELAY_S = 3.0
"""Longest delay sought by phases, if bins are narrow enough."""
MAX_BIN_TURNS = 0.25
"""Largest phase change over the width of a bin, in turns, for such a delay;
longer delays are corrected first."""
MAX_DELAY_SHARE = 0.1
"""Longest delay sought at all, as a share of the record."""
SUB_BANDS = 8
"""Number of sub-bands; the sign of a mode may differ between them."""
MIN_LONG_DELAY_SUM = 45.0
"""Threshold of the sum over the sub-bands, a gamma variable of order 8 that exceeds this once in 10¹¹
delays."""
LONG_OVER_SHORT = 2.0
"""Smallest ratio of the sum at a long delay to that at any short one."""
DELAYS_PER_LINE = 2
"""Number of delays tried per line of the band."""
STEPS_PER_PERIOD = 24.0
"""Steps of the search per period of the highest bin."""
FEWEST_DELAYS = 3
"""Fewest delays within the search; of a record with a sample in half a minute none is."""


@dataclass(frozen=True)
class BandLines:
    """Normalised lines of the channels' spectra in the band of most power.

    Attributes
    ----------
    unit : (n_channels, n_lines) complex
    present : (n_channels,)
        Share of the samples outside faded gaps, where they are zero: the lines of a shorter motion depend on
        one another, and so many fewer are summed.
    duration_s : float
        Duration of the samples.
    """

    unit: ComplexArray
    present: FloatArray
    duration_s: float


@dataclass(frozen=True)
class Phases:
    """Coherencies of all pairs of channels in frequency bins and time windows.

    Attributes
    ----------
    frequency_hz : (n_bins,)
    coherency : (n_windows, n_bins, n_pairs) complex
    weight : (n_bins, n_pairs)
    pairs : (n_pairs, 2)
        Pairs with i < j; the phase is that of i relative to j.
    bin_hz : float
        Width of a bin.
    log_amplitude : (n_windows, n_bins, n_channels)
        Logarithm of the rms of every channel.
    """

    frequency_hz: FloatArray
    coherency: ComplexArray
    weight: FloatArray
    pairs: IntArray
    bin_hz: float
    log_amplitude: FloatArray

    @property
    def search_s(self) -> FloatArray:
        """Delays that are tried, (n_delays,)."""
        most = min(MAX_PHASE_DELAY_S, MAX_BIN_TURNS / self.bin_hz)
        step = 1.0 / (STEPS_PER_PERIOD * self.frequency_hz[-1])
        n = int(most / step)
        return np.asarray(step * np.arange(-n, n + 1))

    @property
    def total(self) -> FloatArray:
        """Sums of the weights, (n_pairs,)."""
        return np.asarray(self.weight.sum(axis=0))


def phases(y: FloatArray, sample_rate_hz: float, turn: ComplexArray) -> Phases | None:
    """Return the phases between channels; None if the record is too short, or too slow for a delay.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean, without gaps.
    turn : (n_channels,) complex
        Factors that convert each channel to the phase of acceleration: i for a velocity.
    """
    n = y.shape[1]
    if n < MIN_SAMPLES:
        return None
    used = of_fast_length(y).shape[1]
    low_hz, high_hz = (edge * sample_rate_hz / used for edge in _band(y))
    most = min(low_hz / CYCLES_PER_WINDOW, (high_hz - low_hz) / (MIN_LINES * WANTED_BINS))
    windows = int(np.clip(n / sample_rate_hz * most, *WINDOWS))
    length = n // windows
    df = sample_rate_hz / length
    first = max(int(low_hz / df), 2)
    wanted = int(high_hz / df) - first
    each = max(MIN_LINES, -(-wanted // MAX_BINS))
    bins = wanted // each
    if bins < MIN_BINS:
        return None
    kept = slice(first, first + bins * each)
    pairs = np.stack(np.triu_indices(len(y), 1), axis=1)
    coherency, log_amplitude = _coherency(y, windows, kept, each)
    coherency *= (turn[:, None] * turn.conj())[pairs[:, 0], pairs[:, 1]]
    g = np.mean(np.abs(coherency) ** 2, axis=0)
    g = np.clip((each * g - 1.0) / (each - 1.0), 0.0, 1.0)
    weight = np.where(g > MIN_COHERENCE, g / (1.0 - g + WEIGHT_OFFSET), 0.0)
    f = df * (first + each * np.arange(bins) + 0.5 * (each - 1))
    found = Phases(f, coherency, weight, pairs, each * df, log_amplitude)
    return found if found.search_s.size >= FEWEST_DELAYS else None


def _band(y: FloatArray) -> tuple[float, float]:
    """Return the edges, in lines, of the band that contains most of the power of every channel."""
    share: FloatArray | float = 0.0
    for lines in hann_lines(y):
        power = np.abs(lines) ** 2
        power = np.maximum(power - FLOOR * np.median(power), 0.0)
        share = share + power / max(float(power.sum()), np.finfo(float).tiny) / len(y)
    passed = np.cumsum(share)
    low, high = (float(np.searchsorted(passed, part)) for part in BAND)
    return BELOW * low, min(ABOVE * high, 0.9 * (passed.size - 1))


def _coherency(y: FloatArray, windows: int, kept: slice, each: int) -> tuple[ComplexArray, FloatArray]:
    """Return coherencies of pairs in windows and bins, and the logarithm of amplitudes."""
    length = y.shape[1] // windows
    taper = np.hanning(length)
    i, j = np.triu_indices(len(y), 1)
    coherency, amplitude = [], []
    for k in range(windows):
        part = y[:, k * length : (k + 1) * length]
        lines = np.fft.rfft((part - part.mean(axis=1, keepdims=True)) * taper, axis=1)[:, kept]
        lines = lines.reshape(len(y), -1, each)
        size = np.sqrt(np.sum(np.abs(lines) ** 2, axis=2, keepdims=True))
        lines = lines / np.where(size > 0.0, size, 1.0)
        coherency.append(np.einsum("pbm,pbm->bp", lines[i], lines[j].conj()))
        amplitude.append(size[:, :, 0].T)
    return np.array(coherency), np.log(np.maximum(np.array(amplitude), np.finfo(float).tiny))


def aligned(seen: Phases, delay_s: FloatArray) -> Phases:
    """Return the phases after correction of the channels' delays.

    Parameters
    ----------
    delay_s : (n_channels,) or (n_windows, n_channels)
    """
    late = np.atleast_2d(delay_s)
    between = late[:, seen.pairs[:, 0]] - late[:, seen.pairs[:, 1]]
    turn = np.exp(2j * np.pi * seen.frequency_hz[None, :, None] * between[:, None, :])
    return replace(seen, coherency=seen.coherency * turn)


def doubled(seen: Phases) -> ComplexArray:
    """Return weights with doubled mean phases over time, (n_bins, n_pairs)."""
    mean = seen.coherency.mean(axis=0)
    size = np.abs(mean)
    return np.asarray(seen.weight * (mean / np.where(size > 0.0, size, 1.0)) ** 2)


def objective(seen: Phases, z: ComplexArray, delay_s: FloatArray, times: float = 2.0) -> FloatArray:
    """Return J of every pair at some delays, (n_delays, n_pairs).

    Parameters
    ----------
    z : (n_bins, n_pairs)
        Weights times phase factors, at a multiple of the phases between the channels.
    """
    turn = np.exp(2j * np.pi * times * np.outer(delay_s, seen.frequency_hz))
    return np.asarray((turn @ z).real)


def trajectories(seen: Phases) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the change of each pair's delay since the first window, and its certainty.

    Each window is compared with the sum of the corrected windows before it, up to a sign:
    a sensor may reverse during the record.

    Returns
    -------
    delay_s : (n_windows, n_pairs)
    explained : (n_windows, n_pairs)
        Share of the weight explained by that change of delay: 1 if it is a pure delay.
    sign : (n_windows, n_pairs)
        −1 where one of the two is reversed relative to the first window.
    """
    search = seen.search_s
    out = np.zeros((len(seen.coherency), len(seen.pairs)))
    explained, signs = np.ones_like(out), np.ones_like(out)
    total = np.where(seen.total > 0.0, seen.total, 1.0)
    sum_ = seen.coherency[0].copy()
    for k in range(1, len(out)):
        against = seen.coherency[k] * sum_.conj()
        size = np.abs(against)
        z = seen.weight * against / np.where(size > 0.0, size, 1.0)
        j = objective(seen, z, search, 1.0)
        sign = np.where(j.max(axis=0) >= -j.min(axis=0), 1.0, -1.0)
        out[k], value = refined_peak(search, sign * j)
        explained[k], signs[k] = value / total, sign
        sum_ += sign * seen.coherency[k] * np.exp(2j * np.pi * np.outer(seen.frequency_hz, out[k]))
    return out, explained, signs


def gain_trajectories(seen: Phases) -> FloatArray:
    """Return the logarithmic change of each pair's amplitude ratio in every window, (n_windows, n_pairs).

    This is the weighted median over the bins, since in each bin the ratio of two channels is that of one
    mode.
    """
    i, j = seen.pairs.T
    ratio = seen.log_amplitude[:, :, i] - seen.log_amplitude[:, :, j]
    ratio = ratio - np.median(ratio, axis=0)
    order = np.argsort(ratio, axis=1)
    weight = np.broadcast_to(seen.weight, ratio.shape)
    passed = np.cumsum(np.take_along_axis(weight, order, axis=1), axis=1)
    middle = np.argmax(passed >= 0.5 * passed[:, -1:], axis=1)[:, None]
    return np.asarray(np.take_along_axis(np.take_along_axis(ratio, order, axis=1), middle, axis=1)[:, 0])


def refined_peak(search_s: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return position and height of the largest value of each column, by a parabola through three.

    >>> x = np.linspace(-1.0, 1.0, 9)
    >>> place, height = refined_peak(x, 1.0 - (x[:, None] - 0.1) ** 2)
    >>> place.round(9), height.round(9)
    (array([0.1]), array([1.]))
    """
    at = np.clip(values.argmax(axis=0), 1, len(values) - 2)
    columns = np.arange(values.shape[1])
    left, top, right = (values[at + d, columns] for d in (-1, 0, 1))
    bend = left - 2.0 * top + right
    move = np.clip(
        np.where(bend < 0.0, 0.5 * (left - right) / np.where(bend < 0.0, bend, -1.0), 0.0), -1.0, 1.0
    )
    step = search_s[1] - search_s[0]
    return np.asarray(search_s[at] + move * step), np.asarray(top - 0.25 * (left - right) * move)


def band_lines(y: FloatArray, sample_rate_hz: float) -> BandLines | None:
    """Return the lines in the band of most power; None if the record is too short for a delay.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean, without gaps.
    """
    low, high = (round(edge) for edge in _band(y))
    if high - low < SUB_BANDS * MIN_LINES:
        return None
    lines = np.array([row[low:high] for row in hann_lines(y)])
    lines /= np.where(np.abs(lines) > 0.0, np.abs(lines), 1.0)
    present = np.count_nonzero(y, axis=1) / y.shape[1]
    return BandLines(lines, present, of_fast_length(y).shape[1] / sample_rate_hz)


def in_common(lines: BandLines, pairs: IntArray) -> tuple[FloatArray, Iterator[FloatArray]]:
    r"""Return delays and, for each pair, the coherence sum at each of them.

    .. math:: T(\tau) = \sum_s n_s\left|\frac1{n_s}\sum_{k\in s} e^{i\varphi_k + 2\pi i f_k\tau}\right|^2

    over the lines k of sub-bands s, with the phase of the cross spectrum alone (Knapp & Carter 1976).
    For independent channels it is a gamma variable, whatever their spectra.

    Returns
    -------
    delay_s : (n_delays,)
        Delays of the first channel of a pair behind the second.
    sums : iterator over (n_delays,)
    """
    unit = lines.unit
    size = int(2 ** np.ceil(np.log2(DELAYS_PER_LINE * unit.shape[1])))
    delay = np.fft.fftfreq(size, 1.0 / size) * lines.duration_s / size
    edges = np.linspace(0, unit.shape[1], SUB_BANDS + 1).astype(int)
    return delay, (_sum(unit[i] * unit[j].conj(), edges, size) for i, j in pairs)


def _sum(cross: ComplexArray, edges: IntArray, size: int) -> FloatArray:
    """Return the sum at ``size`` delays, from the lagged products within sub-bands."""
    short = next_fast_len(2 * int(np.diff(edges).max()))
    parts = (cross[first:last] for first, last in pairwise(edges))
    powers = sum(np.abs(np.fft.ifft(part, short)) ** 2 / len(part) for part in parts)
    return np.asarray(np.fft.irfft(np.fft.rfft(np.asarray(powers)) * short, size) * size)


def long_delays(
    lines: BandLines | None, pairs: IntArray, near_s: float, longest: float = MAX_DELAY_SHARE
) -> tuple[FloatArray, FloatArray]:
    """Return delays of the pairs beyond ``near_s``, 0 where there is none, and their weights.

    Delays up to the share ``longest`` of the record are tried; without lines there are none.

    Returns
    -------
    delay_s, weight : (n_pairs,)
        Weight; 0 for pairs that are independent at all delays.
    """
    out, weight = np.zeros(len(pairs)), np.zeros(len(pairs))
    if lines is None:
        return out, weight
    delay, sums = in_common(lines, pairs)
    far = np.abs(delay) < longest * lines.duration_s
    near = np.abs(delay) <= near_s
    for pair, sum_ in enumerate(sums):
        best = int(np.argmax(np.where(far, sum_, 0.0)))
        if sum_[best] > MIN_LONG_DELAY_SUM / lines.present[pairs[pair]].min():
            weight[pair] = sum_[best]
            if not near[best] and sum_[best] > LONG_OVER_SHORT * sum_[near].max():
                out[pair] = delay[best]
    return out, weight
