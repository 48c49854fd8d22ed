r"""Delays between channels, and how they change in time, from the phases between channels.

A structure moves in phase or in antiphase wherever two of its points move together: the phase of their
cross spectrum is 0 or π, twice it is 0. A clock that is late by τ adds :math:`-2\pi f\tau` over *all* bands
in which they move together, which no mode does: the phase of a complex mode is of its own band. So the delay
of channel i behind channel j is where

.. math:: J_{ij}(\tau) = \sum_b w_{ij,b}\,\cos 2(\varphi_{ij,b} + 2\pi f_b\tau), \qquad
          w = \frac{\gamma^2}{1-\gamma^2+\varepsilon}

is largest (generalised correlation of the doubled phase, with weights of the maximum-likelihood kind: Knapp &
Carter 1976), and :math:`R = J(\tau)/\sum w` says how much of the phases it explains. How a delay *changes* is
told by the phases of one stretch of time against another, which are free of what the modes do: there no phase
needs doubling.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.records.processing.spectra import hann_lines
from jackettwin.signals import next_fast_len

FEWEST_LINES = 4
"""Lines over which a cross spectrum is averaged at least: the coherence of independent lines is biased by a
quarter, and that is taken back."""
SHORTEST = 200
"""Samples of a record that is looked at."""
WANTED_BINS = 12
"""Of frequency, rather than more windows."""
MOST_BINS = 80
"""Of frequency: more lines are averaged in a wide band."""
CYCLES_A_WINDOW = 7.0
"""Of the lower edge of the band: shorter windows hold too few lines of it."""
WINDOWS = (4, 20)
"""Fewest and most stretches of time."""
BAND = (0.05, 0.98)
"""Shares of the power over the noise floor below the lower edge of the band, and below another line …"""
BELOW, ABOVE = 0.7, 1.5
"""… from and to which it reaches a little farther: modes of little power have clear phases, too."""
FLOOR = 3.0
"""Over the median line, for a channel's noise floor: five per cent of noise lines are above."""
LEAST_COHERENCE = 0.3
"""Squared coherence below which a bin says nothing."""
DULL = 0.1
"""ε: no bin counts more than ten times as much as one of half the coherence."""
FEWEST_BINS = 6
"""Fewer do not tell a delay from a phase."""
FARTHEST_S = 3.0
"""Delays looked for by phases, where bins are narrow enough …"""
FARTHEST_BIN = 0.25
"""… up to this share of a turn over the width of a bin. Longer ones are brought into this range first, …"""
LONGEST_SHARE = 0.1
"""… up to this share of the record."""
SUB_BANDS = 8
"""In each of which a mode's sign may be another."""
IMPROBABLE = 45.0
"""Sum over the sub-bands, a gamma variable of order 8 that exceeds this once in 10¹¹ delays."""
OUTSHINES = 2.0
"""So many times must the sum at a long delay exceed that at any short one."""
FINE_COARSE = 2
"""Delays tried for each line of the band."""
FINE = 24.0
"""Steps of the search in a period of the highest bin."""


@dataclass(frozen=True)
class BandLines:
    """Lines of the channels' spectra in the band of most power, each of unit size.

    Attributes
    ----------
    unit : (n_channels, n_lines) complex
    duration_s : float
        Of the samples they are of.
    """

    unit: ComplexArray
    duration_s: float


@dataclass(frozen=True)
class Phases:
    """Coherencies of all pairs of channels, in bins of frequency and windows of time.

    Attributes
    ----------
    frequency_hz : (n_bins,)
    coherency : (n_windows, n_bins, n_pairs) complex
    weight : (n_bins, n_pairs)
    pairs : (n_pairs, 2)
        i < j; the phase is that of i over j.
    bin_hz : float
        Width of a bin.
    log_amplitude : (n_windows, n_bins, n_channels)
        Logarithm of the root of the power of every channel.
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
        most = min(FARTHEST_S, FARTHEST_BIN / self.bin_hz)
        step = 1.0 / (FINE * self.frequency_hz[-1])
        n = int(most / step)
        return np.asarray(step * np.arange(-n, n + 1))

    @property
    def total(self) -> FloatArray:
        """Sum of the weights, (n_pairs,)."""
        return np.asarray(self.weight.sum(axis=0))


def phases(y: FloatArray, sample_rate_hz: float, turn: ComplexArray) -> Phases | None:
    """Return the phases between channels; None if the record is too short to tell.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean, without gaps.
    turn : (n_channels,) complex
        What brings each channel into the phase of an acceleration: i for a velocity.
    """
    n = y.shape[1]
    if n < SHORTEST:
        return None
    lines, used = hann_lines(y)
    low_hz, high_hz = (edge * sample_rate_hz / used for edge in _band(lines))
    most = min(low_hz / CYCLES_A_WINDOW, (high_hz - low_hz) / (FEWEST_LINES * WANTED_BINS))
    windows = int(np.clip(n / sample_rate_hz * most, *WINDOWS))
    length = n // windows
    df = sample_rate_hz / length
    first = max(int(low_hz / df), 2)
    wanted = int(high_hz / df) - first
    each = max(FEWEST_LINES, -(-wanted // MOST_BINS))
    bins = wanted // each
    if bins < FEWEST_BINS:
        return None
    kept = slice(first, first + bins * each)
    pairs = np.stack(np.triu_indices(len(y), 1), axis=1)
    coherency, log_amplitude = _coherency(y, windows, kept, each)
    coherency *= (turn[:, None] * turn.conj())[pairs[:, 0], pairs[:, 1]]
    g = np.mean(np.abs(coherency) ** 2, axis=0)
    g = np.clip((each * g - 1.0) / (each - 1.0), 0.0, 1.0)
    weight = np.where(g > LEAST_COHERENCE, g / (1.0 - g + DULL), 0.0)
    f = df * (first + each * np.arange(bins) + 0.5 * (each - 1))
    return Phases(f, coherency, weight, pairs, each * df, log_amplitude)


def _band(lines: ComplexArray) -> tuple[float, float]:
    """Return the edges of the band that holds most of the power of every channel, in lines."""
    power = np.abs(lines) ** 2
    power = np.maximum(power - FLOOR * np.median(power, axis=1, keepdims=True), 0.0)
    total = power.sum(axis=1, keepdims=True)
    passed = np.cumsum(np.mean(power / np.where(total > 0.0, total, 1.0), axis=0))
    low, high = (float(np.searchsorted(passed, share)) for share in BAND)
    return BELOW * low, min(ABOVE * high, 0.9 * (lines.shape[1] - 1))


def _coherency(y: FloatArray, windows: int, kept: slice, each: int) -> tuple[ComplexArray, FloatArray]:
    """Return the coherency of pairs in windows and bins of so many lines, and the logarithm of amplitudes."""
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
    """Return the phases after the channels' delays are taken back.

    Parameters
    ----------
    delay_s : (n_channels,) or (n_windows, n_channels)
    """
    late = np.atleast_2d(delay_s)
    between = late[:, seen.pairs[:, 0]] - late[:, seen.pairs[:, 1]]
    turn = np.exp(2j * np.pi * seen.frequency_hz[None, :, None] * between[:, None, :])
    return replace(seen, coherency=seen.coherency * turn)


def doubled(seen: Phases) -> ComplexArray:
    """Return the weights with twice the phases of the mean over time, (n_bins, n_pairs)."""
    mean = seen.coherency.mean(axis=0)
    size = np.abs(mean)
    return np.asarray(seen.weight * (mean / np.where(size > 0.0, size, 1.0)) ** 2)


def objective(seen: Phases, z: ComplexArray, delay_s: FloatArray, times: float = 2.0) -> FloatArray:
    """Return J of every pair at some delays, (n_delays, n_pairs).

    Parameters
    ----------
    z : (n_bins, n_pairs)
        Weights with phases, which are so many times those between the channels.
    """
    turn = np.exp(2j * np.pi * times * np.outer(delay_s, seen.frequency_hz))
    return np.asarray((turn @ z).real)


def trajectories(seen: Phases) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return how much later each pair is in every window than in the first, and how well that is known.

    Each window is held against the sum of those before it, brought into step, whatever its sign: a sensor may
    be turned while the record runs.

    Returns
    -------
    delay_s : (n_windows, n_pairs)
    explained : (n_windows, n_pairs)
        Share of the weight that moved on by that delay: 1 if it is nothing but a delay.
    sign : (n_windows, n_pairs)
        −1 where one of the two is turned against the first window.
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
    """Return ln of how much larger channel i is against j in every window than usual, (n_windows, n_pairs).

    The weighted median over the bins: the ratio of two channels is that of one mode in each of them.
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
    """Return place and height of the largest value of each column, by a parabola through three.

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
    """Return the lines in the band of most power; None if the record is too short to tell a delay.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean, without gaps.
    """
    lines, used = hann_lines(y)
    low, high = (round(edge) for edge in _band(lines))
    if high - low < SUB_BANDS * FEWEST_LINES:
        return None
    lines = lines[:, low:high]
    return BandLines(lines / np.where(np.abs(lines) > 0.0, np.abs(lines), 1.0), used / sample_rate_hz)


def in_common(lines: BandLines, pairs: IntArray) -> tuple[FloatArray, Iterator[FloatArray]]:
    r"""Return delays and, pair after pair, how much its channels have in common at each of them.

    .. math:: T(\tau) = \sum_s n_s\left|\frac1{n_s}\sum_{k\in s} e^{i\varphi_k + 2\pi i f_k\tau}\right|^2

    over the lines k of sub-bands s, with the phase of the cross spectrum alone (Knapp & Carter 1976): of
    independent channels a gamma variable, whatever their spectra are.

    Returns
    -------
    delay_s : (n_delays,)
        Of the first channel of a pair behind the second.
    sums : iterator over (n_delays,)
    """
    unit = lines.unit
    size = int(2 ** np.ceil(np.log2(FINE_COARSE * unit.shape[1])))
    delay = np.fft.fftfreq(size, 1.0 / size) * lines.duration_s / size
    edges = np.linspace(0, unit.shape[1], SUB_BANDS + 1).astype(int)
    return delay, (_sum(unit[i] * unit[j].conj(), edges, size) for i, j in pairs)


def _sum(cross: ComplexArray, edges: IntArray, size: int) -> FloatArray:
    """Return the sum at ``size`` delays: its squares are series in the lags within sub-bands, which add."""
    short = next_fast_len(2 * int(np.diff(edges).max()))
    parts = (cross[first:last] for first, last in pairwise(edges))
    powers = sum(np.abs(np.fft.ifft(part, short)) ** 2 / len(part) for part in parts)
    return np.asarray(np.fft.irfft(np.fft.rfft(np.asarray(powers)) * short, size) * size)


def long_delays(
    lines: BandLines | None, pairs: IntArray, near_s: float, longest: float = LONGEST_SHARE
) -> tuple[FloatArray, FloatArray]:
    """Return delays of the pairs beyond ``near_s``, 0 where there is none, and their weights.

    Delays up to the share ``longest`` of the record are tried; no lines tell of none.

    Returns
    -------
    delay_s, weight : (n_pairs,)
        The weight is 0 for pairs that are independent at all delays.
    """
    out, weight = np.zeros(len(pairs)), np.zeros(len(pairs))
    if lines is None:
        return out, weight
    delay, sums = in_common(lines, pairs)
    far = np.abs(delay) < longest * lines.duration_s
    near = np.abs(delay) <= near_s
    for pair, sum_ in enumerate(sums):
        best = int(np.argmax(np.where(far, sum_, 0.0)))
        if sum_[best] > IMPROBABLE:
            weight[pair] = sum_[best]
            if not near[best] and sum_[best] > OUTSHINES * sum_[near].max():
                out[pair] = delay[best]
    return out, weight
