"""Tones that follow a rotor's speed are found whatever their frequency; modes are never taken for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import identify
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.identification.tones.drifting_tones import drifting_tones, tones_at
from jackettwin.identification.tones.sinusoid import transform

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
    """In 1,040 records of one to three modes of ζ from 0.2 % none had 0.8 of the D that makes a tone."""
    for _ in range(12):
        y = two_modes(rng, (0.005, 0.002)).data
        tones, left = drifting_tones(y, RATE)
        assert tones == ()
        assert left is y


@pytest.mark.parametrize("tone_hz", [0.15, 0.24, 0.5, 1.6])
@pytest.mark.parametrize("drift", [0.01, 0.03])
def test_a_drifting_tone_is_followed_and_taken_out(rng, tone_hz, drift):
    record = two_modes(rng)
    loud = drifting(record, tone_hz, drift)
    (tone,), left = drifting_tones(loud.data, RATE)
    # a line of the record
    assert tone.swept_hz == pytest.approx((tone_hz * (1.0 - drift), tone_hz * (1.0 + drift)), abs=1.0 / 600.0)
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
    assert all(mode.status == "doubtful" and "tone" in mode.status_reason for mode in flagged)


@pytest.mark.parametrize(("drift", "period_s"), [(0.02, 150.0), (0.04, 150.0), (0.08, 290.0), (0.02, 600.0)])
def test_a_drifting_tone_is_told_beside_a_strong_pair(tower, rng, drift, period_s):
    """Of 0.6 of the rms of the pair, at 1.3 times its frequency, in the proportions of the pair."""
    record = simulate(tower, rng, sample_rate_hz=5.0)
    f = 0.38 * (1.0 + drift * np.sin(2.0 * np.pi * T / period_s))
    shape = tower.mode_shapes[0] + tower.mode_shapes[1]
    wave = 0.6 * np.sqrt(2.0) * record.data.std(axis=1).max() * np.sin(2.0 * np.pi * np.cumsum(f) / 5.0)
    (tone,) = tones_at(transform(record.data + shape[:, None] * wave), 600.0, np.array([0.38]))
    assert tone is not None
    assert tone.swept_hz == pytest.approx((f.min(), f.max()), abs=0.01)


@pytest.mark.parametrize("wander", ["line", "walk"])
@pytest.mark.parametrize("rms", [0.3, 0.6])
def test_a_weak_blade_passing_tone_is_no_mode(tower, wander, rms):
    """6P of a rotor that turns at 7.0 to 7.4 rpm, with no signal of its speed."""
    rng = np.random.default_rng(4)
    record = simulate(tower, rng, sample_rate_hz=RATE)
    walk = np.cumsum(np.cumsum(rng.standard_normal(len(T))))
    course = T if wander == "line" else walk - np.linspace(0.0, walk[-1], len(T))
    f = 0.70 + 0.04 * (course - course.min()) / np.ptp(course)
    wave = rms * np.sqrt(2.0) * np.sin(2.0 * np.pi * np.cumsum(f) / RATE) * rng.uniform(0.5, 1.5, (8, 1))
    found = identify(replace(record, data=record.data + wave * record.data.std(axis=1, keepdims=True)))
    assert not [m for m in found.modes if 0.6 < m.frequency_hz < 0.9]
    assert [round(r.frequency_hz, 2) for r in found.rejected if r.reason.startswith("drifting")] == [0.72]


def test_no_band_above_the_highest_is_scanned(rng):
    y = drifting(two_modes(rng), 1.6, 0.02).data
    assert drifting_tones(y, RATE, highest_hz=1.0)[0] == ()
