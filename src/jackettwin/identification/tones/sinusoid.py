r"""The best sinusoid near a line of a Fourier transform, and whether it is a tone.

A sinusoid at k + δ lines of a record's Fourier transform gives the lines around it

.. math:: X_{k+m} = a\,\frac{e^{2\pi i\delta} - 1}{2\pi i(\delta - m)}

and no more: less the best such a and δ, the lines are those of the background. A lightly damped mode has
a sharp peak as well, but one of random shape, of which a large part stays. The ratio

.. math:: D = a^H R^{-1} a / \max_{1\le|m|\le 4} r_m^H R^{-1} r_m, \qquad r_m = X_{k+m} - \hat X_{k+m},

R the covariance between channels of the lines around, tells them apart: in ten minutes of a mode at 0.3 Hz
it is above 25 in 5 % of records if ζ = 0.2 %, in 0.1 % if ζ = 0.5 %, and in none of 4,500 above 90.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray, Int64Array

LINES = 4
"""Lines on either side that a mode would fill as well …"""
FEWEST_LINES = 12
"""… and the least number that gives the covariance of the background, …"""
LINES_A_CHANNEL = 1.5
"""… or so many for each channel, if that is more."""
REACH = 2
"""Lines on either side on which a tone leaks most: no background where none is subtracted."""
LIFT = 1e-3
"""Share of each channel's power added to the covariance of the background, which may be singular."""
FARTHEST = 0.7
"""Largest distance of the frequency from the strongest line, in lines."""
OFFSETS = 21
"""Number of frequencies that are tried, and again between the neighbours of the best."""
ROUNDS = 3
"""Number of fits, each with the background that the previous one leaves."""


@dataclass(frozen=True)
class Sinusoid:
    """The best sinusoid near a line of the transform.

    Attributes
    ----------
    position : float
        Frequency in lines.
    ratio : float
        D, of the channel in which it is largest.
    """

    position: float
    ratio: float


def transform(y: FloatArray) -> ComplexArray:
    """Return the Fourier transforms of samples (n_channels, n_samples), missing ones (NaN) as zero."""
    return np.asarray(fft.rfft(np.where(np.isfinite(y), y, 0.0), axis=1))


def sinusoid(spectrum: ComplexArray, k: int) -> Sinusoid:
    """Fit one sinusoid of all channels to the lines around line k of their transforms."""
    reach = lines_around(len(spectrum))
    m = np.arange(-reach, reach + 1)
    lines = spectrum[:, k + m]
    root = _root(lines[:, np.abs(m) > REACH])

    for _ in range(ROUNDS):
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
    """Return what a unit sinusoid δ lines off gives the lines m, (…, n_lines)."""
    away = np.asarray(delta)[..., None] - m
    return np.asarray(np.exp(1j * np.pi * away) * np.sinc(away))


def _offset(white: ComplexArray, m: Int64Array) -> float:
    """Return the δ of the sinusoid that explains most of whitened lines (n_channels, n_lines)."""
    delta = np.linspace(-FARTHEST, FARTHEST, OFFSETS)
    for _ in range(2):
        shape = _leakage(delta, m)
        explained = np.sum(np.abs(white @ shape.conj().T) ** 2, axis=0) / np.sum(np.abs(shape) ** 2, axis=1)
        k = min(max(int(np.argmax(explained)), 1), OFFSETS - 2)
        step, (before, most, after) = delta[1] - delta[0], explained[k - 1 : k + 2]
        middle = delta[k]
        delta = np.linspace(middle - step, middle + step, OFFSETS)
    bend = before - 2.0 * most + after
    # where most is explained at an end, a parabola would go on far beyond
    return float(middle + (np.clip(0.5 * (before - after) / bend, -1.0, 1.0) * step if bend < 0.0 else 0.0))


def lines_around(n_channels: int) -> int:
    """Return how many lines on either side make the background."""
    return max(FEWEST_LINES, int(np.ceil(LINES_A_CHANNEL * n_channels)))


def _root(lines: ComplexArray) -> ComplexArray:
    """Return the Cholesky factor of the covariance of lines (n_channels, n_lines)."""
    return np.asarray(np.linalg.cholesky(regular(lines @ lines.conj().T / lines.shape[1])))


def regular(covariance: ComplexArray) -> ComplexArray:
    """Return regular covariances (…, n_channels, n_channels)."""
    channel = np.arange(covariance.shape[-1])
    power = covariance[..., channel, channel].real
    out = covariance.copy()
    out[..., channel, channel] += LIFT * power + 1e-12 * power.mean(axis=-1, keepdims=True) + 1e-300
    return out
