r"""Whether a refined mode is still the mode it started from.

A likelihood has other maxima than the one at the modes of the record: where forces are not what the model
says, a mode may leave its peak to stand for a slope of the spectrum, or shrink to a single line. What a
record can tell limits both: the frequency stays within a few half bandwidths, ln ζ within a few of its
standard deviations, and nobody knows ζ better than :math:`1/\sqrt{2\pi\zeta fT}` (Au 2014).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.refined import Refined


HALF_BANDWIDTHS = 3.0
"""Largest change of frequency, in half bandwidths of the start …"""
STANDARD_DEVIATIONS = 3.0
"""… and of ln ζ, in its standard deviations at the start."""
TOO_CERTAIN = 0.5
"""A mode known better than this share of the limit of long data is none: its lines were never seen."""


def long_data_limits(f: FloatArray | float, zeta: FloatArray | float, duration_s: float) -> FloatArray:
    """Return the least coefficients of variation of f and ζ, √(ζ/(2πfT)) and 1/√(2πζfT), (2, …) (Au 2014).

    Examples
    --------
    >>> long_data_limits(0.3, 0.01, 600.0).round(4).tolist()
    [0.003, 0.2974]
    """
    cycles = 2.0 * np.pi * np.asarray(f) * duration_s
    return np.asarray(np.sqrt([zeta / cycles, 1.0 / (zeta * cycles)]))


def has_left(
    frequency_hz: FloatArray, start_hz: FloatArray, start_damping_ratio: FloatArray, duration_s: float
) -> BoolArray:
    """Return which frequencies are too far from where they started, (n_modes,)."""
    least = long_data_limits(start_hz, start_damping_ratio, duration_s)[0]
    reach = HALF_BANDWIDTHS * np.maximum(start_damping_ratio, least)
    return np.asarray(np.abs(np.log(frequency_hz / start_hz)) > reach)


def strayed(
    refined: Refined,
    *,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    log_damping_std: FloatArray,
    duration_s: float,
    most_damping: float,
) -> BoolArray:
    """Return which refined modes are no longer those they started from, (n_modes,).

    Parameters
    ----------
    frequency_hz, damping_ratio, log_damping_std : (n_candidates,)
        At the start; a standard deviation below the limit of long data counts as that limit.
    most_damping : float
        A damping ratio above it is of no mode.
    """
    f, zeta = frequency_hz[refined.candidate], damping_ratio[refined.candidate]
    std = np.maximum(log_damping_std[refined.candidate], long_data_limits(f, zeta, duration_s)[1])
    possible = long_data_limits(refined.frequency_hz, refined.damping_ratio, duration_s)[1]
    claimed = np.sqrt(refined.covariance[:, 1, 1])
    return np.asarray(
        has_left(refined.frequency_hz, f, zeta, duration_s)
        | (np.abs(np.log(refined.damping_ratio / zeta)) > STANDARD_DEVIATIONS * std)
        | (claimed < TOO_CERTAIN * possible)
        | (refined.damping_ratio > most_damping)
    )
