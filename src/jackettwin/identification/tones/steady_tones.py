r"""Find steady tones in a record and take them out, so that what is left is what random forces did.

A sinusoid at k + δ lines of a record's Fourier transform gives the lines around it

.. math:: X_{k+m} = a\,\frac{e^{2\pi i\delta} - 1}{2\pi i(\delta - m)}

and no more: less the best such a and δ, the lines are those of the background. A lightly damped mode has
a sharp peak as well, but one of random shape, of which a large part stays. The ratio

.. math:: D = a^H R^{-1} a / \max_{1\le|m|\le 4} r_m^H R^{-1} r_m, \qquad r_m = X_{k+m} - \hat X_{k+m},

R the covariance between channels of the lines around, tells them apart: in a thousand records it stays
below 22 for a mode whose half bandwidth is a line or more (ζfT ≥ 0.9: 0.5 % at 0.3 Hz in ten minutes). With
several channels a tone need not outweigh a mode to be seen beside it, or within its peak: it moves them
otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy import fft
from scipy.optimize import minimize_scalar

from jackettwin.records.tones import less_phase

if TYPE_CHECKING:
    from collections.abc import Iterable

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

LEAST_RATIO = 25.0
"""D of a tone."""
LINES = 4
"""Lines on either side that a mode fills as well …"""
FEWEST_LINES = 12
"""… and that make the covariance of the background, at least, …"""
LINES_A_CHANNEL = 1.5
"""… and for each channel."""
REACH = 2
"""Lines on either side on which a tone leaks most: no background where none is subtracted."""
LIFT = 1e-3
"""Share of each channel's power added to the covariance of the background, which may be singular."""
ROUNDS = 3
"""Times a sinusoid is fitted, each with the background of the one before."""
NEAREST_LINE = 8
"""Tones below this line of the record are not looked for."""
WORTH_A_LOOK = 4.0
"""Power of a line over that of the background, whitened, from which a sinusoid is fitted to it."""
CHUNK = 4096
"""Lines whose backgrounds are held in memory together."""
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


def steady_tones(y: FloatArray, sample_rate_hz: float) -> tuple[tuple[float, ...], FloatArray]:
    """Return the frequencies of the steady tones of a record [Hz], and the samples less the tones.

    Parameters
    ----------
    y : (n_channels, n_samples)
        Zero mean; NaN marks a missing sample and counts as zero.

    Examples
    --------
    >>> t = np.arange(6000) / 10.0
    >>> noise = np.random.default_rng(1).standard_normal((2, 6000))
    >>> tones, left = steady_tones(noise + np.sin(2 * np.pi * 0.5003 * t), 10.0)
    >>> [round(f, 4) for f in tones]
    [0.5003]
    """
    line = sample_rate_hz / y.shape[1]
    found: list[float] = []
    left = y
    if y.shape[1] // 2 <= 2 * (NEAREST_LINE + _lines(len(y))):
        return (), left
    while len(found) < MOST:
        tones = [t for t in _clear_tones(_transform(left)) if _apart(t.position, [f / line for f in found])]
        if not tones:
            break
        for tone in tones:
            left = _less(left, tone.position)
            found.append(tone.position * line)
    return tuple(found), left


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
        spectrum = _transform(out)
        near = round(tone * y.shape[1] / sample_rate_hz) + np.arange(-3, 4)
        edge = _lines(len(y))
        near = near[(near > edge) & (near < spectrum.shape[1] - edge)]
        if len(near):
            top = near[np.argmax(np.sum(np.abs(spectrum[:, near]) ** 2, axis=0))]
            out = _less(out, sinusoid(spectrum, int(top)).position)
    return out


def sinusoid(spectrum: ComplexArray, k: int) -> Sinusoid:
    """Fit one sinusoid of all channels to the lines around line k of their transforms."""
    reach = _lines(len(spectrum))
    m = np.arange(-reach, reach + 1)
    lines = spectrum[:, k + m]
    root = _root(lines[:, np.abs(m) > REACH])

    for _ in range(ROUNDS):
        white = np.asarray(np.linalg.solve(root, lines), dtype=complex)

        delta = _offset(white, m)
        shape = _leakage(delta, m)
        amplitude = lines @ shape.conj() / np.sum(np.abs(shape) ** 2)
        rest = lines - amplitude[:, None] * shape
        root = _root(rest[:, m != 0])
    power = np.sum(np.abs(np.linalg.solve(root, amplitude)) ** 2)
    near = rest[:, (m != 0) & (np.abs(m) <= LINES)]
    around = np.sum(np.abs(np.linalg.solve(root, near)) ** 2, axis=0)
    return Sinusoid(k + delta, float(power / max(around.max(), 1e-300)))


def _leakage(delta: float, m: npt.NDArray[np.int64]) -> ComplexArray:
    """Return what a unit sinusoid δ lines off gives the lines m."""
    return np.asarray(np.exp(1j * np.pi * (delta - m)) * np.sinc(delta - m))


def _offset(white: ComplexArray, m: npt.NDArray[np.int64]) -> float:
    """Return the δ of the sinusoid that explains most of whitened lines (n_channels, n_lines)."""

    def left_over(delta: float) -> float:
        shape = _leakage(delta, m)
        return -float(np.sum(np.abs(white @ shape.conj()) ** 2) / np.sum(np.abs(shape) ** 2))

    best = minimize_scalar(left_over, bounds=(-0.7, 0.7), method="bounded", options={"xatol": 1e-5})
    return float(best.x)


def _clear_tones(spectrum: ComplexArray) -> list[Sinusoid]:
    """Return the lines that are tones, the clearest first, none within reach of a clearer one."""
    ratio = _over_background(spectrum)
    clear = np.flatnonzero(ratio > WORTH_A_LOOK)
    clear = clear[(ratio[clear] >= ratio[clear - 1]) & (ratio[clear] >= ratio[clear + 1])]
    tones = [sinusoid(spectrum, int(k)) for k in clear]
    apart: list[Sinusoid] = []
    for tone in sorted((t for t in tones if t.ratio > LEAST_RATIO), key=lambda t: -t.ratio):
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
    reach = _lines(n_channels)
    n = 2 * (reach - REACH)
    out = np.zeros(n_lines)
    for first in range(max(NEAREST_LINE, reach + 1), n_lines - reach, CHUNK):
        k = np.arange(first, min(first + CHUNK, n_lines - reach))
        wide = spectrum[:, k[0] - reach : k[-1] + reach + 1]
        products = np.cumsum(wide.T[:, :, None] * wide.T[:, None, :].conj(), axis=0)
        products = np.concatenate([np.zeros((1, n_channels, n_channels)), products])
        at = k - k[0] + reach
        all_, inner = (products[at + half + 1] - products[at - half] for half in (reach, REACH))
        around = _lifted(np.asarray((all_ - inner) / n))
        x = spectrum[:, k].T
        solved = np.linalg.solve(around, x[:, :, None])[:, :, 0]
        out[k] = np.einsum("ka,ka->k", x.conj(), solved).real
    return np.asarray(out * (max(n - n_channels, 1) / (n * n_channels)))


def _lines(n_channels: int) -> int:
    """Return how many lines on either side make the background."""
    return max(FEWEST_LINES, int(np.ceil(LINES_A_CHANNEL * n_channels)))


def _root(lines: ComplexArray) -> ComplexArray:
    """Return the Cholesky factor of the covariance of lines (n_channels, n_lines)."""
    return np.asarray(np.linalg.cholesky(_lifted(lines @ lines.conj().T / lines.shape[1])))


def _lifted(covariance: ComplexArray) -> ComplexArray:
    """Return regular covariances (…, n_channels, n_channels)."""
    channel = np.arange(covariance.shape[-1])
    power = covariance[..., channel, channel].real
    out = covariance.copy()
    out[..., channel, channel] += LIFT * power + 1e-12 * power.mean(axis=-1, keepdims=True) + 1e-300
    return out


def _transform(y: FloatArray) -> ComplexArray:
    return np.asarray(fft.rfft(np.where(np.isfinite(y), y, 0.0), axis=1))


def _less(y: FloatArray, position: float) -> FloatArray:
    """Return samples less the least-squares sinusoid of a frequency, given in lines."""
    return less_phase(y, 2.0 * np.pi * position / y.shape[1] * np.arange(y.shape[1]))
