r"""The part of a record in which a released structure decays freely.

The power of each channel is smoothed over cycles of the strongest frequency and divided by its quiet level.
The decay starts at the highest point, from which the power falls by e-folds without recovering. The response
to random forces may fade in the same way, but rarely by as much; the fit of damped cosines decides, since
they explain nearly all of a free decay and little of a forced response.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from jackettwin.arrays import FloatArray
from jackettwin.signals import hann, next_fast_len

CYCLES = 2.0
"""Cycles of the strongest frequency over which the power is averaged."""
MIN_FALL = 1.0
"""Smallest fall of the amplitude over a decay, in e-folds."""
MIN_LATER_DROP = 1.0
"""E-folds by which the amplitude after the decay stays below its highest point."""
FLOOR_SHARE = 1.5
"""The decay ends where its amplitude is this multiple of the amplitude after it."""
MIN_SAMPLES = 64
"""Shortest record searched; the choice of the band reports shorter ones."""
MIN_CYCLES = 8.0
"""Fewest cycles of the strongest frequency in a decay."""
MIN_DAMPING_RATIO = 1e-4
"""Least damping ratio of a decay, a tenth of bare welded steel's: random motion whose highest point was hours
ago falls more slowly."""
LATEST_START = 0.9
"""Latest start of a decay, as a share of the record."""
FLOOR_QUANTILE = 0.1
"""Quantile of the power after the highest point that is taken as the level outside the decay."""


@dataclass(frozen=True)
class DecayPart:
    """Part of a record in which the amplitude falls from its highest point.

    Attributes
    ----------
    first, last : int
        Samples [first, last).
    strongest_hz : float
        Frequency of the largest power in the part.
    fall : float
        Fall of the amplitude in e-folds.
    ended : bool
        Whether the record goes on after the decay. One that falls to its end may be the last swing of random
        motion instead, unless damped cosines explain it.
    """

    first: int
    last: int
    strongest_hz: float
    fall: float
    ended: bool = True


def decay_part(y: FloatArray, sample_rate_hz: float) -> DecayPart | None:
    """Return the part of a record that decays, or None.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean, nothing missing.

    Examples
    --------
    >>> t = np.arange(3000) / 10.0
    >>> let_go = np.where(t > 50.0, np.exp(-0.02 * (t - 50.0)), 0.0) * np.cos(2 * np.pi * 0.3 * t)
    >>> found = decay_part(let_go[None] + 0.01 * np.random.default_rng(1).standard_normal(3000), 10.0)
    >>> 48.0 < found.first / 10.0 < 54.0, bool(found.fall > 3.0)
    (True, True)
    """
    if y.shape[1] < MIN_SAMPLES:
        return None
    width = _cycles_width(y, sample_rate_hz)
    if width is None:
        return None
    strongest = CYCLES * sample_rate_hz / width
    smooth = np.zeros(y.shape[1])
    for row in y:
        power = ndimage.uniform_filter1d(row**2, width, mode="nearest")
        quiet = np.quantile(power, FLOOR_QUANTILE) + 1e-12 * np.mean(power)
        smooth += power / (quiet + 1e-300) / len(y)
    inside = smooth[: int(LATEST_START * len(smooth))]
    first = int(np.argmax(inside))
    after = smooth[first:]
    floor = float(np.quantile(after, FLOOR_QUANTILE))
    below = np.flatnonzero(after <= max(FLOOR_SHARE**2 * floor, after.min()))
    ends = ((first + int(below[0]), True), (len(smooth) - 1, False))
    for last, ended in ends:
        fall = 0.5 * float(np.log(smooth[first] / smooth[last]))
        highest_later = float(smooth[last:].max())
        cycles = (last - first) * strongest / sample_rate_hz
        damped = fall > 2.0 * np.pi * cycles * MIN_DAMPING_RATIO
        again = highest_later > np.exp(-2.0 * MIN_LATER_DROP) * smooth[first]
        if fall >= MIN_FALL and cycles >= MIN_CYCLES and damped and not again:
            return DecayPart(first, last, strongest, fall, ended)
    return None


def _cycles_width(y: FloatArray, sample_rate_hz: float) -> int | None:
    """Return the samples in two cycles of the strongest frequency, or None if the record is too short."""
    scale = y.std(axis=1, keepdims=True) + 1e-300
    fourth = sum(np.square(np.square(row / size)) for row, size in zip(y, scale, strict=True)) / len(y)
    rough = ndimage.uniform_filter1d(fourth, max(y.shape[1] // 50, 8), mode="nearest")
    first = int(np.argmax(rough))
    later = (row[first:] / size for row, size in zip(y, scale, strict=True))
    strongest = _strongest_hz(later, sample_rate_hz)
    if strongest is None:
        return None
    width = max(round(CYCLES * sample_rate_hz / strongest), 4)
    return width if y.shape[1] >= MIN_CYCLES / CYCLES * width else None


def _strongest_hz(rows: Iterable[FloatArray], sample_rate_hz: float) -> float | None:
    """Return the frequency of the largest power."""
    density: FloatArray | float = 0.0
    for row in rows:
        n = len(row)
        if n < MIN_SAMPLES:
            return None
        padded = next_fast_len(n, real=True)
        density = density + np.abs(np.fft.rfft((row - row.mean()) * hann(n), padded)) ** 2
    total = np.asarray(density)
    f = np.arange(total.size) * (sample_rate_hz / padded)
    total[f < 4.0 * sample_rate_hz / n] = 0.0
    k = int(np.argmax(total))
    return float(f[k]) if total[k] > 0.0 else None
