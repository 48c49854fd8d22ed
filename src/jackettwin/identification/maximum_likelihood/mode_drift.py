r"""Test whether a refined mode is still the mode it started from.

A likelihood has other maxima than the one at the modes of the record. Where the forces do not follow
the model, a fitted mode may leave its peak to fit a slope of the spectrum, or shrink to a single line.
The information in a record limits both: the frequency must stay within a few half bandwidths and ln ζ within
a few standard deviations, and no estimate of ζ is more certain than :math:`1/\sqrt{2\pi\zeta fT}` (Au 2014).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray

if TYPE_CHECKING:
    from jackettwin.identification.maximum_likelihood.band_fit import BandFit


MAX_FREQUENCY_DRIFT = 3.0
"""Largest change of frequency, in half bandwidths of the start."""
MAX_DAMPING_DRIFT = 3.0
"""Largest change of ln ζ, in its standard deviations at the start."""
MIN_UNCERTAINTY = 0.5
"""Smallest credible uncertainty of the damping, as a share of the long-data limit."""


def long_data_limits(f: FloatArray | float, zeta: FloatArray | float, duration_s: float) -> FloatArray:
    """Return the smallest coefficients of variation of f and ζ, √(ζ/(2πfT)) and 1/√(2πζfT), (2, …) (Au 2014).

    Examples
    --------
    >>> long_data_limits(0.3, 0.01, 600.0).round(4).tolist()
    [0.003, 0.2974]
    """
    cycles = 2.0 * np.pi * np.asarray(f) * duration_s
    return np.asarray(np.sqrt([zeta / cycles, 1.0 / (zeta * cycles)]))


def frequency_left(
    frequency_hz: FloatArray, start_hz: FloatArray, start_damping_ratio: FloatArray, duration_s: float
) -> BoolArray:
    """Return which frequencies are too far from their initial values, (n_modes,) bool."""
    least = long_data_limits(start_hz, start_damping_ratio, duration_s)[0]
    reach = MAX_FREQUENCY_DRIFT * np.maximum(start_damping_ratio, least)
    return np.asarray(np.abs(np.log(frequency_hz / start_hz)) > reach)


def drifted(
    refined: BandFit,
    *,
    frequency_hz: FloatArray,
    damping_ratio: FloatArray,
    log_damping_std: FloatArray,
    duration_s: float,
    max_damping_ratio: float,
) -> BoolArray:
    """Return which refined modes are no longer those they started from, (n_modes,) bool.

    Parameters
    ----------
    frequency_hz, damping_ratio, log_damping_std : (n_candidates,)
        Values at the start; a standard deviation below the long-data limit is raised to that limit.
    max_damping_ratio : float
        Largest damping ratio of a mode.
    """
    f, zeta = frequency_hz[refined.candidate], damping_ratio[refined.candidate]
    std = np.maximum(log_damping_std[refined.candidate], long_data_limits(f, zeta, duration_s)[1])
    possible = long_data_limits(refined.frequency_hz, refined.damping_ratio, duration_s)[1]
    claimed = np.sqrt(refined.covariance[:, 1, 1])
    return np.asarray(
        frequency_left(refined.frequency_hz, f, zeta, duration_s)
        | (np.abs(np.log(refined.damping_ratio / zeta)) > MAX_DAMPING_DRIFT * std)
        | (claimed < MIN_UNCERTAINTY * possible)
        | (refined.damping_ratio > max_damping_ratio)
    )
