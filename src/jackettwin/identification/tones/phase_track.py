r"""Phase of a tone tracked through a record, with a test by the residual whether it is a tone.

A tone of constant amplitude and drifting frequency becomes a single line if its phase is removed,

.. math:: z(t) = y(t)\,e^{-i\theta(t)}, \qquad
          \theta(t) = 2\pi f t + \sum_k c_k B_k(t),

where B are cubic splines. The phase is that of the best sinusoid in coloured Gaussian noise. The channels are
combined by :math:`w = R^{-1}a`, with a their amplitudes and R their covariance on the lines around; the
spline is fitted to the angle of :math:`w^H z`, weighted by its power, and both steps are repeated. The ratio
D of ``sinusoid.py`` then decides whether it is a tone. Removing a fitted phase also narrows the peak of a
mode, but the amplitude of a mode still varies. In 1,040 records of lightly damped modes (ζ from 0.2 %) no
band reached three quarters of ``least_ratio``, and one in a hundred records reached 0.4 of it. Tones with 0.3
of the rms of the channels that drift by up to 5 % have D from 1,000 to 60,000.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy  # scipy.interpolate is loaded where it is used
from numpy import fft

from jackettwin.arrays import ComplexArray, FloatArray
from jackettwin.identification.tones.sinusoid import lines_around, regularised, sinusoid

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

INTERVALS = (1, 4, 8, 16, 32)
"""Numbers of intervals of the spline; the smallest that fits nearly as well as the largest is used."""
MIN_FIRST_SHARE = 0.1
"""Share of ``least_ratio`` that D of the most flexible phase must reach for simpler ones to be tried; bands
of modes have 0.02 to 0.07."""
MAX_LOSS = 3.0
"""Largest factor by which D may be smaller for a simpler phase."""
ITERATIONS = 4
"""Number of corrections of the phase."""
DEGREE = 3
"""Of the splines of the phase: the frequency is smooth, and its rate continuous."""
END_SHARE = 0.02
"""Share of the record at each end that is ignored in the range of the tone's frequency."""
LEAST_RATIO = 120.0
"""Smallest D of a tone whose phase is a straight line."""
RATIO_PER_COEFFICIENT = 12.0
"""Increase of the smallest D per spline coefficient: a more flexible phase narrows a mode's peak more."""


@dataclass(frozen=True)
class Baseband:
    """Lines of all channels around a frequency as a slowly varying complex signal.

    Attributes
    ----------
    signal : (n_channels, n_lines) complex
        Signal at as many instants as lines, evenly spaced over the record.
    middle_hz : float
    duration_s : float
    """

    signal: ComplexArray
    middle_hz: float
    duration_s: float


@dataclass(frozen=True)
class PhaseTrack:
    """Smooth phase of a possible tone.

    Attributes
    ----------
    middle_hz, duration_s : float
    coefficients : (n_coefficients,)
        Spline coefficients of the phase minus 2π · ``middle_hz`` · time [rad].
    ratio : float
        D after removal of the phase.
    """

    middle_hz: float
    duration_s: float
    coefficients: FloatArray
    ratio: float

    def phase(self, n_samples: int) -> FloatArray:
        """Return the phase at each sample of the record [rad], (n_samples,)."""
        t = np.arange(n_samples) / n_samples
        return np.asarray(2.0 * np.pi * self.middle_hz * self.duration_s * t + self._spline(t))

    @cached_property
    def swept_hz(self) -> tuple[float, float]:
        """Lowest and highest frequency [Hz]; the ends of the spline are left out as uncertain."""
        t = np.linspace(END_SHARE, 1.0 - END_SHARE, 8 * len(self.coefficients))
        f = self.middle_hz + self._spline.derivative()(t) / (2.0 * np.pi * self.duration_s)
        return float(f.min()), float(f.max())

    def passes(self, frequency_hz: float) -> bool:
        """Tell whether the tone crosses a frequency."""
        low, high = self.swept_hz
        return low < frequency_hz < high

    @property
    def disturbed_hz(self) -> tuple[float, float]:
        """Range in which subtracting the tone also removes other motion [Hz]."""
        beyond = 0.5 * len(self.coefficients) / self.duration_s
        low, high = self.swept_hz
        return low - beyond, high + beyond

    @cached_property
    def _spline(self) -> BSpline:
        return scipy.interpolate.BSpline(_knots(len(self.coefficients) - DEGREE), self.coefficients, DEGREE)


def least_ratio(n_coefficients: int) -> float:
    """Return the smallest D of a tone whose phase has ``n_coefficients`` coefficients.

    Examples
    --------
    >>> least_ratio(0), least_ratio(19)
    (120.0, 348.0)
    """
    return LEAST_RATIO + RATIO_PER_COEFFICIENT * n_coefficients


def baseband(lines: ComplexArray, duration_s: float, frequency_hz: float, half_hz: float) -> Baseband:
    """Return the band around a frequency.

    Parameters
    ----------
    lines : (n_channels, n_lines)
        Transforms of the channels, from zero frequency.
    half_hz : float
        Half width of the band; less at the ends of the spectrum.
    """
    first = max(int((frequency_hz - half_hz) * duration_s), 1)
    last = min(int((frequency_hz + half_hz) * duration_s), lines.shape[1] - 1)
    half = (last - first) // 2
    inside = lines[:, first : first + 2 * half + 1]
    signal = np.asarray(fft.ifft(fft.ifftshift(inside, axes=1), axis=1))
    return Baseband(signal, (first + half) / duration_s, duration_s)


def phase_track(band: Baseband, start: FloatArray, *, share: float = 1.0) -> PhaseTrack | None:
    """Return the simplest smooth phase of a tone near an initial phase, None if there is no tone.

    Parameters
    ----------
    start : (n_instants,)
        Initial phase of the baseband signal [rad], accurate to about half a turn.
    share : float
        Share of ``least_ratio`` that D must exceed.
    """

    def is_tone(track: PhaseTrack) -> bool:
        return track.ratio > share * least_ratio(len(track.coefficients))

    reach = lines_around(len(band.signal))
    possible = [n for n in INTERVALS if n + DEGREE + reach < band.signal.shape[1] // 2]
    best: PhaseTrack | None = None
    for intervals in reversed(possible[-2:]):
        track = _refine_phase(band, start, intervals)
        if is_tone(track) and (best is None or track.ratio > best.ratio):
            best = track
        if track.ratio < MIN_FIRST_SHARE * least_ratio(len(track.coefficients)):
            break
    if best is None:
        return None
    phase_values = _values(band, best.coefficients)
    for intervals in possible:
        if intervals + DEGREE >= len(best.coefficients):
            break
        simpler = _refine_phase(band, phase_values, intervals)
        if is_tone(simpler) and MAX_LOSS * simpler.ratio > best.ratio:
            return simpler
    return best


def _refine_phase(band: Baseband, start: FloatArray, intervals: int) -> PhaseTrack:
    """Refine a phase by the remaining angle of the best combination of channels."""
    n_coefficients = intervals + DEGREE
    basis = _basis(band.signal.shape[1], intervals)
    coefficients = _fit_spline(basis, start, np.ones(len(start)))
    for _ in range(ITERATIONS):
        along = _along(band, basis @ coefficients)
        s = _combine(along, n_coefficients)
        turned = np.angle(s * np.sum(s).conj())
        coefficients = coefficients + _fit_spline(basis, turned, np.abs(s) ** 2)
    spectrum = fft.fftshift(_along(band, basis @ coefficients), axes=1)
    tone = sinusoid(spectrum, spectrum.shape[1] // 2)
    return PhaseTrack(band.middle_hz, band.duration_s, coefficients, tone.ratio)


def _along(band: Baseband, theta: FloatArray) -> ComplexArray:
    """Return the lines of the signal after removal of a phase, (n_channels, n_lines)."""
    return np.asarray(fft.fft(band.signal * np.exp(-1j * theta), axis=1))


def _combine(along: ComplexArray, within: int) -> ComplexArray:
    """Return wᴴz of the lines up to ``within`` from zero; the lines beyond determine the noise covariance."""
    n_channels, n = along.shape
    m = np.arange(within + 1, min(within + lines_around(n_channels), n // 2 - 1) + 1)
    around = along[:, np.concatenate([-m, m])]
    covariance = regularised(np.asarray(around @ around.conj().T / around.shape[1]))
    w = np.linalg.solve(covariance, along[:, 0])
    near = np.zeros(n, dtype=complex)
    inside = np.arange(-within, within + 1)
    near[inside] = w.conj() @ along[:, inside]
    return np.asarray(fft.ifft(near))


def _values(band: Baseband, coefficients: FloatArray) -> FloatArray:
    return np.asarray(_basis(band.signal.shape[1], len(coefficients) - DEGREE) @ coefficients)


def _knots(intervals: int) -> FloatArray:
    return np.concatenate([np.zeros(DEGREE), np.linspace(0.0, 1.0, intervals + 1), np.ones(DEGREE)])


@cache
def _basis(n: int, intervals: int) -> FloatArray:
    """Return the B-splines at n instants, (n, intervals + DEGREE), by the recursion of Cox and de Boor."""
    t, knots = np.arange(n)[:, None] / n, _knots(intervals)
    basis = ((knots[:-1] <= t) & (t < knots[1:])).astype(float)
    for degree in range(1, DEGREE + 1):
        width = knots[degree:] - knots[:-degree]
        share = np.divide(t - knots[:-degree], width, where=width > 0.0, out=np.zeros((n, len(width))))
        basis = (
            share[:, :-1] * basis[:, :-1] + np.where(width[1:] > 0.0, 1.0 - share[:, 1:], 0.0) * basis[:, 1:]
        )
    basis.flags.writeable = False
    return basis


def _fit_spline(basis: FloatArray, values: FloatArray, weight: FloatArray) -> FloatArray:
    """Return weighted least-squares coefficients, regularised where there is no weight."""
    weighted = basis.T * weight
    information = weighted @ basis
    information[np.diag_indices(len(information))] += 1e-6 * np.trace(information) / len(information)
    return np.asarray(np.linalg.solve(information, weighted @ values))


def first_phase(signal: ComplexArray, intervals: int = INTERVALS[-1]) -> FloatArray:
    """Return the smoothed phase of a slowly varying complex signal (n_instants,) [rad]."""
    basis = _basis(len(signal), min(intervals, max(len(signal) // 4, 1)))
    return np.asarray(basis @ _fit_spline(basis, np.unwrap(np.angle(signal)), np.abs(signal) ** 2))
