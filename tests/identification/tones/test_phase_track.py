"""The phase of a tone is found to a few hundredths of a radian; that of a mode makes no tone of it."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.identification.tones.phase_track import baseband, first_phase, least_ratio, phase_track

RATE = 5.0
T = np.arange(3000) / RATE
MIDDLE, HALF = 0.5, 0.09


def band_of(y):
    return baseband(np.fft.rfft(y, axis=1), 600.0, MIDDLE, HALF)


@pytest.mark.parametrize("drift", [0.0, 0.01, 0.05])
def test_phase_and_range_are_those_of_the_tone(rng, drift):
    phase = 2.0 * np.pi * MIDDLE * (T - drift * 300.0 / (2.0 * np.pi) * np.cos(2.0 * np.pi * T / 300.0))
    band = band_of(np.sin(phase) * np.array([[1.0], [-0.4]]) + 0.3 * rng.standard_normal((2, 3000)))
    track = phase_track(band, first_phase(band.signal[0]))
    assert track is not None
    assert track.ratio > least_ratio(len(track.coefficients))
    error = np.exp(1j * (track.phase(3000) - phase))
    inner = slice(60, -60)
    # noise of 35 coefficients in 3,000 samples: 0.03 rad; what the spline cannot bend: 0.05 rad
    assert np.std(np.angle(error * error[inner].mean().conj())[inner]) < 0.08
    assert track.swept_hz == pytest.approx((MIDDLE * (1.0 - drift), MIDDLE * (1.0 + drift)), abs=1.0 / 600.0)


def test_a_steady_tone_needs_the_fewest_coefficients(rng):
    band = band_of(np.sin(2.0 * np.pi * 0.5003 * T)[None] + 0.3 * rng.standard_normal((1, 3000)))
    track = phase_track(band, first_phase(band.signal[0]))
    assert track is not None
    assert len(track.coefficients) == 4


def test_the_range_does_not_depend_on_the_band(rng):
    """Invariant: the middle of the band is no property of the tone."""
    y = np.sin(2.0 * np.pi * (0.5 * T + 1e-5 * T**2))[None] + 0.2 * rng.standard_normal((1, 3000))
    lines = np.fft.rfft(y, axis=1)
    swept = []
    for middle in (0.49, 0.52):
        band = baseband(lines, 600.0, middle, HALF)
        track = phase_track(band, first_phase(band.signal[0]))
        assert track is not None
        swept.append(track.swept_hz)
    assert swept[0] == pytest.approx(swept[1], abs=2e-4)


@pytest.mark.parametrize("zeta", [0.002, 0.01])
def test_the_phase_of_a_mode_makes_no_tone_of_it(rng, zeta):
    system = ModalSystem(np.array([MIDDLE]), np.array([zeta]), np.array([[1.0, -0.4]]), np.eye(1), 0.02)
    for _ in range(30):
        band = band_of(simulate(system, rng, sample_rate_hz=RATE).data)
        assert phase_track(band, first_phase(band.signal[0])) is None


def test_more_is_asked_along_a_more_pliable_phase():
    assert np.all(np.diff([least_ratio(n) for n in (0, 4, 19, 35)]) > 0.0)
