r"""Sinusoid fitted near a line of a Fourier transform, with a test whether it is a tone.

A sinusoid at k + δ lines of a record's Fourier transform gives the lines around it

.. math:: X_{k+m} = a\,\frac{e^{2\pi i\delta} - 1}{2\pi i(\delta - m)}

and nothing else: after subtraction with the best a and δ only the background remains. A lightly damped mode
also has a sharp peak, but of random shape, so that most of it remains. The ratio

.. math:: D = a^H R^{-1} a / \max_{1\le|m|\le 4} r_m^H R^{-1} r_m, \qquad r_m = X_{k+m} - \hat X_{k+m},

with R the covariance between channels of the surrounding lines, distinguishes the two. For a mode at 0.3 Hz
in ten minutes D is above 25 in 5 % of records if ζ = 0.2 % and in 0.1 % if ζ = 0.5 %; it was above 90 in none
of 4,500 records.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array

LINES = 4
"""Number of lines on either side whose residual is tested; the peak of a mode would extend over them."""
MIN_LINES = 12
"""Fewest lines that give the covariance of the background."""
LINES_PER_CHANNEL = 1.5
"""Lines per channel for that covariance, if that is more."""
REACH = 2
"""Number of lines on either side with most of a tone's leakage; they are excluded from the background until
the tone is subtracted."""
RIDGE = 1e-3
"""Share of each channel's power added to the covariance of the background, which may be singular."""
MAX_OFFSET = 0.7
"""Largest distance of the frequency from the strongest line, in lines."""
OFFSETS = 21
"""Number of frequencies tried, and again between the neighbours of the best."""
ITERATIONS = 3
"""Number of fits, each with the background left by the previous one."""


@dataclass(frozen=True)
class Sinusoid:
    """Best sinusoid near a line of the transform.

    Attributes
    ----------
    position : float
        Frequency in lines.
    ratio : float
        D of the channel in which it is largest.
    """

    position: float
    ratio: float


def transform(
    y: FloatArray, precision: type[np.complex64] | type[np.complex128] = np.complex128
) -> ComplexArray:
    """Return the Fourier transforms of samples (n_channels, n_samples), missing ones (NaN) as zero.

    In single precision a long record takes half of the memory; each line is as accurate as its own size.
    """
    out = np.empty((len(y), y.shape[1] // 2 + 1), dtype=precision)
    for row, lines in zip(y, out, strict=True):  # one at a time: copies of a day's channels take memory
        lines[:] = fft.rfft(np.where(np.isfinite(row), row, 0.0))
    return out


def sinusoid(spectrum: ComplexArray, k: int) -> Sinusoid:
    """Fit one sinusoid of all channels to the lines around line k of their transforms."""
    reach = lines_around(len(spectrum))
    m = np.arange(-reach, reach + 1)
    lines = spectrum[:, k + m]
    root = _root(lines[:, np.abs(m) > REACH])

    for _ in range(ITERATIONS):
        white = np.asarray(np.linalg.solve(root, lines), dtype=complex)

        delta = _offset(white, m)
        shape = _leakage(delta, m)
        amplitude = lines @ shape.conj() / np.sum(np.abs(shape) ** 2)
        rest = lines - amplitude[:, None] * shape
        root = _root(rest[:, m != 0])
    power = np.sum(np.abs(np.linalg.solve(root, amplitude)) ** 2)
    near = rest[:, (m != 0) & (np.abs(m) <= LINES)]
    around = np.sum(np.abs(np.linalg.solve(root, near)) ** 2, axis=0)
    return Sinusoid(k + delta, float(power / max(around.max(), 1e-300)))


def _leakage(delta: float | FloatArray, m: Int64Array) -> ComplexArray:
    """Return the values at lines m of a unit sinusoid δ lines off, (…, n_lines)."""
    away = np.asarray(delta)[..., None] - m
    return np.asarray(np.exp(1j * np.pi * away) * np.sinc(away))


def _offset(white: ComplexArray, m: Int64Array) -> float:
    """Return the δ of the sinusoid that explains most of the whitened lines (n_channels, n_lines)."""
    delta = np.linspace(-MAX_OFFSET, MAX_OFFSET, OFFSETS)
    for _ in range(2):
        shape = _leakage(delta, m)
        explained = np.sum(np.abs(white @ shape.conj().T) ** 2, axis=0) / np.sum(np.abs(shape) ** 2, axis=1)
        k = min(max(int(np.argmax(explained)), 1), OFFSETS - 2)
        step, (before, most, after) = delta[1] - delta[0], explained[k - 1 : k + 2]
        middle = delta[k]
        delta = np.linspace(middle - step, middle + step, OFFSETS)
    bend = before - 2.0 * most + after
    # at an end of the range a parabola would extrapolate
    return float(middle + (np.clip(0.5 * (before - after) / bend, -1.0, 1.0) * step if bend < 0.0 else 0.0))


def lines_around(n_channels: int) -> int:
    """Return the number of lines on either side from which the background is estimated."""
    return max(MIN_LINES, int(np.ceil(LINES_PER_CHANNEL * n_channels)))


def _root(lines: ComplexArray) -> ComplexArray:
    """Return the Cholesky factor of the covariance of lines (n_channels, n_lines)."""
    return np.asarray(np.linalg.cholesky(regularised(lines @ lines.conj().T / lines.shape[1])))


def regularised(covariance: ComplexArray) -> ComplexArray:
    """Return covariances made regular, (…, n_channels, n_channels)."""
    channel = np.arange(covariance.shape[-1])
    power = covariance[..., channel, channel].real
    out = covariance.copy()
    out[..., channel, channel] += RIDGE * power + 1e-12 * power.mean(axis=-1, keepdims=True) + 1e-300
    return out
