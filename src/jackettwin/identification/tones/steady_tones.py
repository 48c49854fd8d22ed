"""Detection and subtraction of steady tones, after which the response to random forces remains.

A sinusoid is fitted wherever a line stands out from those around it (``sinusoid.py``). With several channels
a tone near or within the peak of a mode is detected even if it is weaker, because it moves the channels in
another shape. If a tone drifts by a few lines, much of it remains after subtraction of a steady one; its
phase is then tracked (``phase_track.py``).
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
    regularised,
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
MIN_POWER_RATIO = 4.0
"""Smallest ratio of the whitened power of a line to that of the background at which a sinusoid is fitted."""
MAX_ELEMENTS = 2**18
"""Most elements of the lines' covariances held in memory at a time."""
MAX_TONES = 30
"""Most tones that are subtracted."""
MIN_RATIO_GAIN = 4.0
"""Smallest ratio of D for a curved phase to that for a straight one at which the tone counts as drifting."""


def steady_tones(
    y: FloatArray, sample_rate_hz: float
) -> tuple[tuple[float, ...], tuple[PhaseTrack, ...], FloatArray]:
    """Return steady tones [Hz], tracks of slightly drifting tones, and the samples without both.

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
    drifting: list[PhaseTrack] = []
    left, found = y, list[float]()
    if y.shape[1] // 2 <= 2 * (NEAREST_LINE + lines_around(len(y))):
        return (), (), left
    while len(found) < MAX_TONES:
        spectrum = transform(left)
        tones = [t for t in _clear_tones(spectrum) if _apart(t.position, found)]
        if not tones:
            break
        for tone in tones:
            found.append(tone.position)
            track = _drifting_track(spectrum, tone, duration)
            if track is None:
                left = _subtract(left, tone.position)
                steady.append(tone.position / duration)
            else:
                left = less_phase(left, track.phase(y.shape[1]))
                drifting.append(track)
    return tuple(steady), tuple(drifting), left


def _drifting_track(spectrum: ComplexArray, tone: Sinusoid, duration_s: float) -> PhaseTrack | None:
    """Return the phase track of a tone if it explains much more than a straight phase."""
    room = (INTERVALS[-1] + 2 * lines_around(len(spectrum))) / duration_s
    frequency = tone.position / duration_s
    band = baseband(spectrum, duration_s, frequency, room)
    n = band.signal.shape[1]
    straight = 2.0 * np.pi * (frequency - band.middle_hz) * duration_s * np.arange(n) / n
    track = phase_track(band, straight)
    return track if track is not None and track.ratio > MIN_RATIO_GAIN * tone.ratio else None


def without_tones(y: FloatArray, sample_rate_hz: float, tones_hz: Iterable[float]) -> FloatArray:
    """Return samples without the least-squares sinusoid near each frequency.

    The frequency is the best within three lines.

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
        top = strongest_line(spectrum, tone * y.shape[1] / sample_rate_hz)
        if top > 0:
            out = _subtract(out, sinusoid(spectrum, top).position)
    return out


def strongest_line(spectrum: ComplexArray, position: float) -> int:
    """Return the line of most power within three lines of a position; 0 if none has enough around it."""
    near = round(position) + np.arange(-3, 4)
    edge = lines_around(len(spectrum))
    near = near[(near > edge) & (near < spectrum.shape[1] - edge)]
    return int(near[np.argmax(np.sum(np.abs(spectrum[:, near]) ** 2, axis=0))]) if len(near) else 0


def _clear_tones(spectrum: ComplexArray) -> list[Sinusoid]:
    """Return the tones, the clearest first, none within reach of a clearer one."""
    ratio = _over_background(spectrum)
    clear = np.flatnonzero(ratio > MIN_POWER_RATIO)
    clear = clear[(ratio[clear] >= ratio[clear - 1]) & (ratio[clear] >= ratio[clear + 1])]
    tones = [sinusoid(spectrum, int(k)) for k in clear]
    apart: list[Sinusoid] = []
    for tone in sorted((t for t in tones if t.ratio > least_ratio(0)), key=lambda t: -t.ratio):
        if _apart(tone.position, [other.position for other in apart]):
            apart.append(tone)
    return apart


def _apart(position: float, others: Iterable[float]) -> bool:
    """Tell whether a tone is neither one of the others nor the residual of one."""
    return all(abs(position - other) > LINES for other in others)


def _over_background(spectrum: ComplexArray) -> FloatArray:
    """Return the whitened power of every line over that of the lines around it, (n_lines,).

    Its expectation is 1 in white noise. It is 0 near the ends, where there are too few lines around.
    """
    n_channels, n_lines = spectrum.shape
    reach = lines_around(n_channels)
    n = 2 * (reach - REACH)
    out = np.zeros(n_lines)
    chunk = max(MAX_ELEMENTS // n_channels**2, 4 * reach)
    for first in range(max(NEAREST_LINE, reach + 1), n_lines - reach, chunk):
        k = np.arange(first, min(first + chunk, n_lines - reach))
        wide = spectrum[:, k[0] - reach : k[-1] + reach + 1]
        products = np.zeros((wide.shape[1] + 1, n_channels, n_channels), dtype=complex)
        np.cumsum(wide.T[:, :, None] * wide.T[:, None, :].conj(), axis=0, out=products[1:])
        around = regularised((_moving(products, reach, reach) - _moving(products, reach, REACH)) / n)
        x = spectrum[:, k].T
        solved = np.linalg.solve(around, x[:, :, None])[:, :, 0]
        out[k] = np.einsum("ka,ka->k", x.conj(), solved).real
    return np.asarray(out * (max(n - n_channels, 1) / (n * n_channels)))


def _moving(sums: ComplexArray, ends: int, half: int) -> ComplexArray:
    """Return moving sums of 2 half + 1 terms from running sums, without ``ends`` terms at each end."""
    n = len(sums) - 1 - 2 * ends
    return np.asarray(sums[ends + half + 1 :][:n] - sums[ends - half :][:n])


def _subtract(y: FloatArray, position: float) -> FloatArray:
    """Return samples without the least-squares sinusoid at a frequency, given in lines."""
    return less_phase(y, 2.0 * np.pi * position / y.shape[1] * np.arange(y.shape[1]))
