"""Spectral densities, their singular values, and the lowest clear peak."""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification.estimate import Spectrum
from jackettwin.records import spectral_values, welch_densities
from jackettwin.signals import local_peaks

SEGMENTS = 8
"""Number of segments in Welch's method (half overlapping)."""

LONGEST_SEGMENT_S = 900.0
"""Longest segment [s]: it resolves the peak of a tower mode, and hours give a smoother spectrum."""

CLEAR_PEAK = 8.0
"""Smallest ratio of a peak to the median of the two octaves around it."""

FAR_BELOW = 0.65
"""Frequency of a clear peak of one channel, over that of the largest singular value, below which a band that
begins beneath the latter would not contain it."""

FAINTEST = 1e-4
"""Least power of a clear peak over the strongest line."""

FEWEST_CYCLES = 20.0
"""Fewest cycles in the record of a frequency that is considered."""

RESOLVED_LINES = 6
"""Line of a spectrum of eight segments below which the two octaves around a peak are mostly the peak itself
under the window: there half as many segments, of twice the length, show it."""


def welch(
    y: FloatArray, sample_rate_hz: float, segment_length: int | None = None, *, below_hz: float = np.inf
) -> Spectrum:
    """Return the spectra of a record by Welch's method (``records.processing.spectra``).

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples; NaN marks a missing one.
    below_hz : float
        Frequency above which nothing is needed.
    """
    scale = np.sqrt([np.nanmean(row**2) for row in y])
    length = segment_length or _length(y, sample_rate_hz)
    return Spectrum(*spectral_values(y, sample_rate_hz, length, scale, below_hz))


def densities(y: FloatArray, sample_rate_hz: float, segment_length: int | None = None) -> Spectrum:
    """Return the densities of :func:`welch` without singular values, at a third of the cost."""
    f, density = welch_densities(y, sample_rate_hz, segment_length or _length(y, sample_rate_hz))
    return Spectrum(f, density, np.empty((0, f.size)))


def _length(y: FloatArray, sample_rate_hz: float) -> int:
    """Return the number of samples in a segment."""
    return max(min(int(y.shape[1]) // SEGMENTS, int(LONGEST_SEGMENT_S * sample_rate_hz)), 16)


def lowest_motion_hz(y: FloatArray, sample_rate_hz: float) -> float | None:
    """Return the lowest frequency at which samples of zero mean have a clear peak, in a short record too."""
    length = _length(y, sample_rate_hz)
    spectrum = welch(y, sample_rate_hz, length)
    lowest = of_one_channel(spectrum, lowest_peak_hz(spectrum))
    if length >= int(LONGEST_SEGMENT_S * sample_rate_hz):
        return lowest
    limit = RESOLVED_LINES * float(spectrum.frequencies_hz[1])
    finer = welch(y, sample_rate_hz, 2 * length, below_hz=2.0 * limit)
    low = _lowest(finer, 2.0 * FEWEST_CYCLES / SEGMENTS, float(spectrum.singular_values[0, 1:].max()))
    return low if low is not None and low < min(limit, lowest or np.inf) else lowest


def lowest_peak_hz(spectrum: Spectrum) -> float | None:
    """Return the lowest frequency at which the largest singular value has a clear peak."""
    return _lowest(spectrum, FEWEST_CYCLES / SEGMENTS, float(spectrum.singular_values[0, 1:].max()))


def of_one_channel(spectrum: Spectrum, lowest: float | None) -> float | None:
    """Return the lowest clear peak of a channel alone if it is far below that of all, else the latter.

    The largest singular value is the strongest motion, whose broad forces hide a first mode across it.
    """
    if lowest is None:
        return None
    rows = spectrum.density[:, spectrum.frequencies_hz < 2.0 * lowest]
    f = spectrum.frequencies_hz[: rows.shape[1]]
    each = (
        _lowest(Spectrum(f, row[None], row[None]), FEWEST_CYCLES / SEGMENTS, float(full.max()))
        for row, full in zip(rows, spectrum.density[:, 1:], strict=True)
    )
    below = [peak for peak in each if peak is not None and peak < FAR_BELOW * lowest]
    return min(below, default=lowest)


def _lowest(spectrum: Spectrum, lowest_line: float, strongest: float) -> float | None:
    """Return the lowest clear peak of the lower part of a spectrum whose highest value is ``strongest``."""
    f = spectrum.frequencies_hz
    s = spectrum.singular_values[0]
    for k in local_peaks(s):
        around = (f > f[k] / np.sqrt(2.0)) & (f < f[k] * np.sqrt(2.0))
        wider = (f > f[k] / 2.0) & (f < f[k] * 2.0)
        prominent = s[k] == s[around].max() and s[k] > CLEAR_PEAK * np.median(s[wider])
        if k >= lowest_line and prominent and s[k] > FAINTEST * strongest:
            return float(f[k])
    return None
