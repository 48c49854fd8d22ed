r"""Find steady tones in a record and take them out, so that what is left is what random forces did.

A sinusoid at k + δ lines of a record's Fourier transform gives the lines around it

.. math:: X_{k+m} = A\,\frac{e^{2\pi i\delta} - 1}{2\pi i(\delta - m)}

and no more: less the best such A and δ, the lines are those of the background. A lightly damped mode has
a sharp peak as well, but one of random shape, of which a large part stays. The ratio

.. math:: D = |A|^2 / \max_{1\le|m|\le 4} |X_{k+m} - \hat X_{k+m}|^2

tells them apart: in a thousand records it stays below 22 for a mode whose half bandwidth is a line or more
(ζfT ≥ 0.9: 0.5 % at 0.3 Hz in ten minutes), and a tone as strong as a mode, six half bandwidths away from
it, has 20 to 10⁴.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import fft, ndimage
from scipy.optimize import minimize_scalar

if TYPE_CHECKING:
    from collections.abc import Iterable

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LEAST_RATIO = 25.0
"""D of a tone."""
LINES = 4
"""Lines on either side that show the background."""
NEAREST_LINE = 8
"""Tones below this line of the record are not looked for."""
WORTH_A_LOOK = 12.0
"""Power of a line over that of the lines three to five away from which a sinusoid is fitted to it."""
MOST = 30
"""Tones taken out at most."""


@dataclass(frozen=True)
class Sinusoid:
    """The best sinusoid near a line of the transform.

    Attributes
    ----------
    position : float
        Frequency in lines.
    ratio : float
        D, of the channel in which it is largest.
    """

    position: float
    ratio: float


def steady_tones(y: FloatArray, sample_rate_hz: float) -> tuple[float, ...]:
    """Return the frequencies of the steady tones of a record [Hz], the clearest first.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample and counts as zero.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> noise = np.random.default_rng(1).standard_normal((2, 6000))
    >>> [round(f, 4) for f in steady_tones(noise + np.sin(2 * np.pi * 0.5003 * t), 10.0)]
    [0.5003]
    """
    line = sample_rate_hz / y.shape[1]
    left = np.where(np.isfinite(y), y, 0.0)
    found: list[float] = []
    tested: set[int] = set()
    while len(found) < MOST:
        spectrum = np.asarray(fft.rfft(left, axis=1))
        tone = _first_tone(spectrum, tested)
        if tone is None:
            break
        found.append(tone.position * line)
        left = _less(left, tone.position)
    return tuple(found)


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
        spectrum = np.asarray(fft.rfft(np.where(np.isfinite(out), out, 0.0), axis=1))
        near = round(tone * y.shape[1] / sample_rate_hz) + np.arange(-3, 4)
        near = near[(near > LINES) & (near < spectrum.shape[1] - LINES)]
        if len(near):
            top = near[np.argmax(np.sum(np.abs(spectrum[:, near]) ** 2, axis=0))]
            out = _less(out, sinusoid(spectrum, int(top)).position)
    return out


def sinusoid(spectrum: ComplexArray, k: int) -> Sinusoid:
    """Fit one sinusoid of all channels to the lines around line k of their transforms."""
    m = np.arange(-LINES, LINES + 1)
    lines = spectrum[:, k + m]

    def kernel(delta: float) -> ComplexArray:
        return np.asarray(np.exp(1j * np.pi * (delta - m)) * np.sinc(delta - m))

    def left_over(delta: float) -> float:
        return -float(np.sum(np.abs(lines @ kernel(delta).conj()) ** 2 / np.sum(np.abs(kernel(delta)) ** 2)))

    delta = float(minimize_scalar(left_over, bounds=(-0.7, 0.7), method="bounded", options={"xatol": 1e-5}).x)
    shape = kernel(delta)
    amplitude = lines @ shape.conj() / np.sum(np.abs(shape) ** 2)
    rest = np.abs(lines - amplitude[:, None] * shape) ** 2
    background = np.maximum(rest[:, m != 0].max(axis=1), 1e-300)
    return Sinusoid(k + delta, float(np.max(np.abs(amplitude) ** 2 / background)))


def _first_tone(spectrum: ComplexArray, tested: set[int]) -> Sinusoid | None:
    """Return the clearest line that is a tone; ``tested`` gathers those that are not, and the tone's."""
    power = np.abs(spectrum) ** 2
    ring = np.ones(11, dtype=bool)
    ring[3:8] = False
    around = ndimage.maximum_filter(power, footprint=ring[None], mode="nearest")
    ratio = np.max(power / np.maximum(around, 1e-300), axis=0)
    ratio[:NEAREST_LINE] = 0.0
    ratio[-LINES - 1 :] = 0.0
    clear = np.flatnonzero(ratio > WORTH_A_LOOK)
    for k in clear[np.argsort(-ratio[clear])]:
        if int(k) in tested:
            continue
        tested.add(int(k))
        tone = sinusoid(spectrum, int(k))
        if tone.ratio > LEAST_RATIO:
            tested |= set(range(int(k) - 2, int(k) + 3))
            return tone
    return None


def _less(y: FloatArray, position: float) -> FloatArray:
    """Return samples less the least-squares sinusoid of a frequency, given in lines."""
    return less_phase(y, 2.0 * np.pi * position / y.shape[1] * np.arange(y.shape[1]))


def less_phase(y: FloatArray, phase: FloatArray) -> FloatArray:
    """Return samples less the least-squares combination of the cosine and the sine of a phase."""
    basis = np.stack([np.cos(phase), np.sin(phase)])
    out = y.copy()
    for a, valid in enumerate(np.isfinite(y)):
        there = basis[:, valid]
        out[a, valid] -= np.linalg.solve(there @ there.T, there @ y[a, valid]) @ there
    return out
