"""Background of a narrow band: the quasi-static response of the modes outside it.

Far from its frequency, a mode responds with its force times a power of frequency, in phase or in antiphase.
There all modes driven by one force act together, so that as many shapes suffice as there are forces. These
background shapes are real and free; their coherence with the modes is fitted. Modes just outside the band are
not part of the background but modelled as modes (``Parameters.outside``).
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


MAX_BACKGROUNDS = 2
"""Most background shapes: forces act in two horizontal directions."""
RELATIVE_FREQUENCY = 0.03
"""Frequency of a background over the lower edge of the band;
its kernel differs from 1 by the square of this."""
DAMPING_RATIO = 0.02
"""Nominal damping ratio of a background; it has no effect."""
FAR_HALF_BANDWIDTHS = 4.0
"""Distance from all modes, in half bandwidths, beyond which a line is attributed to the background."""


def with_background(data: Periodogram, p: Parameters) -> Parameters:
    """Return the parameters with background shapes put before the modes.

    Their initial directions are the principal directions of the spectral matrix between the peaks.
    """
    n_channels = p.shapes.shape[1]
    count = min(MAX_BACKGROUNDS, n_channels // 2)
    n = len(p.log_f) + count
    power, directions = np.linalg.eigh(_between_peaks(data, p))
    top = np.arange(n_channels - 1, n_channels - 1 - count, -1)
    log_f = np.append(np.full(count, np.log(RELATIVE_FREQUENCY * data.omega[0] / (2.0 * np.pi))), p.log_f)
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
    count = np.where(nearest >= min(FAR_HALF_BANDWIDTHS, float(np.median(nearest))), data.count, 0.0)
    return np.asarray(np.einsum("k,kab->ab", count, data.density.real) / count.sum())
