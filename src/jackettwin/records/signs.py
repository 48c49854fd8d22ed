"""Which channels point the wrong way: signs of parallel sensors in the lowest strong vibration.

In the first bending mode, and below it, every point of a tower and its jacket moves the same way.
Parallel channels must therefore be in phase in the strongest narrow band of displacement, where the
first bending mode or what is slower prevails; a channel in counterphase with the majority has its
sign swapped. (Higher bending modes move tower top and middle against each other by nature.)
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jackettwin.records.filters import bridge

FloatArray = npt.NDArray[np.float64]

BAND = 0.15
"""Half width of the band around the strongest line, as a share of its frequency."""
LEAST_CYCLES = 20
"""The band's frequency must fit this often into the record."""
CERTAIN = 0.9
"""Coherency in the band, in absolute value, from which a sign is certain."""


def band_coherency(y: FloatArray) -> FloatArray:
    """Return the real part of the coherency between rows in the strongest band of displacement.

    Parameters
    ----------
    y : (n_channels, n_samples) array of accelerations
        NaN marks missing samples; they are bridged.

    Returns
    -------
    (n_channels, n_channels) array
        Between −1 and 1; zeros where a row does not move or the record is too short.
    """
    n_channels, n = y.shape
    if n < 4 * LEAST_CYCLES:
        return np.eye(n_channels)
    x = np.apply_along_axis(bridge, 1, y)
    window = np.hanning(n)
    spectra = np.fft.rfft((x - x.mean(axis=1, keepdims=True)) * window, axis=1)
    peak = strongest_line(spectra)
    k = np.arange(spectra.shape[1])
    inside = spectra[:, np.abs(k - peak) <= np.maximum(BAND * peak, 3)]
    cross = np.real(inside @ inside.conj().T)
    power = np.sqrt(np.outer(np.diag(cross), np.diag(cross)))
    coherency: FloatArray = np.where(power > 0.0, cross / np.where(power > 0.0, power, 1.0), 0.0)
    return coherency


def strongest_line(spectra: npt.NDArray[np.complex128]) -> int:
    """Return the line around which the channels' displacements, each of unit power, are strongest.

    Parameters
    ----------
    spectra : (n_channels, n_lines) complex
        Transforms of accelerations, more than ``LEAST_CYCLES`` lines.
    """
    k = np.arange(LEAST_CYCLES, spectra.shape[1])
    displacement = np.abs(spectra[:, LEAST_CYCLES:] / k**2) ** 2
    total = displacement.sum(axis=1, keepdims=True)
    common = np.sum(displacement / np.where(total > 0.0, total, 1.0), axis=0)
    return int(k[np.argmax(np.convolve(common, np.ones(5), mode="same"))])


def against_majority(coherency: FloatArray) -> tuple[list[int], bool]:
    """Return the rows in counterphase with the others, and whether that is certain.

    Certain takes at least three rows whose coherencies all exceed ``CERTAIN`` and a majority;
    with two, or with as many on either side, all that is known is that they disagree.

    >>> against_majority(np.array([[1.0, 0.99, -0.98], [0.99, 1.0, -0.97], [-0.98, -0.97, 1.0]]))
    ([2], True)
    """
    clear = np.flatnonzero(np.mean(np.abs(coherency) > CERTAIN, axis=1) > 0.5)
    if len(clear) < 2:
        return [], False
    among = coherency[np.ix_(clear, clear)]
    signs = np.sign(np.linalg.eigh(among)[1][:, -1])
    negative, positive = clear[signs < 0.0], clear[signs >= 0.0]
    minority = negative if len(negative) <= len(positive) else positive
    certain = len(negative) != len(positive) and bool(np.all(np.abs(among) > CERTAIN))
    return [int(i) for i in minority], certain
