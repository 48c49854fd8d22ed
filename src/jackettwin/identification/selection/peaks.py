"""How a mode stands out of what is beside it, and when, seen through the filter that its shape makes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import BoolArray, ComplexArray, FloatArray
from jackettwin.signals import local_peaks

if TYPE_CHECKING:
    from jackettwin.identification.estimate import ModalEstimate

CLEAR = 3.0
"""Power of a peak, in one channel, over the median around it and over the valleys beside it: of noise,
averaged over fifteen half-overlapping segments, one line in ten million stands out so far."""
AROUND, FEWEST_AROUND = 0.3, 21
"""Width over which the median is taken, as a share of the frequency, and its fewest lines."""
BESIDE = (2.5, 8.0)
"""Half bandwidths from a mode between which the power beside it is taken, …"""
BESIDE_LINES = 4
"""… over so many lines a channel at least."""
REGULAR = 1e-4
"""Share of the mean power beside the mode that counts as noise of every channel."""
PARTS = 10
"""Of a record, whose power is held against each other."""


def clear_peaks_hz(frequency_hz: FloatArray, density: FloatArray) -> list[float]:
    """Return where any channel has a peak that stands clear of the level around it, ascending."""
    found: set[int] = set()
    for row in np.maximum(density, np.finfo(float).tiny):
        for k in local_peaks(np.log(row), prominence=np.log(CLEAR)):
            half = max(int(0.5 * AROUND * k), FEWEST_AROUND // 2)
            if row[k] > CLEAR * np.median(row[max(k - half, 1) : k + half + 1]):
                found.add(int(k))
    return [float(frequency_hz[k]) for k in sorted(found)]


def contrast(
    lines: ComplexArray, duration_s: float, mode: ModalEstimate, shape: ComplexArray
) -> tuple[float, float]:
    """Return the power at a mode over that beside it through its filter, and the excess over its deviation.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Fourier transform of the samples.
    shape : (n_channels,)
        In the scaling of the samples.
    """
    at, beside = _lines_of(lines, duration_s, mode)
    if at.sum() < 2 or beside.sum() <= len(lines):
        return np.inf, np.inf
    power = np.abs(_through(lines, beside, shape)) ** 2
    ratio = float(power[at].mean() / power[beside].mean())
    return ratio, float((ratio - 1.0) / np.sqrt(1.0 / at.sum() + 1.0 / beside.sum()))


def share_of_one_part(
    lines: ComplexArray, duration_s: float, mode: ModalEstimate, shape: ComplexArray
) -> float:
    """Return the largest share of a mode's power, through its filter, in two neighbouring tenths."""
    at, beside = _lines_of(lines, duration_s, mode)
    if beside.sum() <= len(lines):
        return 0.0
    wide = np.convolve(at, np.ones(2 * int(at.sum()) + 1), mode="same") > 0.0
    envelope = np.abs(np.fft.ifft(np.where(wide, _through(lines, beside, shape), 0.0))) ** 2
    parts = np.array([part.sum() for part in np.array_split(envelope, PARTS)])
    return float(np.max(parts[1:] + parts[:-1]) / parts.sum())


def _lines_of(lines: ComplexArray, duration_s: float, mode: ModalEstimate) -> tuple[BoolArray, BoolArray]:
    """Return the lines at a mode and those beside it, (n_lines,) each."""
    f = np.arange(lines.shape[1]) / duration_s
    half = max(mode.damping_ratio * mode.frequency_hz, 1.5 / duration_s)
    far = max(BESIDE[1] * half, BESIDE_LINES * len(lines) / duration_s)
    away = np.abs(f - mode.frequency_hz)
    return np.asarray(away <= half), np.asarray((away > BESIDE[0] * half) & (away <= far) & (f > 0.0))


def _through(lines: ComplexArray, beside: BoolArray, shape: ComplexArray) -> ComplexArray:
    """Return the lines through the filter that a shape makes against what is beside it, (n_lines,)."""
    around = lines[:, beside]
    matrix = around @ around.conj().T / beside.sum()
    matrix += REGULAR * np.trace(matrix).real / len(lines) * np.eye(len(lines))
    return np.asarray(np.linalg.solve(matrix, shape).conj() @ lines)
