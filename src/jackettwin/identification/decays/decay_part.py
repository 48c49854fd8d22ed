r"""Find the part of a record in which a structure that was let go swings out.

The power of the channels, smoothed over cycles of the strongest frequency and each over what it is when
nothing happens, is searched for a highest point from which it falls by e-folds and never comes back. Fading
does that in the response to random forces too, but seldom so deep; whether it was a decay, the fit of damped
cosines tells: they explain nearly all of a decay, and little of a record in which forces act.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from jackettwin.arrays import FloatArray
from jackettwin.signals import hann, next_fast_len

CYCLES = 2.0
"""Cycles of the strongest frequency over which the power is averaged."""
LEAST_FALL = 1.0
"""Least fall of the amplitude from its highest point to the end of the decay, in e-folds."""
AGAIN = 1.0
"""After the decay the amplitude stays this many e-folds below its highest point."""
FLOOR_SHARE = 1.5
"""The decay ends where its amplitude is this multiple of the amplitude after it."""
FEWEST_SAMPLES = 64
"""Shorter records cannot be identified at all; whoever looks for their band says so."""
FEWEST_CYCLES = 8.0
"""Least number of cycles of the strongest frequency in a decay."""
LATEST = 0.9
"""Share of the record in which a decay must begin."""
FLOOR_QUANTILE = 0.1
"""Quantile of the power after the highest point that is taken as the level without a decay."""


@dataclass(frozen=True)
class DecayPart:
    """Samples from the highest point on in which the amplitude falls.

    Attributes
    ----------
    first, last : int
        Samples [first, last).
    strongest_hz : float
        Frequency of most power there.
    fall : float
        E-folds of the amplitude.
    """

    first: int
    last: int
    strongest_hz: float
    fall: float


def decay_part(y: FloatArray, sample_rate_hz: float) -> DecayPart | None:
    """Return where a record decays; None if it does not.

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
    if y.shape[1] < FEWEST_SAMPLES:
        return None
    width = _cycles_width(y, sample_rate_hz)
    if width is None:
        return None
    strongest = CYCLES * sample_rate_hz / width
    rows = ndimage.uniform_filter1d(y**2, width, axis=1, mode="nearest")
    quiet = np.quantile(rows, FLOOR_QUANTILE, axis=1, keepdims=True) + 1e-12 * np.mean(
        rows, axis=1, keepdims=True
    )
    smooth = np.mean(rows / (quiet + 1e-300), axis=0)
    inside = smooth[: int(LATEST * len(smooth))]
    first = int(np.argmax(inside))
    after = smooth[first:]
    floor = float(np.quantile(after, FLOOR_QUANTILE))
    below = np.flatnonzero(after <= max(FLOOR_SHARE**2 * floor, after.min()))
    last = first + int(below[0])
    fall = 0.5 * float(np.log(smooth[first] / smooth[last]))
    highest_later = float(smooth[last:].max(initial=0.0))
    long_enough = (last - first) * strongest / sample_rate_hz >= FEWEST_CYCLES
    again = highest_later > np.exp(-2.0 * AGAIN) * smooth[first]
    if fall < LEAST_FALL or again or not long_enough:
        return None
    return DecayPart(first, last, strongest, fall)


def _cycles_width(y: FloatArray, sample_rate_hz: float) -> int | None:
    """Return the samples of two cycles of the frequency at which the channels move most, where they do."""
    white = y / (y.std(axis=1, keepdims=True) + 1e-300)
    fourth = np.mean(np.square(np.square(white)), axis=0)
    rough = ndimage.uniform_filter1d(fourth, max(y.shape[1] // 50, 8), mode="nearest")
    strongest = _strongest_hz(white[:, int(np.argmax(rough)) :], sample_rate_hz)
    if strongest is None:
        return None
    width = max(round(CYCLES * sample_rate_hz / strongest), 4)
    return width if y.shape[1] >= FEWEST_CYCLES / CYCLES * width else None


def _strongest_hz(y: FloatArray, sample_rate_hz: float) -> float | None:
    """Return the frequency at which the channels move most."""
    n = y.shape[1]
    if n < 64:
        return None
    padded = next_fast_len(n, real=True)
    lines = np.fft.rfft((y - y.mean(axis=1, keepdims=True)) * hann(n), padded, axis=1)
    f = np.arange(lines.shape[1]) * (sample_rate_hz / padded)
    density = np.mean(np.abs(lines) ** 2, axis=0)
    density[f < 4.0 * sample_rate_hz / n] = 0.0
    k = int(np.argmax(density))
    return float(f[k]) if density[k] > 0.0 else None
