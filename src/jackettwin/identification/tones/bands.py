"""Bands of a record: the best combination of channels in each and the steadiness of its envelope.

Each record has hundreds of bands, so that all operations are vectorised over bands.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.identification.tones.envelopes import independent_values, least_variance, relative_variance
from jackettwin.identification.tones.sinusoid import lines_around, regularised

MAX_ELEMENTS = 2**18
"""Most elements of the signals held in memory at a time."""


@dataclass(frozen=True)
class Band:
    """A band, its best combination of channels, and the steadiness of the envelope of that signal.

    Attributes
    ----------
    middle_hz, half_hz : float
    combination : (n_channels,) complex
    variance : float
        Relative variance of the squared envelope.
    expected : float
        Value below which the variance of a Gaussian process with as many independent values rarely falls.
    """

    middle_hz: float
    half_hz: float
    combination: ComplexArray
    variance: float
    expected: float


def overlapping_bands(
    first_hz: float, end_hz: float, share: float, least_hz: float, step: float
) -> tuple[FloatArray, FloatArray]:
    """Return middles and half widths of bands of constant relative width, (n_bands,) each.

    Parameters
    ----------
    least_hz : float
        Smallest half width.
    step : float
        Distance of neighbouring bands, in half widths.

    Examples
    --------
    >>> middle, half = overlapping_bands(1.0, 1.3, 0.1, 0.05, 1.0)
    >>> middle.round(3).tolist(), half.round(3).tolist()
    ([1.0, 1.1, 1.21], [0.1, 0.11, 0.121])
    """
    middle = []
    f = first_hz
    while f < end_hz:
        middle.append(f)
        f += step * max(share * f, least_hz)
    return np.array(middle), np.maximum(share * np.array(middle), least_hz)


def bands_of(
    lines: ComplexArray, duration_s: float, middle_hz: FloatArray, half_hz: FloatArray
) -> list[Band]:
    """Combine the channels so that the ratio of power in each band to that of lines around it is largest.

    The principal direction of the channels is used instead if its envelope is steadier,
    as a tone may move the channels in the same shape as a mode.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Transforms of the channels, from zero frequency.
    middle_hz, half_hz : (n_bands,)
    """
    if not len(middle_hz):
        return []
    first = np.ceil((middle_hz - half_hz) * duration_s).astype(np.intp)
    last = np.minimum(((middle_hz + half_hz) * duration_s).astype(np.intp), lines.shape[1] - 1)
    around = np.maximum(half_hz * duration_s, lines_around(len(lines))).astype(np.intp)
    low, high = np.maximum(first - around, 1), np.minimum(last + around, lines.shape[1] - 1)
    n_lines, n_wide = last - first + 1, high - low + 1
    inside = np.array([_products(lines[:, a : b + 1]) for a, b in zip(first, last, strict=True)])
    outside = np.array([_products(lines[:, a : b + 1]) for a, b in zip(low, high, strict=True)]) - inside
    inside /= n_lines[:, None, None]
    outside /= (n_wide - n_lines)[:, None, None]
    both = np.stack([_strongest(inside, outside), _principal(inside)])
    variance, values = (np.empty((2, len(first))) for _ in range(2))
    for at, n in _batches(n_lines):
        signals = np.zeros((2, len(at), n), dtype=complex)
        for row, k in enumerate(at):
            signals[:, row, : n_lines[k]] = both[:, k].conj() @ lines[:, first[k] : last[k] + 1]
        variance[:, at], values[:, at] = relative_variance(fft.ifft(signals)), independent_values(signals)
    best = np.argmin(variance, axis=0)
    return [
        Band(
            float(middle_hz[k]),
            float(half_hz[k]),
            both[i, k],
            float(variance[i, k]),
            least_variance(float(values[i, k])),
        )
        for k, i in enumerate(best)
    ]


def _batches(n_lines: IntArray) -> Iterator[tuple[IntArray, int]]:
    """Yield bands with similar numbers of lines, and a length that samples their envelopes well."""
    length = 2 ** np.ceil(np.log2(2 * n_lines)).astype(np.intp)
    for n in np.unique(length):
        at = np.flatnonzero(length == n)
        for part in np.array_split(at, -(-len(at) * int(n) // MAX_ELEMENTS)):
            yield part, int(n)


def _products(lines: ComplexArray) -> ComplexArray:
    return np.asarray(lines @ lines.conj().T)


def _strongest(inside: ComplexArray, noise: ComplexArray) -> ComplexArray:
    """Return the combinations of channels with the largest power over noise, (n_bands, n_channels)."""
    inverse = np.linalg.inv(np.linalg.cholesky(regularised(noise)))
    adjoint = inverse.conj().transpose(0, 2, 1)
    direction = np.linalg.eigh(inverse @ inside @ adjoint)[1][:, :, -1:]
    return np.asarray((adjoint @ direction)[:, :, 0])


def _principal(inside: ComplexArray) -> ComplexArray:
    """Return the principal directions of the channels, each in units of its own rms."""
    channel = np.arange(inside.shape[-1])
    scale = 1.0 / np.sqrt(regularised(inside)[:, channel, channel].real)
    direction = np.linalg.eigh(scale[:, :, None] * inside * scale[:, None, :])[1][:, :, -1]
    return np.asarray(scale * direction)
