"""What the modes outside a narrow band add to it: a few shapes that follow their force.

Far from its frequency a mode's response is its force times a power of frequency, in phase or in antiphase.
All modes that one force drives act together there, so as many shapes as there are forces are enough: a
background of real, free shapes, coherent with the modes as the data say. Modes beside the band are not far:
they take part as they are (``Parameters.outside``).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification.maximum_likelihood.parameters import coherent_pairs

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.parameters import Parameters
    from jackettwin.identification.maximum_likelihood.periodogram import Periodogram


MOST = 2
"""Forces in two directions."""
FAR_BELOW = 0.03
"""Frequency of a background over the lower edge of the band: its kernel is 1 to the square of this."""
DAMPING_RATIO = 0.02
"""Without effect."""
AWAY = 4.0
"""Half bandwidths from every mode beyond which a line is taken to show the background."""


def with_background(data: Periodogram, p: Parameters) -> Parameters:
    """Return the parameters with backgrounds first, along the main directions between the peaks."""
    n_channels = p.shapes.shape[1]
    count = min(MOST, n_channels // 2)
    n = len(p.log_f) + count
    power, directions = np.linalg.eigh(_between_peaks(data, p))
    top = np.arange(n_channels - 1, n_channels - 1 - count, -1)
    log_f = np.append(np.full(count, np.log(FAR_BELOW * data.omega[0] / (2.0 * np.pi))), p.log_f)
    gamma = np.eye(n, dtype=complex)
    gamma[count:, count:] = p.gamma
    pairs = coherent_pairs(log_f)
    return replace(
        p,
        log_f=log_f,
        log_zeta=np.append(np.full(count, np.log(DAMPING_RATIO)), p.log_zeta),
        colour=np.append(np.zeros(count), p.colour),
        shapes=np.vstack([directions[:, top].T * np.sqrt(0.5 * power[top])[:, None], p.shapes]),
        coherence=gamma[pairs[:, 0], pairs[:, 1]],
        pairs=pairs,
        background=count,
    )


def _between_peaks(data: Periodogram, p: Parameters) -> FloatArray:
    """Return the mean spectral matrix of the lines farthest from the modes, (n_channels, n_channels)."""
    f = np.exp(p.log_f)
    away = np.abs(data.omega[:, None] / (2.0 * np.pi) - f) / (f * np.exp(p.log_zeta))
    nearest = away.min(axis=1)
    count = np.where(nearest >= min(AWAY, float(np.median(nearest))), data.count, 0.0)
    return np.asarray(np.einsum("k,kab->ab", count, data.density.real) / count.sum())
