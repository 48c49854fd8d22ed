"""Detection and subtraction of tones that drift with the speed of a rotor, before any other step.

Overlapping bands are scanned. In each, the channels are combined so that motion in the band stands out
from motion around it, or along their principal direction. A tone makes the envelope of that signal steady,
which random forces on modes rarely do. The phase of the steadiest bands is tracked (``phase_track.py``);
the tracked phase shows whether there is a tone, which is then subtracted.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.tones.bands import Band, bands_of, overlapping_bands
from jackettwin.identification.tones.phase_track import INTERVALS, baseband, first_phase, phase_track
from jackettwin.identification.tones.sinusoid import lines_around, transform
from jackettwin.records import less_phase

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.identification.tones.phase_track import PhaseTrack


DRIFTS = (0.02, 0.07, 0.15)
"""Half widths of the bands, which must contain the drift, as a share of their middle."""
MIN_LINES = 4.0
"""Fewest Fourier lines in half a band."""
STEP = 0.7
"""Distance of neighbouring bands, in half widths."""
MAX_VARIANCE = 0.5
"""Relative variance of the squared envelope below which the phase of a band is tracked."""
MAX_VARIANCE_AT_POLE = 0.7
"""The same limit for a band around a pole: with a tone of two thirds of the power the variance is 0.55, with
a mode nearly 1."""
STEADY_SHARE = 0.4
"""Share of the threshold of D that suffices at a pole whose envelope is steadier than that of a mode."""
MAX_TRACKED = 8
"""Most bands tracked, the steadiest first, until one contains a tone."""
LOWEST_LINE = 20.0
"""Lowest Fourier line at which tones are sought."""
HIGHEST = 0.4
"""Highest band, as a share of the sample rate."""
MAX_TONES = 9
"""Most tones that are subtracted."""


def drifting_tones(
    y: FloatArray, sample_rate_hz: float, *, highest_hz: float = np.inf
) -> tuple[tuple[PhaseTrack, ...], FloatArray]:
    """Return the drifting tones and the samples without them.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample.
    highest_hz : float, optional
        Upper limit of the bands that are scanned.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> drifting = np.sin(2 * np.pi * 0.5 * (t + 0.9 * np.sin(2 * np.pi * t / 300.0)))
    >>> noise = np.random.default_rng(1).standard_normal((2, 6000))
    >>> (tone,), left = drifting_tones(drifting + 0.3 * noise, 10.0)
    >>> [round(f, 2) for f in tone.swept_hz]
    [0.49, 0.51]
    """
    duration, top = y.shape[1] / sample_rate_hz, min(highest_hz, HIGHEST * sample_rate_hz)
    found: list[PhaseTrack] = []
    left = y
    for _ in range(MAX_TONES):
        lines = transform(left)
        track = _clearest(lines, duration, _bands(lines, duration, top))
        if track is None:
            break
        found.append(track)
        left = less_phase(left, track.phase(y.shape[1]))
    return tuple(found), left


def _clearest(lines: ComplexArray, duration_s: float, bands: list[Band]) -> PhaseTrack | None:
    """Return the tone in the steadiest band that contains one."""
    for band in sorted(bands, key=lambda b: b.variance)[:MAX_TRACKED]:
        track = _tone_in(lines, duration_s, band, 1.0)
        if track is not None:
            return track
    return None


def _tone_in(lines: ComplexArray, duration_s: float, band: Band, share: float) -> PhaseTrack | None:
    """Track the tone of a band, if it contains one."""
    room = (INTERVALS[-1] + lines_around(len(lines)) + MIN_LINES) / duration_s
    wide = baseband(lines, duration_s, band.middle_hz, band.half_hz + room)
    n = wide.signal.shape[1]
    own = band.combination.conj() @ fft.fft(wide.signal, axis=1)
    off = np.abs(fft.fftfreq(n, 1.0 / n) / duration_s + wide.middle_hz - band.middle_hz)
    signal = np.asarray(fft.ifft(np.where(off <= band.half_hz, own, 0.0)))
    return phase_track(wide, first_phase(signal), share=share)


def tones_at(lines: ComplexArray, duration_s: float, frequency_hz: FloatArray) -> Iterator[PhaseTrack | None]:
    """Yield the tone near each pole, None where there is none.

    The criteria are weaker than for the bands of a whole record. The bands of all poles are combined at once;
    tones are tracked one by one as the iterator advances.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Transforms of the channels, from zero frequency.
    frequency_hz : (n_poles,)
    """
    half = np.maximum(np.outer(frequency_hz, DRIFTS), MIN_LINES / duration_s)
    bands = bands_of(lines, duration_s, np.repeat(frequency_hz, len(DRIFTS)), half.ravel())
    for k, f in enumerate(frequency_hz):
        around = bands[k * len(DRIFTS) : (k + 1) * len(DRIFTS)]
        yield next(_crossing_tones(lines, duration_s, around, float(f)), None)


def _crossing_tones(
    lines: ComplexArray, duration_s: float, bands: list[Band], frequency_hz: float
) -> Iterator[PhaseTrack]:
    """Yield the tones of bands that cross a frequency."""
    for band in bands:
        if band.variance <= MAX_VARIANCE_AT_POLE:
            share = STEADY_SHARE if band.variance < band.expected else 1.0
            track = _tone_in(lines, duration_s, band, share)
            if track is not None and track.passes(frequency_hz):
                yield track


def _bands(lines: ComplexArray, duration_s: float, highest_hz: float) -> list[Band]:
    """Return the bands whose envelope is steadier than those of both neighbours."""
    found: list[Band] = []
    for drift in DRIFTS:
        middle, half = overlapping_bands(
            LOWEST_LINE / duration_s, highest_hz, drift, MIN_LINES / duration_s, STEP
        )
        row = bands_of(lines, duration_s, middle, half)
        v = np.array([band.variance for band in row])
        least = (v <= np.append(v[1:], np.inf)) & (v <= np.append(np.inf, v[:-1])) & (v < MAX_VARIANCE)
        found += [row[i] for i in np.flatnonzero(least)]
    return found
