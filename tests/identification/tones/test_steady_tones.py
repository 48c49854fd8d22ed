"""Lines of tones are told from the peaks of lightly damped modes and leave nothing behind."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.selection.candidates import is_nearest
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.identification.tones.sinusoid import MAX_OFFSET, sinusoid
from jackettwin.identification.tones.steady_tones import steady_tones, without_tones

RATE = 5.0
T = np.arange(3000) / RATE


def light_mode(rng, zeta=0.005):
    """Return ten minutes of a mode whose half bandwidth is one line: ζfT = 0.9."""
    system = ModalSystem(np.array([0.3]), np.array([zeta]), np.array([[1.0, -0.4]]), np.eye(1), 0.02)
    return simulate(system, rng, sample_rate_hz=RATE).data


def test_frequency_between_lines_is_found():
    y = np.sin(2.0 * np.pi * 0.50042 * T)[None]
    spectrum = np.fft.rfft(y, axis=1)
    # leakage of the negative frequency: 1/(2π·600) of the amplitude
    assert sinusoid(spectrum, 300).position / 600.0 == pytest.approx(0.50042, abs=2e-6)


def test_no_line_of_noise_is_a_tone_nor_one_far_away(rng):
    """Where most is explained at an end of what is tried, the parabola through it has no top."""
    noise = rng.standard_normal((500, 2, 3, 60))
    found = [sinusoid(real + 1j * imaginary, 30) for real, imaginary in noise]
    assert max(abs(tone.position - 30.0) for tone in found) <= MAX_OFFSET * (1.0 + 1e-12)
    # of 4,000 such lines none was above 7
    assert max(tone.ratio for tone in found) < 12.0


def test_a_lightly_damped_mode_is_no_tone(rng):
    """Of 4,500 such records, ζ from 0.2 %, none was taken; 5 % of those of ζ = 0.2 % had D above 25."""
    light = [steady_tones(light_mode(rng, zeta), RATE) for zeta in (0.005, 0.002) for _ in range(20)]
    assert [found[:2] for found in light] == [((), ())] * 40


@pytest.mark.parametrize("tone_hz", [0.1537, 0.27, 0.33, 0.9001, 1.8])
def test_a_tone_as_strong_as_the_mode_is_found_and_taken_out(rng, tone_hz):
    y = light_mode(rng)
    tone = np.sqrt(2.0) * y.std(axis=1, keepdims=True) * np.sin(2.0 * np.pi * tone_hz * T + 0.3)
    (found,), _, left = steady_tones(y + tone, RATE)
    # a fiftieth of a line
    assert found == pytest.approx(tone_hz, abs=0.02 / 600.0)
    assert np.std(left - y) < 0.1 * np.std(y)


def test_harmonics_of_a_rotor_are_all_found(rng):
    y = light_mode(rng)
    harmonics = [0.11, 0.33, 0.66, 1.32]
    for f in harmonics:
        y = y + 0.5 * y.std(axis=1, keepdims=True) * np.sin(2.0 * np.pi * f * T)
    assert sorted(steady_tones(y, RATE)[0]) == pytest.approx(harmonics, abs=1e-4)


def test_missing_samples_stay_missing(rng):
    y = light_mode(rng)
    y[0, 100:130] = np.nan
    left = without_tones(y, RATE, [0.7])
    np.testing.assert_array_equal(np.isnan(left), np.isnan(y))


def two_light_modes(rng):
    """Return ten minutes of six sensors on two light modes and one at 1 Hz."""
    shapes = np.random.default_rng(1).standard_normal((3, 6))
    f, zeta = np.array([0.3, 0.302, 1.0]), np.array([0.005, 0.005, 0.003])
    return simulate(ModalSystem(f, zeta, shapes, np.eye(3), 0.02), rng, sample_rate_hz=RATE).data


def test_lightly_damped_modes_of_many_sensors_are_no_tones(rng):
    """In 120 other records D stays below 14; 120 makes a tone."""
    assert [steady_tones(two_light_modes(rng), RATE)[0] for _ in range(30)] == [()] * 30


@pytest.mark.parametrize("amplitude", [0.2, 0.5, 1.5])
@pytest.mark.parametrize("half_bandwidths", [0.0, 0.5, 2.0, 6.0])
def test_a_tone_within_the_peak_of_a_mode_is_seen_by_what_it_moves(rng, amplitude, half_bandwidths):
    """It moves the sensors otherwise than the mode does, and nothing else moves them so."""
    y = two_light_modes(rng)
    tone_hz = 1.0 + half_bandwidths * 0.003
    wave = np.sin(2.0 * np.pi * tone_hz * T + 0.3) * rng.uniform(0.5, 1.5, 6)[:, None]
    tone = np.sqrt(2.0) * amplitude * y.std(axis=1, keepdims=True) * wave
    (found,), _, left = steady_tones(y + tone, RATE)
    assert found == pytest.approx(tone_hz, abs=0.1 / 600.0)
    # what is left differs by what the mode did at the one or two lines that went with the tone
    assert np.std(left - y) < 0.6 * np.std(y)


def test_a_tone_that_wanders_by_a_line_is_followed(rng):
    """A straight phase would leave a fifth of its amplitude, and a pole with it."""
    y = light_mode(rng)
    phase = 2.0 * np.pi * 0.5 * (T + 0.0008 * 600.0 / np.pi * np.cos(np.pi * T / 600.0))
    tone = np.sqrt(2.0) * y.std(axis=1, keepdims=True) * np.sin(phase)
    steady, (track,), left = steady_tones(y + tone, RATE)
    assert steady == ()
    assert track.swept_hz == pytest.approx((0.4996, 0.5), abs=1.0 / 600.0)
    assert np.std(left - y) < 0.05 * np.std(tone)


def test_a_pole_beside_a_light_mode_does_not_take_its_line_for_a_tone() -> None:
    lines = np.zeros((1, 400), complex)
    lines[0, 180] = 1.0  # at 0.3 Hz of 600 s
    own = 0.29996, 0.3056  # of the mode, and 3.4 lines beside
    assert [is_nearest(lines, 600.0, f, np.array(own)) for f in own] == [True, False]
    assert is_nearest(lines, 600.0, own[1], np.array(own[1:]))
