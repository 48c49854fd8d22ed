r"""Distinction of the tones of a rotor from modes by the statistics of their envelopes.

The envelope of a mode under random forces varies as that of a Gaussian process; that of a tone does not
(Jacobsen, Andersen & Brincker 2007 use the kurtosis for this purpose). How much it varies within a record is
itself random: with n independent values the relative variance of the squared envelope falls below

.. math:: v_n = e^{-6/\sqrt n}

in one of two thousand records (simulated Gaussian modes of ζfT from 0.4 to 180, smallest of three bands).
"""

from __future__ import annotations

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray

HALF_WIDTH = 0.02
"""Half width of the band around a candidate, as a share of its frequency."""
MIN_LINES = 4.0
"""Fewest Fourier lines in half a band."""
MAX_STEADY_VARIANCE = 0.25
"""Largest relative variance of the squared envelope of a steady tone; a Gaussian process has 1."""
VARIANCE_COEFFICIENT = 6.0
"""Coefficient in the exponent of v_n."""
MANY_VALUES = 12.0
"""2πζfT above which a mode is broader than a slightly drifting tone."""
BANDWIDTHS = 3.0
"""Half width, in half bandwidths, of the band in which the envelope of a lightly damped mode is judged."""
WANDERING = 5.0, 0.04
"""Half width, in half bandwidths and as a share of the frequency, of the band that a tone may wander over."""
SUSPICIOUS_VARIANCE = 0.3
"""Relative variance of the squared envelope in that band below which a lightly damped mode may be a tone."""
MIN_HALF_BANDWIDTH = 0.9
"""Smallest half bandwidth assumed for a pole, in lines."""


def envelope_variance(
    lines: ComplexArray, duration_s: float, frequency_hz: float, shape: ComplexArray
) -> float:
    r"""Return the relative variance of the squared envelope in a narrow band around a candidate.

    .. math:: v = \mathrm{var}(|a|^2) / \mathrm{mean}(|a|^2)^2

    with a the analytic signal of the channels projected on the shape;
    it is 1 for a long record of a Gaussian process and 0 for a steady tone.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transforms of the channels, from zero frequency.
    shape : (n_channels,) complex
    """
    half = max(HALF_WIDTH * frequency_hz, MIN_LINES / duration_s)
    return float(relative_variance(_analytic(lines, duration_s, frequency_hz, half, shape)))


def is_suspiciously_steady(
    lines: ComplexArray, duration_s: float, frequency_hz: float, damping_ratio: float, shape: ComplexArray
) -> bool:
    """Tell whether a mode has the envelope of a tone that varies and drifts.

    By chance, a fifth of simulated modes with 2πζfT = 3 have such an envelope, 7 % with 6 and 3 % with 11,
    and one in a thousand above. Of tones whose amplitude varies by 30 % and frequency by 0.5 to 1 %, at least
    three quarters have it. A tone that wanders by 1 to 3 % within ten seconds is as broad as a mode; the
    broader the band, the steadier it is.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transforms of the channels, from zero frequency.
    shape : (n_channels,) complex
    """
    line = 1.0 / duration_s
    bandwidth = damping_ratio * frequency_hz
    n = 2.0 * np.pi * bandwidth / line

    def variance(half_hz: float) -> float:
        half = max(half_hz, 0.5 * HALF_WIDTH * frequency_hz, MIN_LINES * line)
        return float(relative_variance(_analytic(lines, duration_s, frequency_hz, half, shape)))

    own = variance(BANDWIDTHS * bandwidth)
    if n <= MANY_VALUES and own < SUSPICIOUS_VARIANCE:
        return True
    bandwidths, share = WANDERING
    return min(own, variance(max(bandwidths * bandwidth, share * frequency_hz))) < least_variance(n)


def least_variance(n: float) -> float:
    """Return v_n, below which an envelope with n independent values is not that of a mode.

    Examples
    --------
    >>> [round(least_variance(n), 2) for n in (5, 20, 100)]
    [0.07, 0.26, 0.55]
    """
    return float(np.exp(-VARIANCE_COEFFICIENT / np.sqrt(n)))


def is_steady_tone(
    lines: ComplexArray, duration_s: float, frequency_hz: float, damping_ratio: float, shape: ComplexArray
) -> bool:
    """Tell whether a candidate is a steady tone and not a mode.

    The number of independent values is limited by the lines in the band and by 2πζfT of the mode.
    """
    line = 1.0 / duration_s
    n_lines = 2.0 * max(HALF_WIDTH * frequency_hz / line, MIN_LINES)
    peak = 2.0 * np.pi * max(damping_ratio * frequency_hz / line, MIN_HALF_BANDWIDTH)
    most = min(MAX_STEADY_VARIANCE, least_variance(1.0 / np.hypot(1.0 / n_lines, 1.0 / peak)))
    return envelope_variance(lines, duration_s, frequency_hz, shape) < most


def _analytic(
    lines: ComplexArray, duration_s: float, frequency_hz: float, half_hz: float, shape: ComplexArray
) -> ComplexArray:
    """Return the analytic signal of the channels projected on a shape, in a band around a frequency.

    The first line of the band becomes zero frequency. There are enough instants for the mean of the fourth
    power to be exact.
    """
    first = max(int(np.ceil((frequency_hz - half_hz) * duration_s)), 0)
    last = min(int((frequency_hz + half_hz) * duration_s), lines.shape[1] - 1)
    return np.asarray(fft.ifft(shape.conj() @ lines[:, first : last + 1], 2 * max(last - first + 1, 1)))


def relative_variance(analytic: ComplexArray) -> FloatArray:
    """Return the relative variance of a squared envelope, over the last axis."""
    power = np.abs(analytic) ** 2
    return np.asarray(np.var(power, axis=-1) / np.mean(power, axis=-1) ** 2)


def independent_values(lines: ComplexArray) -> FloatArray:
    """Return 2(Σp)²/Σp² of the powers of lines, which are exponentially distributed for a Gaussian process.

    Examples
    --------
    >>> float(independent_values(np.array([1.0, 1.0j, -1.0, 0.0])))
    6.0
    """
    power = np.abs(lines) ** 2
    return np.asarray(2.0 * np.sum(power, axis=-1) ** 2 / np.maximum(np.sum(power**2, axis=-1), 1e-300))
