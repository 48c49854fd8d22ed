"""Tell the tones of a rotor from modes by the statistics of their envelopes.

The envelope of a mode driven by random forces wanders as that of a Gaussian process; that of a tone does
not (Jacobsen, Andersen & Brincker 2007 use the kurtosis for the same purpose).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import fft, signal

from jackettwin.identification.steady_tones import less_phase

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

HALF_WIDTH = 0.02
"""Half width of the band around a candidate, as a share of its frequency …"""
FEWEST_LINES = 4.0
"""… and at least this many Fourier lines."""
DRIFT = 0.2
"""Half width of the band in which a drifting tone is looked for, as a share of its frequency."""
SIDEBANDS = 6.0
"""Lines of the record by which it is wider still: a tone that wanders has sidebands."""
SMOOTH_CYCLES = 4.0
"""Cycles over which the instantaneous frequency is averaged."""
FOLLOWED_CYCLES = 30.0
"""Cycles over which the phase of a drifting tone is smoothed by a cubic."""
EDGE = 0.15
"""The range a tone sweeps is wider than where it is for 98 % of the time by this share on either side."""
STEADY = 0.25
"""Largest relative variance of the squared envelope of a tone; 1 for a Gaussian process."""


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
    return _relative_variance(_analytic(y, sample_rate_hz, frequency_hz, half, shape))


def is_tone(y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray) -> bool:
    """Return whether a candidate is a tone, steady or drifting, rather than a mode."""
    if envelope_variance(y, sample_rate_hz, frequency_hz, shape) < STEADY:
        return True
    return is_drifting_tone(y, sample_rate_hz, frequency_hz, shape)


def is_drifting_tone(y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray) -> bool:
    """Return whether a candidate is what is left of a tone that passed it, as the rotor's speed drifted."""
    return swept_hz(y, sample_rate_hz, frequency_hz, shape) is not None


def swept_hz(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray
) -> tuple[float, float] | None:
    """Return the range of frequencies of the tone that passed a candidate, None if none did.

    In a band wide enough for the drift such a tone has a steady envelope, and its instantaneous frequency,
    smoothed over a few cycles, takes the candidate's on the way. A steady tone beside a mode makes the
    envelope steady as well, but never comes near the mode's frequency.
    """
    a = _analytic(y, sample_rate_hz, frequency_hz, DRIFT * frequency_hz, shape)
    if _relative_variance(a) >= STEADY:
        return None
    turn = a[1:] * a[:-1].conj()
    length = max(round(SMOOTH_CYCLES * sample_rate_hz / frequency_hz), 1)
    smooth = np.convolve(turn, np.full(length, 1.0 / length), mode="valid")
    f = np.angle(smooth) * sample_rate_hz / (2.0 * np.pi)
    low, high = np.percentile(f, [1.0, 99.0])
    if not low <= frequency_hz <= high:
        return None
    beyond = EDGE * (high - low) + SIDEBANDS * sample_rate_hz / y.shape[1]
    return float(low - beyond), float(high + beyond)


def without_unsteady_tone(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray
) -> FloatArray:
    """Return samples less a tone of steady amplitude and slowly drifting frequency.

    Its phase is that of the analytic signal in the band of the drift, smoothed over many cycles so that it
    does not follow the noise beside the tone.
    """
    phase = np.unwrap(np.angle(_analytic(y, sample_rate_hz, frequency_hz, DRIFT * frequency_hz, shape)))
    window = min(round(FOLLOWED_CYCLES * sample_rate_hz / frequency_hz), (len(phase) - 1) // 2) | 1
    return less_phase(y, signal.savgol_filter(phase, max(window, 5), 3, mode="interp"))


def _analytic(
    y: FloatArray, sample_rate_hz: float, frequency_hz: float, half_hz: float, shape: ComplexArray
) -> ComplexArray:
    """Return the analytic signal of the channels projected on a shape, in a band around a frequency."""
    lines = fft.fft(shape.conj() @ np.where(np.isfinite(y), y, 0.0))
    f = fft.fftfreq(y.shape[1], 1.0 / sample_rate_hz)
    return np.asarray(fft.ifft(np.where(np.abs(f - frequency_hz) <= half_hz, lines, 0.0)))


def _relative_variance(analytic: ComplexArray) -> float:
    power = np.abs(analytic) ** 2
    return float(np.var(power) / np.mean(power) ** 2)
