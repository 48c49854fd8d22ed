"""The periodogram of a record in a band, averaged where the spectrum is smooth."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import ComplexArray, FloatArray, IntArray
from jackettwin.signals import running_median, runs

if TYPE_CHECKING:
    from collections.abc import Sequence


LINES_IN_HALF_BANDWIDTH = 3
"""Groups of lines at a mode's peak are narrower than its half bandwidth by this factor."""
FAR_LINES = 6.0
"""The width of a group grows with its distance from that mode, divided by this."""
DITHER_SHARE = 0.3
"""Share of the local median spectrum added to model and data where the median has at most ``DITHER_LINES``
lines."""
DITHER_LINES = 90.0
"""Above this number of lines in the median, the dither falls in inverse proportion to it. With few lines a
fit overstates how accurately the peaks determine the ratios between channels."""
MEDIAN_SHARE_OF_BAND = 0.25
"""Width of the running median, as a share of the frequency it is taken at."""

MIN_CYCLES = 20.0
"""Fewest cycles of the lower end of the band in a part of a record that has its own lines."""


@dataclass(frozen=True)
class Periodogram:
    """Spectral matrices of groups of Fourier lines (two-sided density).

    Attributes
    ----------
    omega : (n_groups,)
        Mean angular frequency [rad/s].
    count : (n_groups,)
        Lines in each group.
    density : (n_groups, n_channels, n_channels) complex
        Mean of X Xᴴ / (duration), of the second time derivative of displacement-like channels.
    floor : (n_groups, n_channels)
        Local median of each channel's density, over a window a quarter of the frequency wide.
    dither : (n_groups, n_channels)
        Power added to the diagonal of model **and** data: a share of the floor.
    duration_s : float
        Of all stretches together.
    length_s : (n_groups,) or float
        Duration of the stretch from which a group of lines is.
    """

    omega: FloatArray
    count: FloatArray
    density: ComplexArray
    floor: FloatArray
    dither: FloatArray
    duration_s: float
    length_s: FloatArray | float

    @cached_property
    def dithered(self) -> ComplexArray:
        """The density with the dither on its diagonal, (n_groups, n_channels, n_channels)."""
        out = self.density.copy()
        channel = np.arange(out.shape[1])
        out[:, channel, channel] += self.dither
        return out

    @property
    def variance(self) -> FloatArray:
        """Variance of the lines of each group about their mean [rad²/s²], (n_groups,)."""
        return np.asarray((self.count**2 - 1.0) / 12.0 * (2.0 * np.pi / self.length_s) ** 2)

    @property
    def log_position(self) -> FloatArray:
        """ln(f/f_0), with f_0 the middle of the band, (n_groups,)."""
        log_f = np.log(self.omega)
        return np.asarray(log_f - 0.5 * (log_f[0] + log_f[-1]))


def periodogram(
    y: FloatArray,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    *,
    modes: tuple[FloatArray, FloatArray],
    derivatives: Sequence[int],
    avoid_hz: Sequence[tuple[float, float]] = (),
    dither_share: float | None = None,
) -> Periodogram:
    """Return the grouped periodogram of the band, without a taper.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero-mean samples; a missing one (NaN) counts as zero and the power is corrected for it. Where all
        channels miss it between parts of twenty cycles or more, each part has its own lines: what is of two
        times is independent.
    modes : (frequency_hz, damping_ratio)
        Approximate modal parameters; where they make the spectrum curve, lines are not grouped.
    derivatives : (n_channels,) int
    avoid_hz : sequence of (low, high)
        Groups of lines that touch one of these ranges are left out.
    dither_share : float, optional
        Dither as a share of the local median; by default one that falls with frequency. A small dither keeps
        spectral matrices regular where a record has little noise; a large one leaves only the peaks visible.
    """
    parts = _parts(y, sample_rate_hz, band_hz[0])
    each = [
        _of_stretch(
            y[:, part],
            sample_rate_hz,
            band_hz,
            modes=modes,
            derivatives=derivatives,
            avoid_hz=avoid_hz,
            dither_share=dither_share,
        )
        for part in parts
    ]
    if len(each) == 1:
        return each[0]
    order = np.argsort(np.concatenate([one.omega for one in each]), kind="stable")
    omega, count, density, floor, dither, length = (
        np.concatenate([getattr(one, name) for one in each])[order]
        for name in ("omega", "count", "density", "floor", "dither", "length_s")
    )
    duration = sum(one.duration_s for one in each)
    return Periodogram(omega, count, density, floor, dither, duration, length)


def _parts(y: FloatArray, sample_rate_hz: float, low_hz: float) -> list[slice]:
    """Return the parts of a record between the gaps that all channels have, or the whole if one is short."""
    found = runs(np.asarray(np.isfinite(y).any(axis=0)))
    if not len(found) or found[:, 1].min() < MIN_CYCLES / low_hz * sample_rate_hz:
        return [slice(0, y.shape[1])]
    return [slice(int(start), int(start + length)) for start, length in found]


def _of_stretch(
    y: FloatArray,
    sample_rate_hz: float,
    band_hz: tuple[float, float],
    *,
    modes: tuple[FloatArray, FloatArray],
    derivatives: Sequence[int],
    avoid_hz: Sequence[tuple[float, float]],
    dither_share: float | None,
) -> Periodogram:
    """Return the grouped periodogram of one stretch, with the arguments of ``periodogram``."""
    n_channels, n_samples = y.shape
    duration = n_samples / sample_rate_hz
    first, last = int(np.ceil(band_hz[0] * duration)), int(np.floor(band_hz[1] * duration))
    line = np.arange(max(first, 1), min(last, n_samples // 2) + 1)
    f = line / duration
    x = np.empty((n_channels, len(line)), dtype=complex)
    for row, own, times in zip(y, x, derivatives, strict=True):
        present = np.isfinite(row)
        own[:] = np.fft.rfft(np.where(present, row, 0.0))[line[0] : line[-1] + 1]
        own /= sample_rate_hz * np.sqrt(duration * present.mean())
        if times:
            own *= (2j * np.pi * f) ** times
    start = group_starts(f, duration, *modes)
    count = np.diff(np.append(start, len(f))).astype(float)
    density = np.empty((len(start), n_channels, n_channels), dtype=complex)
    for a in range(n_channels):
        for b in range(a, n_channels):
            density[:, a, b] = np.add.reduceat(x[a] * x[b].conj(), start) / count
            density[:, b, a] = density[:, a, b].conj()
    omega = 2.0 * np.pi * np.add.reduceat(f, start) / count
    middle = start + (count // 2).astype(int)
    floor = np.stack([_local_median(own, line)[middle] for own in x], axis=1)
    kept = np.ones(len(start), dtype=bool)
    end = f[np.append(start[1:], len(f)) - 1]
    for low, high in avoid_hz:
        kept &= (end < low) | (f[start] > high)
    omega, count, density, floor = omega[kept], count[kept], density[kept], floor[kept]
    if dither_share is None:
        lines = MEDIAN_SHARE_OF_BAND * omega * duration / (2.0 * np.pi)
        floor_share = (DITHER_SHARE * np.minimum(DITHER_LINES / lines, 1.0))[:, None]
    else:
        floor_share = np.full((1, 1), dither_share)
    length = np.full(len(omega), duration)
    return Periodogram(omega, count, density, floor, floor_share * floor, duration, length)


def group_starts(
    f: FloatArray, duration: float, frequency_hz: FloatArray, damping_ratio: FloatArray
) -> IntArray:
    """Return the first line of each group; groups are narrow where the spectrum of the modes curves."""
    width = np.full(len(f), np.inf)
    for own_f, half_bandwidth in zip(frequency_hz, frequency_hz * damping_ratio, strict=True):
        np.minimum(width, half_bandwidth / LINES_IN_HALF_BANDWIDTH + np.abs(f - own_f) / FAR_LINES, out=width)
    lines = np.maximum(width * duration, 1.0)
    return np.flatnonzero(np.diff(np.floor(np.cumsum(1.0 / lines) + 1e-9), prepend=-1.0) > 0.0)


def _local_median(x: ComplexArray, line: IntArray) -> FloatArray:
    """Return the running median of the power over a window proportional to frequency, corrected to a mean.

    The window has a fixed width on a logarithmic frequency axis. A periodogram line is exponentially
    distributed; its median is ln 2 times its mean.
    """
    n = 400
    grid = np.exp(np.linspace(np.log(line[0]), np.log(line[-1]), n))
    step = np.log(line[-1] / line[0]) / n
    width = max(int(MEDIAN_SHARE_OF_BAND / step), 9) | 1
    nearest = np.clip(np.round(grid).astype(int) - line[0], 0, len(line) - 1)
    smooth = running_median(np.abs(x[nearest]) ** 2, width) / np.log(2.0)
    return np.asarray(np.interp(line, grid, smooth))
