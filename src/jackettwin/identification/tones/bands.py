"""Bands of a record, the channels' best combination in each, and how steady its envelope is.

Hundreds of bands are looked at in every record: what can be done for all of them together is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.identification.tones.envelopes import independent_values, least_variance, relative_variance
from jackettwin.identification.tones.sinusoid import lines_around, regular

TOGETHER = 2**18
"""Most elements of the signals in memory at a time."""


@dataclass(frozen=True)
class Band:
    """A band, the signal of the channels' best combination in it, and how steady its envelope is.

    Attributes
    ----------
    middle_hz, half_hz : float
    combination : (n_channels,) complex
    variance : float
        Relative, of the squared envelope.
    expected : float
        What the variance of a Gaussian process of as many independent values is hardly ever below.
    """

    middle_hz: float
    half_hz: float
    combination: ComplexArray
    variance: float
    expected: float


def overlapping(
    first_hz: float, end_hz: float, share: float, least_hz: float, step: float
) -> tuple[FloatArray, FloatArray]:
    """Return middles and half widths of bands as wide as a share of their middle, (n_bands,) each.

    Parameters
    ----------
    least_hz : float
        Least half width.
    step : float
        From one band to the next, in half widths.

    Examples
    --------
    >>> middle, half = overlapping(1.0, 1.3, 0.1, 0.05, 1.0)
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
    """Combine the channels so that most is from each band, and least from as many lines on either side.

    Or, where that makes a steadier envelope, along their main direction: a tone may move them as a mode does.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Of the channels' transforms, from zero frequency.
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
    own = np.eye(len(lines)) * inside
    both = np.stack([_strongest(inside, outside), _strongest(inside, own)])
    variance, values = (np.empty((2, len(first))) for _ in range(2))
    for at, n in _alike(n_lines):
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


def _alike(n_lines: IntArray) -> Iterator[tuple[IntArray, int]]:
    """Yield bands of a like number of lines, and a length at which envelopes of them all are sampled well."""
    length = 2 ** np.ceil(np.log2(2 * n_lines)).astype(np.intp)
    for n in np.unique(length):
        at = np.flatnonzero(length == n)
        for part in np.array_split(at, -(-len(at) * int(n) // TOGETHER)):
            yield part, int(n)


def _products(lines: ComplexArray) -> ComplexArray:
    return np.asarray(lines @ lines.conj().T)


def _strongest(inside: ComplexArray, noise: ComplexArray) -> ComplexArray:
    """Return the channels' combinations with most over a noise, (n_bands, n_channels)."""
    inverse = np.linalg.inv(np.linalg.cholesky(regular(noise)))
    adjoint = inverse.conj().transpose(0, 2, 1)
    direction = np.linalg.eigh(inverse @ inside @ adjoint)[1][:, :, -1:]
    return np.asarray((adjoint @ direction)[:, :, 0])
