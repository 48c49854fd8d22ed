r"""Fourier transforms of records, and Welch's estimate of power spectral densities.

Channels may have missing samples. These count as zero, and the power of all segments is divided by the
window's energy over the samples present,

.. math:: S(f) = \frac{2}{f_s}\,
          \frac{\sum_m \big|\sum_k w_k\, x_{mk}\, e^{-2\pi i f k/f_s}\big|^2}{\sum_m \sum_k w_k^2\, a_{mk}},

with w the Hann window, x the samples of segment m (half overlapping), and a = 1 for a present sample and
0 for a missing one. By Parseval's theorem the density integrates to the variance of the samples present,
and white noise has its true level whatever share is missing. Scattered missing samples spread part of a
line's power over all frequencies; a gap spreads it to neighbouring lines.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.signals import hann, of_fast_length


def hann_lines(rows: Iterable[FloatArray]) -> Iterator[ComplexArray]:
    """Yield the transforms of rows of one length under a Hann window, without gaps, one after another."""
    window: FloatArray | None = None
    for row in rows:
        used = of_fast_length(row)
        window = np.hanning(len(used)) if window is None else window
        yield np.fft.rfft(used * window)


def welch_densities(
    y: FloatArray, sample_rate_hz: float, segment_length: int, *, less_mean: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return frequencies [Hz] and one-sided power spectral densities, (n_channels, n_frequencies).

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples, unless ``less_mean``; NaN marks a missing one.
    segment_length : int
        Samples of a segment, at most those of the record.
    less_mean : bool
        Subtract the mean of every segment, as ``scipy.signal.welch`` does.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> f, density = welch_densities(np.sin(2 * np.pi * 0.5 * t)[None], 10.0, 1000)
    >>> round(float(density.sum() * f[1]), 6)
    0.5
    """
    density = np.zeros((len(y), segment_length // 2 + 1))
    for x in _transforms(y, segment_length, less_mean=less_mean):
        density += x.real**2 + x.imag**2
    scale = _norm(y, sample_rate_hz, segment_length)[:, None] ** 2
    return _lines_hz(sample_rate_hz, segment_length), density * scale * _one_sided(segment_length)


def spectral_matrix(
    y: FloatArray, sample_rate_hz: float, segment_length: int
) -> tuple[FloatArray, ComplexArray]:
    """Return frequencies and one-sided spectral matrices, whose diagonals are the :func:`welch_densities`.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples; NaN marks a missing one.

    Returns
    -------
    (n_frequencies,), (n_frequencies, n_channels, n_channels)
    """
    matrix = np.zeros((segment_length // 2 + 1, len(y), len(y)), dtype=complex)
    for x in _transforms(y, segment_length):
        matrix += x.T[:, :, None] * x.T.conj()[:, None, :]
    norm = _norm(y, sample_rate_hz, segment_length)
    matrix *= np.multiply.outer(norm, norm)
    matrix *= _one_sided(segment_length)[:, None, None]
    return _lines_hz(sample_rate_hz, segment_length), matrix


def spectral_values(
    y: FloatArray, sample_rate_hz: float, segment_length: int, scale: FloatArray, below_hz: float = np.inf
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return frequencies, densities, and singular values of the spectral matrices of y over a scale.

    The matrix of more channels than segments has the rank of the segments, and the values of the matrix of
    their products, which is smaller.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples; NaN marks a missing one.
    scale : (n_channels,)
    below_hz : float
        Frequency above which nothing is needed.

    Returns
    -------
    (n_frequencies,), (n_channels, n_frequencies), (n_channels, n_frequencies) descending
    """
    f = _lines_hz(sample_rate_hz, segment_length)
    f = f[f <= below_hz]
    n_segments = len(range(0, y.shape[1] - segment_length + 1, max(segment_length // 2, 1)))
    if n_segments >= len(y):
        matrix = spectral_matrix(y, sample_rate_hz, segment_length)[1][: f.size]
        density = np.einsum("faa->af", matrix).real
        matrix = matrix / np.multiply.outer(scale, scale)
    else:
        x = np.stack([lines[:, : f.size] for lines in _transforms(y, segment_length)], axis=1).T
        x *= _norm(y, sample_rate_hz, segment_length)
        x *= np.sqrt(_one_sided(segment_length))[: f.size, None, None]
        density = np.sum(x.real**2 + x.imag**2, axis=1).T
        x /= scale
        matrix = x @ x.conj().transpose(0, 2, 1)
    # for a positive Hermitian matrix these are the singular values, at a third of their cost
    values = np.zeros((len(y), f.size))
    values[: matrix.shape[1]] = np.abs(np.linalg.eigvalsh(matrix)[:, ::-1].T)
    return f, np.asarray(density), values


def _transforms(y: FloatArray, segment_length: int, *, less_mean: bool = False) -> Iterator[ComplexArray]:
    """Yield the transforms of all channels in one segment after the other, (n_channels, n_frequencies)."""
    window = hann(segment_length)
    for segment in _segments(y, segment_length):
        there = np.isfinite(segment)
        x = segment if there.all() else np.where(there, segment, 0.0)
        if less_mean:
            x = x - x.sum(axis=1, keepdims=True) / np.maximum(there.sum(axis=1, keepdims=True), 1) * there
        yield np.asarray(np.fft.rfft(x * window, axis=1))


def _norm(y: FloatArray, sample_rate_hz: float, segment_length: int) -> FloatArray:
    """Return √density over the root of the sum of squared amplitudes over segments, (n_channels,)."""
    power, energy = hann(segment_length) ** 2, np.zeros(len(y))
    for segment in _segments(y, segment_length):
        energy += np.isfinite(segment) @ power
    return np.where(energy > 0.0, 1.0 / np.sqrt(sample_rate_hz * np.where(energy > 0.0, energy, 1.0)), 0.0)


def _lines_hz(sample_rate_hz: float, segment_length: int) -> FloatArray:
    return np.asarray(np.arange(segment_length // 2 + 1) * (sample_rate_hz / segment_length))


def _one_sided(segment_length: int) -> FloatArray:
    """Return the weight of each line; the mean and the Nyquist line count once, the others twice."""
    times = np.full(segment_length // 2 + 1, 2.0)
    times[0] = 1.0
    if segment_length % 2 == 0:
        times[-1] = 1.0
    return times


def _segments(y: FloatArray, length: int) -> Iterator[FloatArray]:
    """Yield half overlapping segments: one at a time, as those of a day are twice as large as the day."""
    for start in range(0, y.shape[1] - length + 1, max(length // 2, 1)):
        yield y[:, start : start + length]
