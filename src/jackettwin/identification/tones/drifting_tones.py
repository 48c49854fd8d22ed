"""Find tones that drift with the speed of a rotor, before anything else looks at the record.

Overlapping bands are scanned. In each the channels are combined such that what moves there stands out of what
moves around it, or along their main direction; a tone makes that signal's envelope steady, as random forces
on modes rarely do. From the phase of the steadiest the tone is followed (``phase_track.py``), which decides,
and is taken out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.tones.bands import Band, bands_of, overlapping
from jackettwin.identification.tones.phase_track import INTERVALS, baseband, first_phase, phase_track
from jackettwin.identification.tones.sinusoid import lines_around, transform
from jackettwin.records import less_phase

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jackettwin.identification.tones.phase_track import PhaseTrack


DRIFTS = (0.02, 0.07, 0.15)
"""Half widths of the bands that hold the drift, as a share of their middle …"""
FEWEST_LINES = 4.0
"""… and at least so many Fourier lines."""
STEP = 0.7
"""Distance of neighbouring bands, in half widths."""
WORTH_FOLLOWING = 0.5
"""Relative variance of the squared envelope below which a band is looked at closer."""
WORTH_A_LOOK = 0.7
"""The same at a pole, where less suffices: a tone of two thirds of the power leaves 0.55, a mode nearly 1."""
STEADY_SHARE = 0.4
"""Share of the usual D that suffices at a pole whose envelope is steadier than that of a mode."""
FOLLOWED = 8
"""Most bands that are examined, the steadiest first, until one contains a tone."""
LOWEST_LINE = 20.0
"""Lowest Fourier line at which tones are sought."""
HIGHEST = 0.4
"""Highest band, as a share of the sample rate."""
MOST = 9
"""Most tones that are subtracted."""


def drifting_tones(
    y: FloatArray, sample_rate_hz: float, *, highest_hz: float = np.inf
) -> tuple[tuple[PhaseTrack, ...], FloatArray]:
    """Return the tones that drift, and the samples less these tones.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample.
    highest_hz : float, optional
        No band above it is scanned.

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
    for _ in range(MOST):
        lines = transform(left)
        track = _clearest(lines, duration, _bands(lines, duration, top))
        if track is None:
            break
        found.append(track)
        left = less_phase(left, track.phase(y.shape[1]))
    return tuple(found), left


def _clearest(lines: ComplexArray, duration_s: float, bands: list[Band]) -> PhaseTrack | None:
    """Return the tone in the steadiest of the bands that holds one."""
    for band in sorted(bands, key=lambda b: b.variance)[:FOLLOWED]:
        track = _tone_in(lines, duration_s, band, 1.0)
        if track is not None:
            return track
    return None


def _tone_in(lines: ComplexArray, duration_s: float, band: Band, share: float) -> PhaseTrack | None:
    """Follow the tone of a band, if it holds one."""
    room = (INTERVALS[-1] + lines_around(len(lines)) + FEWEST_LINES) / duration_s
    wide = baseband(lines, duration_s, band.middle_hz, band.half_hz + room)
    n = wide.signal.shape[1]
    own = band.combination.conj() @ fft.fft(wide.signal, axis=1)
    off = np.abs(fft.fftfreq(n, 1.0 / n) / duration_s + wide.middle_hz - band.middle_hz)
    signal = np.asarray(fft.ifft(np.where(off <= band.half_hz, own, 0.0)))
    return phase_track(wide, first_phase(signal), share=share)


def tones_at(lines: ComplexArray, duration_s: float, frequency_hz: FloatArray) -> Iterator[PhaseTrack | None]:
    """Yield the tone in the bands around the frequency of each pole, None where there is none.

    Less is asked than of one of all the bands of a record. The bands of all poles are combined at once, and
    a tone is followed when it is asked for.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Of the channels' transforms, from zero frequency.
    frequency_hz : (n_poles,)
    """
    half = np.maximum(np.outer(frequency_hz, DRIFTS), FEWEST_LINES / duration_s)
    bands = bands_of(lines, duration_s, np.repeat(frequency_hz, len(DRIFTS)), half.ravel())
    for k, f in enumerate(frequency_hz):
        around = bands[k * len(DRIFTS) : (k + 1) * len(DRIFTS)]
        yield next(_passing(lines, duration_s, around, float(f)), None)


def _passing(
    lines: ComplexArray, duration_s: float, bands: list[Band], frequency_hz: float
) -> Iterator[PhaseTrack]:
    """Yield the tones of bands that pass a frequency."""
    for band in bands:
        if band.variance <= WORTH_A_LOOK:
            share = STEADY_SHARE if band.variance < band.expected else 1.0
            track = _tone_in(lines, duration_s, band, share)
            if track is not None and track.passes(frequency_hz):
                yield track


def _bands(lines: ComplexArray, duration_s: float, highest_hz: float) -> list[Band]:
    """Return the bands whose envelope is steadier than those of the bands on either side."""
    found: list[Band] = []
    for drift in DRIFTS:
        middle, half = overlapping(
            LOWEST_LINE / duration_s, highest_hz, drift, FEWEST_LINES / duration_s, STEP
        )
        row = bands_of(lines, duration_s, middle, half)
        v = np.array([band.variance for band in row])
        least = (v <= np.append(v[1:], np.inf)) & (v <= np.append(np.inf, v[:-1])) & (v < WORTH_FOLLOWING)
        found += [row[i] for i in np.flatnonzero(least)]
    return found
