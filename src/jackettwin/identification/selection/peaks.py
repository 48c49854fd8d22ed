"""Prominence of a mode over its surroundings, in frequency and in time, seen through its spatial filter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.signals import local_peaks

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate

MIN_PEAK_RATIO = 3.0
"""Smallest ratio of a peak in one channel to the median around it and to the minima beside it.
In noise averaged over fifteen half-overlapping segments one line in ten million exceeds it."""
MEDIAN_WIDTH, MIN_MEDIAN_LINES = 0.3, 21
"""Width of that median as a share of the frequency, and its fewest lines."""
BESIDE_HALF_BANDWIDTHS = (2.5, 8.0)
"""Range of distances from a mode, in half bandwidths, over which the neighbouring power is averaged."""
BESIDE_LINES = 4
"""Fewest lines per channel in that range."""
ADDED_NOISE = 1e-4
"""Noise added to every channel, as a share of the mean neighbouring power."""
PARTS = 10
"""Number of parts of a record whose powers are compared."""


def clear_peaks_hz(frequency_hz: FloatArray, density: FloatArray) -> list[float]:
    """Return the frequencies of clear peaks of any channel, ascending."""
    found: set[int] = set()
    for row in np.maximum(density, np.finfo(float).tiny):
        for k in local_peaks(np.log(row), prominence=np.log(MIN_PEAK_RATIO)):
            half = max(int(0.5 * MEDIAN_WIDTH * k), MIN_MEDIAN_LINES // 2)
            if row[k] > MIN_PEAK_RATIO * np.median(row[max(k - half, 1) : k + half + 1]):
                found.add(int(k))
    return [float(frequency_hz[k]) for k in sorted(found)]


def contrast(
    lines: ComplexArray, duration_s: float, mode: ModalEstimate, shape: ComplexArray
) -> tuple[float, float]:
    """Return the ratio of power at a mode to neighbouring power, and its excess in standard deviations.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transform of the samples.
    shape : (n_channels,)
        Shape in the scaling of the samples.
    """
    at, beside = _lines_of(lines, duration_s, mode)
    if at.sum() < 2 or beside.sum() <= len(lines):
        return np.inf, np.inf
    power = np.abs(_through(lines, beside, shape)) ** 2
    ratio = float(power[at].mean() / power[beside].mean())
    return ratio, float((ratio - 1.0) / np.sqrt(1.0 / at.sum() + 1.0 / beside.sum()))


def second_shape(
    lines: ComplexArray, duration_s: float, mode: ModalEstimate, shape: ComplexArray
) -> tuple[float, float]:
    r"""Return how strongly the channels move in a further shape at a mode, over its own and over chance.

    The first is the ratio of the two largest eigenvalues of the spectral matrix at the mode. The second is
    the largest power in any direction other than the shape, over the mean of neighbouring lines, and over the
    edge :math:`(1 + \sqrt{p/n})^2` of what n lines of noise have in p directions by chance.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transform of the samples.
    shape : (n_channels,)
        Shape in the scaling of the samples.
    """
    at, beside = _lines_of(lines, duration_s, mode)
    others = len(lines) - 1
    if at.sum() < 2 or beside.sum() <= len(lines) or not others:
        return 0.0, 0.0
    own = lines[:, at].astype(complex)
    powers = np.linalg.eigvalsh(own @ own.conj().T)
    root = np.linalg.cholesky(_neighbours(lines, beside))
    white, direction = np.linalg.solve(root, own), np.linalg.solve(root, shape)
    direction /= np.linalg.norm(direction)
    white -= np.outer(direction, direction.conj() @ white)
    most = np.linalg.eigvalsh(white @ white.conj().T / at.sum())[-1]
    return float(powers[-2] / powers[-1]), float(most / (1.0 + np.sqrt(others / at.sum())) ** 2)


def share_of_one_part(
    lines: ComplexArray, duration_s: float, mode: ModalEstimate, shape: ComplexArray
) -> float:
    """Return the largest share of a mode's filtered power in two neighbouring tenths of the record."""
    at, beside = _lines_of(lines, duration_s, mode)
    if beside.sum() <= len(lines):
        return 0.0
    wide = np.convolve(at, np.ones(2 * int(at.sum()) + 1), mode="same") > 0.0
    envelope = np.abs(np.fft.ifft(np.where(wide, _through(lines, beside, shape), 0.0))) ** 2
    parts = np.array([part.sum() for part in np.array_split(envelope, PARTS)])
    return float(np.max(parts[1:] + parts[:-1]) / parts.sum())


def _lines_of(lines: ComplexArray, duration_s: float, mode: ModalEstimate) -> tuple[BoolArray, BoolArray]:
    """Return which lines are at a mode and which are neighbouring, (n_lines,) bool each."""
    f = np.arange(lines.shape[1]) / duration_s
    half = max(mode.damping_ratio * mode.frequency_hz, 1.5 / duration_s)
    far = max(BESIDE_HALF_BANDWIDTHS[1] * half, BESIDE_LINES * len(lines) / duration_s)
    away = np.abs(f - mode.frequency_hz)
    return np.asarray(away <= half), np.asarray(
        (away > BESIDE_HALF_BANDWIDTHS[0] * half) & (away <= far) & (f > 0.0)
    )


def _neighbours(lines: ComplexArray, beside: BoolArray) -> ComplexArray:
    """Return the spectral matrix (n_channels, n_channels) of neighbouring lines, with some noise added."""
    around = lines[:, beside].astype(complex)
    matrix = around @ around.conj().T / beside.sum()
    return np.asarray(matrix + ADDED_NOISE * np.trace(matrix).real / len(lines) * np.eye(len(lines)))


def _through(lines: ComplexArray, beside: BoolArray, shape: ComplexArray) -> ComplexArray:
    """Return the lines after the spatial filter of a shape against neighbouring lines, (n_lines,)."""
    weights = np.linalg.solve(_neighbours(lines, beside), shape).conj()
    out = np.zeros(lines.shape[1], dtype=complex)
    for weight, row in zip(weights, lines, strict=True):  # the lines of a day are of single precision
        out += weight * row
    return out
