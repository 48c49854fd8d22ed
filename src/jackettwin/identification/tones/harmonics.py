r"""Tell the tones of a rotor from modes by the statistics of their envelopes.

The envelope of a mode driven by random forces wanders as that of a Gaussian process; that of a tone does
not (Jacobsen, Andersen & Brincker 2007 use the kurtosis for the same purpose). How far it wanders in a record
is itself random: of n independent values the relative variance of the squared envelope falls below

.. math:: v_n = e^{-6/\sqrt n}

in one record of two thousand (Gaussian modes of ζfT from 0.4 to 180, the smallest of three bands).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft, signal

from jackettwin.records.tones import less_phase

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

HALF_WIDTH = 0.02
"""Half width of the band around a candidate, as a share of its frequency …"""
FEWEST_LINES = 4.0
"""… and at least this many Fourier lines."""
DRIFTS = (0.05, 0.1, 0.2)
"""Half widths of the bands in which a drifting tone is looked for, as shares of its frequency: the narrower
holds less of the modes beside it, the wider more of the drift."""
SIDEBANDS = 6.0
"""Lines of the record by which it is wider still: a tone that wanders has sidebands."""
SMOOTH_CYCLES = 4.0
"""Cycles over which the instantaneous frequency is averaged."""
FOLLOWED_CYCLES = 30.0
"""Cycles over which the phase of a drifting tone is smoothed by a cubic."""
FEWEST_WINDOWS = 6
"""Windows of that smoothing in a record, at least: speeds that go up and down twice in it are followed."""
SMOOTHED = 2
"""Times it is smoothed: once lets 1 % of what is faster pass."""
EDGE = 0.15
"""The range a tone sweeps is wider than where it is for 98 % of the time by this share on either side."""
STEADY = 0.25
"""Largest relative variance of the squared envelope of a steady tone; 1 for a Gaussian process."""
SPREAD = 6.0
"""Of v_n."""
LEAST_HALF_BANDWIDTH = 0.9
"""In lines: a pole of a lesser one is not told from a tone, and counts as if it had this."""


@dataclass(frozen=True)
class Sweep:
    """Frequencies a drifting tone passed, and the half width of the band it was found in [Hz]."""

    low_hz: float
    high_hz: float
    half_hz: float


def envelope_variance(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray
) -> float:
    r"""Return the relative variance of the squared envelope in a narrow band around a candidate.

    .. math:: v = \mathrm{var}(|a|^2) / \mathrm{mean}(|a|^2)^2

    with a the analytic signal of the channels projected on the shape: 1 for a Gaussian process that is
    observed for long, 0 for a steady tone.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample and counts as zero.
    shape : (n_channels,) complex
    """
    half = max(HALF_WIDTH * frequency_hz, FEWEST_LINES * sample_rate_hz / y.shape[1])
    return relative_variance(_analytic(y, sample_rate_hz, frequency_hz, half, shape))


def least_variance(n: float) -> float:
    """Return v_n, below which the envelope of n independent values is not that of a mode.

    Examples
    --------
    >>> [round(least_variance(n), 2) for n in (5, 20, 100)]
    [0.07, 0.26, 0.55]
    """
    return float(np.exp(-SPREAD / np.sqrt(n)))


def is_steady_tone(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, damping_ratio: float, shape: ComplexArray
) -> bool:
    """Return whether a candidate is a steady tone rather than a mode.

    Independent values there are no more than lines in the band, nor than 2πζfT of a mode of that damping.
    """
    line = sample_rate_hz / y.shape[1]
    lines = 2.0 * max(HALF_WIDTH * frequency_hz / line, FEWEST_LINES)
    peak = 2.0 * np.pi * max(damping_ratio * frequency_hz / line, LEAST_HALF_BANDWIDTH)
    most = min(STEADY, least_variance(1.0 / np.hypot(1.0 / lines, 1.0 / peak)))
    return envelope_variance(y, sample_rate_hz, frequency_hz, shape) < most


def drifting_tone(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray
) -> Sweep | None:
    """Return the tone that passed a candidate as the rotor's speed drifted, None if none did.

    In a band that holds the drift such a tone has a steadier envelope than a Gaussian process of as many
    independent values, which are counted from the lines the power is spread over; and its instantaneous
    frequency, smoothed over a few cycles, takes the candidate's on the way. A steady tone beside a mode
    makes the envelope steady as well, but has few lines and never comes near the mode's frequency.
    """
    clearest, out = 1.0, None
    for share in DRIFTS:
        half = share * frequency_hz
        a = _analytic(y, sample_rate_hz, frequency_hz, half, shape)
        ratio = relative_variance(a) / least_variance(_independent_values(a))
        if ratio < clearest:
            low, high = _passed_hz(a, sample_rate_hz, frequency_hz)
            if low <= frequency_hz <= high:
                beyond = EDGE * (high - low) + SIDEBANDS * sample_rate_hz / y.shape[1]
                clearest, out = ratio, Sweep(low - beyond, high + beyond, half)
    return out


def _passed_hz(analytic: ComplexArray, sample_rate_hz: float, frequency_hz: float) -> tuple[float, float]:
    """Return between which frequencies a signal is for 98 % of the time."""
    turn = analytic[1:] * analytic[:-1].conj()
    length = max(round(SMOOTH_CYCLES * sample_rate_hz / frequency_hz), 1)
    smooth = np.convolve(turn, np.full(length, 1.0 / length), mode="valid")
    low, high = np.percentile(np.angle(smooth) * sample_rate_hz / (2.0 * np.pi), [1.0, 99.0])
    return float(low), float(high)


def _independent_values(analytic: ComplexArray) -> float:
    """Return 2(Σp)²/Σp² of the powers of its lines, which of a Gaussian process scatter as exponentials."""
    power = np.abs(fft.fft(analytic)) ** 2
    return float(2.0 * np.sum(power) ** 2 / np.sum(power**2))


def without_unsteady_tone(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, half_hz: float, shape: ComplexArray
) -> FloatArray:
    """Return samples less a tone of steady amplitude and slowly drifting frequency.

    Its phase is that of the analytic signal in a band that holds the drift, smoothed over many cycles so that
    it does not follow the noise beside the tone.
    """
    phase = np.unwrap(np.angle(_analytic(y, sample_rate_hz, frequency_hz, half_hz, shape)))
    window = min(round(FOLLOWED_CYCLES * sample_rate_hz / frequency_hz), (len(phase) - 1) // 2) | 1
    return less_phase(y, signal.savgol_filter(phase, max(window, 5), 3, mode="interp"))


def _analytic(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, half_hz: float, shape: ComplexArray
) -> ComplexArray:
    """Return the analytic signal of the channels projected on a shape, in a band around a frequency."""
    lines = fft.fft(shape.conj() @ np.where(np.isfinite(y), y, 0.0))
    f = fft.fftfreq(y.shape[1], 1.0 / sample_rate_hz)
    return np.asarray(fft.ifft(np.where(np.abs(f - frequency_hz) <= half_hz, lines, 0.0)))


def relative_variance(analytic: ComplexArray) -> float:
    """Return the relative variance of a squared envelope."""
    power = np.abs(analytic) ** 2
    return float(np.var(power) / np.mean(power) ** 2)
