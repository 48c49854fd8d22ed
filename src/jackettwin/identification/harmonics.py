"""Tell the tones of a rotor from modes by the statistics of their envelopes.

The envelope of a mode driven by random forces wanders as that of a Gaussian process; that of a tone does
not (Jacobsen, Andersen & Brincker 2007 use the kurtosis for the same purpose).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy import fft

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

HALF_WIDTH = 0.02
"""Half width of the band around a candidate, as a share of its frequency …"""
FEWEST_LINES = 4.0
"""… and at least this many Fourier lines."""
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
    n_samples = y.shape[1]
    modal = shape.conj() @ np.where(np.isfinite(y), y, 0.0)
    lines = fft.fft(modal)
    f = fft.fftfreq(n_samples, 1.0 / sample_rate_hz)
    half = max(HALF_WIDTH * frequency_hz, FEWEST_LINES * sample_rate_hz / n_samples)
    power = np.abs(fft.ifft(np.where(np.abs(f - frequency_hz) <= half, lines, 0.0))) ** 2
    return float(np.var(power) / np.mean(power) ** 2)


def is_tone(y: FloatArray, sample_rate_hz: float, frequency_hz: float, shape: ComplexArray) -> bool:
    """Return whether a candidate is a steady tone rather than a mode."""
    return envelope_variance(y, sample_rate_hz, frequency_hz, shape) < STEADY
