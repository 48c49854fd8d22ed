"""Find steady tones in a record and subtract them, so that the response to random forces is left.

Where a line stands out of those around it, a sinusoid is fitted (``sinusoid.py``). With several channels a
tone need not outweigh a mode to be seen beside it, or within its peak: it moves them otherwise. One that
wanders by a few lines leaves much when a steady one is subtracted, and is followed instead
(``phase_track.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.tones.phase_track import INTERVALS, baseband, least_ratio, phase_track
from jackettwin.identification.tones.sinusoid import (
    LINES,
    REACH,
    lines_around,
    regular,
    sinusoid,
    transform,
)
from jackettwin.records import less_phase

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jackettwin.identification.tones.phase_track import PhaseTrack
    from jackettwin.identification.tones.sinusoid import Sinusoid


NEAREST_LINE = 8
"""Lowest Fourier line at which tones are sought."""
WORTH_A_LOOK = 4.0
"""Power of a line over that of the background, whitened, from which a sinusoid is fitted to it."""
ELEMENTS = 2**18
"""Most elements of the covariances of lines in memory at a time."""
MOST = 30
"""Most tones that are subtracted."""
MUCH_MORE = 4.0
"""Least D of a curved phase, over that of a straight one."""


def steady_tones(
    y: FloatArray, sample_rate_hz: float
) -> tuple[tuple[float, ...], tuple[PhaseTrack, ...], FloatArray]:
    """Return the frequencies of steady tones [Hz], those that wander by few lines, the samples less them all.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample and counts as zero.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> noise = np.random.default_rng(1).standard_normal((2, 6000))
    >>> tones, _, left = steady_tones(noise + np.sin(2 * np.pi * 0.5003 * t), 10.0)
    >>> [round(f, 4) for f in tones]
    [0.5003]
    """
    duration = y.shape[1] / sample_rate_hz
    steady: list[float] = []
    wandering: list[PhaseTrack] = []
    left, found = y, list[float]()
    if y.shape[1] // 2 <= 2 * (NEAREST_LINE + lines_around(len(y))):
        return (), (), left
    while len(found) < MOST:
        spectrum = transform(left)
        tones = [t for t in _clear_tones(spectrum) if _apart(t.position, found)]
        if not tones:
            break
        for tone in tones:
            found.append(tone.position)
            track = _wandering(spectrum, tone, duration)
            if track is None:
                left = _less(left, tone.position)
                steady.append(tone.position / duration)
            else:
                left = less_phase(left, track.phase(y.shape[1]))
                wandering.append(track)
    return tuple(steady), tuple(wandering), left


def _wandering(spectrum: ComplexArray, tone: Sinusoid, duration_s: float) -> PhaseTrack | None:
    """Return the phase of a tone that a straight one leaves much of."""
    room = (INTERVALS[-1] + 2 * lines_around(len(spectrum))) / duration_s
    frequency = tone.position / duration_s
    band = baseband(spectrum, duration_s, frequency, room)
    n = band.signal.shape[1]
    straight = 2.0 * np.pi * (frequency - band.middle_hz) * duration_s * np.arange(n) / n
    track = phase_track(band, straight)
    return track if track is not None and track.ratio > MUCH_MORE * tone.ratio else None


def without_tones(y: FloatArray, sample_rate_hz: float, tones_hz: Iterable[float]) -> FloatArray:
    """Return samples less the least-squares sinusoid near each frequency.

    The frequency is sought within three lines, where a sinusoid explains most.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample.

    Examples
    --------
    >>> t = np.arange(2000) / 10.0
    >>> left = without_tones(np.array([np.sin(2 * np.pi * 0.5003 * t)]), 10.0, [0.5])
    >>> bool(np.abs(left).max() < 1e-2)
    True
    """
    out = y
    for tone in tones_hz:
        spectrum = transform(out)
        near = round(tone * y.shape[1] / sample_rate_hz) + np.arange(-3, 4)
        edge = lines_around(len(y))
        near = near[(near > edge) & (near < spectrum.shape[1] - edge)]
        if len(near):
            top = near[np.argmax(np.sum(np.abs(spectrum[:, near]) ** 2, axis=0))]
            out = _less(out, sinusoid(spectrum, int(top)).position)
    return out


def _clear_tones(spectrum: ComplexArray) -> list[Sinusoid]:
    """Return the lines that are tones, the clearest first, none within reach of a clearer one."""
    ratio = _over_background(spectrum)
    clear = np.flatnonzero(ratio > WORTH_A_LOOK)
    clear = clear[(ratio[clear] >= ratio[clear - 1]) & (ratio[clear] >= ratio[clear + 1])]
    tones = [sinusoid(spectrum, int(k)) for k in clear]
    apart: list[Sinusoid] = []
    for tone in sorted((t for t in tones if t.ratio > least_ratio(0)), key=lambda t: -t.ratio):
        if _apart(tone.position, [other.position for other in apart]):
            apart.append(tone)
    return apart


def _apart(position: float, others: Iterable[float]) -> bool:
    """Tell whether a tone is none of the others, nor what one that is not quite steady leaves."""
    return all(abs(position - other) > LINES for other in others)


def _over_background(spectrum: ComplexArray) -> FloatArray:
    """Return the power of every line over that of the lines around, in units of their covariance, (n_lines,).

    Expected to be 1 where channels and lines are alike; 0 at the ends, where there are none around.
    """
    n_channels, n_lines = spectrum.shape
    reach = lines_around(n_channels)
    n = 2 * (reach - REACH)
    out = np.zeros(n_lines)
    chunk = max(ELEMENTS // n_channels**2, 4 * reach)
    for first in range(max(NEAREST_LINE, reach + 1), n_lines - reach, chunk):
        k = np.arange(first, min(first + chunk, n_lines - reach))
        wide = spectrum[:, k[0] - reach : k[-1] + reach + 1]
        products = np.zeros((wide.shape[1] + 1, n_channels, n_channels), dtype=complex)
        np.cumsum(wide.T[:, :, None] * wide.T[:, None, :].conj(), axis=0, out=products[1:])
        around = regular((_moving(products, reach, reach) - _moving(products, reach, REACH)) / n)
        x = spectrum[:, k].T
        solved = np.linalg.solve(around, x[:, :, None])[:, :, 0]
        out[k] = np.einsum("ka,ka->k", x.conj(), solved).real
    return np.asarray(out * (max(n - n_channels, 1) / (n * n_channels)))


def _moving(sums: ComplexArray, ends: int, half: int) -> ComplexArray:
    """Return sums of 2 half + 1 terms about each but ``ends`` terms at either end, from running sums."""
    n = len(sums) - 1 - 2 * ends
    return np.asarray(sums[ends + half + 1 :][:n] - sums[ends - half :][:n])


def _less(y: FloatArray, position: float) -> FloatArray:
    """Return samples less the least-squares sinusoid of a frequency, given in lines."""
    return less_phase(y, 2.0 * np.pi * position / y.shape[1] * np.arange(y.shape[1]))
