"""Detection of records that were decimated, or sampled, without a filter.

What lies above half the sample rate is then folded below it, peaks with the rest, and nothing in the record
says which peak is in its place. A filter leaves a trace: just below half the sample rate nothing passes. A
spectrum that does not fall there, and holds noticeable power beside it, was not filtered, or is that of
noise, or of accelerations under white forces. Only a peak tells these apart: a flat spectrum whose aliases
do not stand out is not reported. Nor is one that falls by half just at the edge, as after a filter
whose edge is half the new rate: there alone it holds what is folded.
"""

from __future__ import annotations

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.records.processing.filters import bridge
from jackettwin.records.processing.spectra import welch_densities
from jackettwin.signals import of_fast_length, running_median

SEGMENTS = 16
"""Segments of Welch's estimate, without overlap."""
MIN_SAMPLES = 1024
"""Shortest record that is examined, in samples."""
EDGE = (0.97, 0.999)
"""Band, over half the sample rate, in which a filter passes nothing."""
BESIDE = (0.7, 0.93)
"""Band with which it is compared."""
FALL = 0.3
"""Ratio of the mean density at the edge to the median beside it above which the spectrum does not fall.
Of the shipped records decimated through Chebyshev's filter of order 8 it is 0.05 at most, without a filter
0.25 to 23."""
NEAR = (0.88, 0.94)
"""Band with which the edge is compared for a filter that ends at half the sample rate."""
FEWEST_AT_EDGE = 4
"""Fewest lines at the edge for this; a record with fewer is too short to tell such a filter."""
LEVEL = 0.7
"""Ratio of the density at the edge to that just below it, over the channels in question, under which
there was such a filter. What is folded there continues what is not: without a filter the slope at half
the rate is zero, and the ratio of a spectrum of f⁻⁴ is 0.95. After SciPy's ``resample_poly`` it is 0.63
for white noise; every 20th and 25th sample of the shipped records have 0.74 to 1.25 in 15 of 16 cases,
and after it 0.32 to 0.62 in 8 of 10."""
UPPER = 2.0 / 3.0
"""Lower end of the band, over half the sample rate, whose power is compared with the whole."""
LEAST_POWER = 0.005
"""Share of the power in that band above which folding matters."""
PEAKS = (0.4, 0.95)
"""Band, over half the sample rate, in which a peak is sought, and from which a mode may be a folded one:
motion falls with frequency, and what is folded the least is the strongest."""
PEAK_RATIO = 3.0
"""Ratio of the highest density there to the median around it from which it is a peak; noise has 1.4 to 1.9,
every twentieth sample of the shipped records 2.6 to 18."""
AROUND = 8
"""The band over which this median is taken, as a divisor of the whole one."""
MIN_AROUND = 9
"""Fewest lines of that band."""


def not_filtered(y: FloatArray) -> tuple[BoolArray, FloatArray, FloatArray]:
    """Tell which channels do not fall towards half the sample rate but have a peak in the band below it.

    The further results are their share of power in the upper third of the band, and the place of their
    clearest peak over half the sample rate.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample.

    Returns
    -------
    (n_channels,) bool, (n_channels,), (n_channels,)

    Examples
    --------
    >>> noise = np.random.default_rng(1).standard_normal((2, 4096))
    >>> noise[1] = np.convolve(noise[1], [1.0, -1.2, 0.9], "same") + 2.0 * np.sin(2.2 * np.arange(4096))
    >>> not_filtered(noise)[0].tolist()
    [False, True]
    """
    none = np.zeros(len(y), dtype=np.bool_), np.zeros(len(y)), np.zeros(len(y))
    if y.shape[1] < MIN_SAMPLES or not len(y):
        return none
    used = of_fast_length(y)
    length = used.shape[1] // SEGMENTS // 2 * 2
    rows = (bridge(row)[None] for row in used)  # one at a time: copies of a day's channels take memory
    each = [welch_densities(row - row.mean(), 2.0, length) for row in rows]
    f, density = each[0][0], np.concatenate([own for _, own in each])
    total = density.sum(axis=1)
    share = density[:, f > UPPER].sum(axis=1) / np.where(total > 0.0, total, 1.0)
    edge, beside, near = ((f > low) & (f < high) for low, high in (EDGE, BESIDE, NEAR))
    at_edge, just_below = density[:, edge].mean(axis=1), density[:, near].mean(axis=1)
    flat = at_edge > FALL * np.median(density[:, beside], axis=1)
    width = max(len(f) // AROUND, MIN_AROUND)
    median = running_median(density, width)
    ratio = density / np.where(median > 0.0, median, np.inf)
    sought = (f > PEAKS[0]) & (f < PEAKS[1])
    at = f[sought][np.argmax(ratio[:, sought], axis=1)]
    peaked = ratio[:, sought].max(axis=1) > PEAK_RATIO
    found = flat & peaked & (share > LEAST_POWER)
    level = np.log(at_edge[found] / just_below[found]) if edge.sum() >= FEWEST_AT_EDGE else np.zeros(0)
    if level.size and level.mean() < np.log(LEVEL):
        found[:] = False
    return np.asarray(found), np.asarray(share), np.asarray(at)
