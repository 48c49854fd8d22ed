"""Tones that follow a rotor's speed are found whatever their frequency; modes are never taken for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import identify
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.identification.tones.drifting_tones import disturbed_hz, drifting_tones

RATE = 5.0
T = np.arange(3000) / RATE
SHAPES = np.array([[1.0, 0.8, 0.5, 0.2], [1.0, -0.2, -0.9, -0.6]])


def two_modes(rng, zeta=(0.012, 0.01)):
    system = ModalSystem(np.array([0.3, 1.0]), np.array(zeta), SHAPES, np.diag([10.0, 1.0]))
    return simulate(system, rng, sample_rate_hz=RATE)


def drifting(record, tone_hz, drift):
    """Return the record with a tone of the channels' rms whose speed goes up and down in five minutes."""
    phase = 2.0 * np.pi * tone_hz * (T - drift * 300.0 / (2.0 * np.pi) * np.cos(2.0 * np.pi * T / 300.0))
    wave = np.sqrt(2.0) * np.array([1.0, -0.8, 1.2, 0.9])[:, None] * np.sin(phase + 0.4)
    return replace(record, data=record.data + record.data.std(axis=1, keepdims=True) * wave)


def test_light_modes_are_no_tones(rng):
    """The variance that decides stays above 0.19 in 900 records of such modes; 0.06 makes a tone."""
    for _ in range(20):
        y = two_modes(rng, (0.005, 0.0035)).data
        swept, left = drifting_tones(y, RATE)
        assert swept == ()
        assert left is y


@pytest.mark.parametrize("tone_hz", [0.15, 0.24, 0.5, 1.6])
@pytest.mark.parametrize("drift", [0.01, 0.03])
def test_a_drifting_tone_is_followed_and_taken_out(rng, tone_hz, drift):
    record = two_modes(rng)
    loud = drifting(record, tone_hz, drift)
    ((low, high),), left = drifting_tones(loud.data, RATE)
    # the smoothed frequency, and six lines on either side
    assert low == pytest.approx(tone_hz * (1.0 - drift), abs=0.05 * tone_hz + 0.01)
    assert high == pytest.approx(tone_hz * (1.0 + drift), abs=0.05 * tone_hz + 0.01)
    # 25 dB of the tone at least; measured 27 to 41
    assert np.std(left - record.data) < 0.056 * np.std(loud.data - record.data)


@pytest.mark.parametrize("tone_hz", [0.15, 0.5])
def test_a_drifting_tone_anywhere_leaves_the_modes_where_they_are(tone_hz):
    """Below the modes, where it would set the band, and between them."""
    record = two_modes(np.random.default_rng(8))
    plain = identify(record)
    loud = identify(drifting(record, tone_hz, 0.02))
    assert [mode.status for mode in loud.modes] == ["ok", "ok"]
    for before, after in zip(plain.modes, loud.modes, strict=True):
        assert after.damping_ratio == pytest.approx(before.damping_ratio, rel=0.05)


def test_a_mode_the_tone_passes_is_flagged():
    record = two_modes(np.random.default_rng(9))
    loud = drifting(record, 0.27, 0.04)
    loud = replace(loud, data=record.data + 3.0 * (loud.data - record.data))
    flagged = [mode for mode in identify(loud).modes if mode.frequency_hz < 0.5]
    assert all("tone" in mode.status for mode in flagged)


def test_what_a_tone_leaves_reaches_a_thirtieth_of_its_frequency():
    assert disturbed_hz((0.3, 0.6)) == pytest.approx((0.29, 0.62))
