"""Find loud tones that drift with the speed of a rotor, before anything else looks at the record.

In a band wide enough for its drift a loud tone has a steady envelope, whatever its frequency does; that of
modes driven by random forces wanders. The relative variance of the squared envelope of the main direction of
each of overlapping bands tells: below 0.03 for tones with the rms of a channel that drift by up to 3 % (0.06
by 8 %), in 300 records of two light modes never below 0.12 (ζfT = 0.9) and 0.27 (ζfT = 2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import fft

from jackettwin.identification.tones.harmonics import (
    FOLLOWED_CYCLES,
    drifting_tone,
    relative_variance,
    without_unsteady_tone,
)

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

DRIFTS = (0.1, 0.2)
"""Half widths of the bands, as a share of their middle."""
STEADY = 0.06
"""Relative variance of the squared envelope below which a band holds a tone and little else."""
FEWEST_LINES = 16.0
"""Narrower bands are not looked at: some direction of the channels has a steady envelope in a few lines."""
STEP = 1.07
"""Ratio of the frequencies of neighbouring bands."""
HIGHEST = 0.4
"""Of the sample rate: the highest band."""
MOST = 6
"""Tones taken out at most."""


@dataclass(frozen=True)
class Band:
    """A band, how steady its envelope is, and the frequency and direction of what moves in it."""

    drift: float
    variance: float
    frequency_hz: float
    shape: ComplexArray


def drifting_tones(
    y: FloatArray, sample_rate_hz: float
) -> tuple[tuple[tuple[float, float], ...], FloatArray]:
    """Return the ranges that loud drifting tones swept [Hz], and the samples less these tones.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> drifting = np.sin(2 * np.pi * 0.5 * (t + 0.9 * np.sin(2 * np.pi * t / 300.0)))
    >>> noise = np.random.default_rng(1).standard_normal((2, 6000))
    >>> (swept,), left = drifting_tones(drifting + 0.3 * noise, 10.0)
    >>> bool(0.45 < swept[0] < 0.49 and 0.51 < swept[1] < 0.55)
    True
    """
    duration = y.shape[1] / sample_rate_hz
    found: list[tuple[float, float]] = []
    left = y
    for _ in range(MOST):
        steadiest = min(_bands(left, sample_rate_hz), key=lambda band: band.variance, default=None)
        if steadiest is None or steadiest.variance > STEADY:
            break
        f = steadiest.frequency_hz
        own = min((_band(_lines(left), f, half, duration) for half in DRIFTS), key=lambda band: band.variance)
        sweep = drifting_tone(left, sample_rate_hz, f, own.shape)
        if sweep is None:
            break
        found.append((sweep.low_hz, sweep.high_hz))
        left = without_unsteady_tone(left, sample_rate_hz, f, sweep.half_hz, own.shape)
    return tuple(found), left


def disturbed_hz(swept: tuple[float, float]) -> tuple[float, float]:
    """Return the range in which a tone that was taken out leaves what its smoothed phase does not follow."""
    low, high = swept
    return low - low / FOLLOWED_CYCLES, high + high / FOLLOWED_CYCLES


def _bands(y: FloatArray, sample_rate_hz: float) -> list[Band]:
    duration = y.shape[1] / sample_rate_hz
    lines = _lines(y)
    found = []
    for drift in DRIFTS:
        lowest, highest = 0.5 * FEWEST_LINES / (drift * duration), HIGHEST * sample_rate_hz
        middles = lowest * STEP ** np.arange(max(int(np.log(highest / lowest) / np.log(STEP)), 0))
        found += [_band(lines, float(f), drift, duration) for f in middles]
    return found


def _lines(y: FloatArray) -> ComplexArray:
    return np.asarray(fft.rfft(np.where(np.isfinite(y), y, 0.0), axis=1))


def _band(lines: ComplexArray, middle_hz: float, drift: float, duration_s: float) -> Band:
    """Look at the main direction of the channels, each scaled to its power in the band."""
    low, high = (1.0 - drift) * middle_hz * duration_s, (1.0 + drift) * middle_hz * duration_s
    k = np.arange(int(np.ceil(low)), int(high) + 1)
    inside = lines[:, k]
    scale = np.sqrt(np.sum(np.abs(inside) ** 2, axis=1)) + 1e-300
    unit = inside / scale[:, None]
    shape = np.linalg.eigh(unit @ unit.conj().T)[1][:, -1] / scale
    envelope = np.asarray(fft.ifft(shape.conj() @ inside))
    turn = np.angle(np.vdot(envelope[:-1], envelope[1:])) / (2.0 * np.pi)
    # the envelope of n lines has n samples; frequencies count from the first line, modulo n
    frequency = (k[0] + (turn % 1.0) * len(k)) / duration_s
    return Band(drift, relative_variance(envelope), float(frequency), np.asarray(shape / np.abs(shape).max()))
