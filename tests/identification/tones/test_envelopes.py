"""Tones are never modes, whatever their frequency, and leave the modes where they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import signal

from jackettwin.findings import Finding
from jackettwin.identification import identify
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.identification.tones.drifting_tones import tones_at
from jackettwin.identification.tones.envelopes import (
    envelope_variance,
    is_steady_tone,
    is_suspiciously_steady,
    least_variance,
)
from jackettwin.identification.tones.sinusoid import transform

RATE = 10.0


def test_envelope_of_a_tone_is_steady_and_of_noise_is_exponential(rng):
    t = np.arange(60_000) / RATE
    tone = np.sin(2 * np.pi * 0.5 * t)[None]
    one = np.ones(1, dtype=complex)
    assert envelope_variance(transform(tone), 6000.0, 0.5, one) < 0.05
    noise = rng.standard_normal((1, 60_000))
    # squared envelope of a Gaussian process: relative variance 1; 120 independent values
    assert envelope_variance(transform(noise), 6000.0, 0.5, one) == pytest.approx(1.0, abs=0.5)


@pytest.mark.parametrize("ratio", [0.5, 0.95, 1.5, 3.0])
def test_a_tone_as_strong_as_the_channel_is_not_a_mode(tower, rng, ratio):
    record = simulate(tower, rng, sample_rate_hz=RATE)
    f_tone = ratio * 0.3
    t = np.arange(record.data.shape[1]) / RATE
    wave = np.sqrt(2.0) * np.sin(2 * np.pi * f_tone * t + 0.1 * np.arange(8)[:, None])
    loud = replace(record, data=record.data + record.data.std(axis=1, keepdims=True) * wave)
    quiet_modes, loud_modes = identify(record).modes, identify(loud).modes
    assert all(abs(mode.frequency_hz / f_tone - 1.0) > 0.005 for mode in loud_modes)
    for mode in quiet_modes:
        nearest = min(loud_modes, key=lambda other: abs(other.frequency_hz - mode.frequency_hz))
        if abs(f_tone - mode.frequency_hz) > 6.0 * mode.damping_ratio * mode.frequency_hz:
            assert nearest.damping_ratio == pytest.approx(mode.damping_ratio, rel=0.05)
            continue
        assert "tone" in nearest.status_reason
        low, high = nearest.damping_ratio_interval_90
        assert low < tower.damping_ratio[np.argmin(np.abs(tower.frequency_hz - mode.frequency_hz))] < high


@pytest.mark.parametrize(
    "doubt",
    [
        Finding("steady_envelope"),
        Finding("no_peak", params={"ratio": 3.0}),
        Finding("tone_passes", params={"low_hz": 0.49, "high_hz": 0.51}),
    ],
)
def test_what_looks_like_a_wandering_order_of_a_rotor_is_called_so(doubt: Finding) -> None:
    """A wandering 3P is doubted by these codes, whose sentences spoke of tones and noise alone."""
    assert "rotor" in doubt.text and "order" in doubt.text


@pytest.mark.parametrize("drift", [0.03, 0.08])
def test_a_tone_that_drifts_with_the_rotor_is_not_a_mode(tower, rng, drift):
    """A blade-passing tone at 0.5 Hz whose speed goes up and down in five minutes."""
    record = simulate(tower, rng, sample_rate_hz=RATE)
    t = np.arange(record.data.shape[1]) / RATE
    f = 0.5 * (1.0 + drift * np.sin(2 * np.pi * t / 300.0))
    wave = np.sqrt(2.0) * np.sin(2 * np.pi * np.cumsum(f) / RATE + 0.1 * np.arange(8)[:, None])
    loud = replace(record, data=record.data + record.data.std(axis=1, keepdims=True) * wave)
    modes = identify(loud).modes
    assert not [m.frequency_hz for m in modes if 0.45 < m.frequency_hz < 0.55]
    for plain in identify(record).modes:
        nearest = min(modes, key=lambda other: abs(other.frequency_hz - plain.frequency_hz))
        # measured over eight such records: up to 6 %
        assert nearest.damping_ratio == pytest.approx(plain.damping_ratio, rel=0.1)


def test_harmonics_of_the_rotor_leave_the_modes_where_they_are(tower, rng):
    """1P, 3P, 6P and 9P, each as strong as the channel."""
    record = simulate(tower, rng, sample_rate_hz=RATE)
    t = np.arange(record.data.shape[1]) / RATE
    waves = sum(np.sqrt(2.0) * np.sin(2 * np.pi * n * 0.1601 * t + n) for n in (1, 3, 6, 9))
    loud = identify(replace(record, data=record.data + record.data.std(axis=1, keepdims=True) * waves))
    for plain, mode in zip(identify(record).modes, loud.modes, strict=True):
        assert mode.damping_ratio == pytest.approx(plain.damping_ratio, rel=0.05)
    assert sum("tone" in r.reason for r in loud.rejected) >= 3


def test_a_mode_beside_a_steady_tone_is_no_drifting_tone(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=RATE)
    t = np.arange(record.data.shape[1]) / RATE
    loud = record.data + record.data.std() * np.sin(2 * np.pi * 0.275 * t)
    assert list(tones_at(transform(loud), loud.shape[1] / RATE, np.array([0.30]))) == [None]


def test_a_channel_frozen_halfway_makes_no_tone_of_a_mode(tower, rng):
    record = simulate(tower, rng, sample_rate_hz=RATE)
    y = record.data.copy()
    y[1, y.shape[1] // 2 :] = y[1, y.shape[1] // 2]
    result = identify(replace(record, data=y))
    assert not [r for r in result.rejected if "tone" in r.reason]
    # the channel makes one mode look like two; what matters here is that none is taken for a tone
    assert sum(0.28 < m.frequency_hz < 0.31 for m in result.modes) >= 2


@pytest.mark.parametrize("amplitude", [0.2, 1.5])
@pytest.mark.parametrize("half_bandwidths", [0.0, 1.0, 3.0])
def test_a_tone_within_a_mode_flags_it_and_is_no_mode(rng, amplitude, half_bandwidths):
    """Of 96 such records all were flagged and all intervals, twice as wide, held the truth."""
    f, zeta = np.array([0.5, 1.1]), np.array([0.012, 0.01])
    shapes = np.array([[1.0, 0.8, 0.5, 0.2], [1.0, -0.2, -0.9, -0.6]])
    system = ModalSystem(f, zeta, shapes, np.diag(f**-2.0))
    record = simulate(system, rng, sample_rate_hz=5.0)
    t = np.arange(record.data.shape[1]) / 5.0
    tone_hz = f[0] * (1.0 + half_bandwidths * zeta[0])
    direction = np.array([0.6, 1.0, -0.5, 0.9])[:, None] * record.data.std(axis=1, keepdims=True)
    wave = np.sqrt(2.0) * amplitude * direction * np.sin(2.0 * np.pi * tone_hz * t + 0.7)
    first, second = identify(replace(record, data=record.data + wave)).modes
    assert "tone" in first.status_reason
    assert second.status == "ok"
    for mode, truth in zip((first, second), zeta, strict=True):
        low, high = mode.damping_ratio_interval_90
        assert low < truth < high
    assert first.damping_ratio_std > 1.8 * first.damping_ratio_cov_limit * first.damping_ratio


def test_modes_of_short_records_are_no_tones(tower):
    """Three minutes hold few independent values: some envelopes are as steady as those of a tone."""
    shapes = tower.mode_shapes / np.linalg.norm(tower.mode_shapes, axis=1, keepdims=True)
    taken, steady = 0, 0
    for seed in range(40):
        y = simulate(tower, np.random.default_rng(seed), duration_s=180.0, sample_rate_hz=5.0).data
        lines = transform(y)
        for f, zeta, shape in zip(tower.frequency_hz, tower.damping_ratio, shapes, strict=True):
            steady += envelope_variance(lines, 180.0, f, shape) < 0.25
            (drifting,) = tones_at(lines, 180.0, np.array([f]))
            taken += is_steady_tone(lines, 180.0, f, zeta, shape) or drifting is not None
    # a threshold that does not know the length of the record takes several of 160
    assert steady >= 3
    # 0.1 % each: two or more once in eighty such tests
    assert taken <= 1


def test_least_variance_grows_with_the_values_to_that_of_a_long_record():
    assert np.all(np.diff([least_variance(n) for n in (2, 5, 20, 100, 1e6)]) > 0)
    assert least_variance(1e6) == pytest.approx(1.0, abs=0.01)


def test_a_tone_that_swells_and_drifts_a_little_is_suspicious_and_a_mode_seldom_is() -> None:
    t = np.arange(6000) / 10.0
    shape = np.array([1.0, -0.5], dtype=complex)
    seen = {"tone": 0, "mode": 0}
    for seed in range(20):
        rng = np.random.default_rng(seed)
        keep = np.exp(-1.0 / 200.0)
        slow = signal.lfilter([1.0 - keep], [1.0, -keep], rng.standard_normal(12000))[6000:]
        swell = 1.0 + 0.3 * slow / slow.std()
        tone = swell * np.cos(2.0 * np.pi * 0.6 * (t + 0.4 * np.sin(2.0 * np.pi * t / 300.0)))
        pole = np.exp((-0.005 + 1j) * 2.0 * np.pi * 0.6 / 10.0)
        forces = rng.standard_normal(12000)
        mode = signal.lfilter([1.0], np.real(np.poly([pole, pole.conjugate()])), forces)[6000:]
        for name, y in (("tone", tone), ("mode", np.asarray(mode) / np.std(mode))):
            noisy = np.outer(shape.real, y) + 0.2 * rng.standard_normal((2, 6000))
            seen[name] += is_suspiciously_steady(transform(noisy), 600.0, 0.6, 0.004, shape)
    assert seen["tone"] >= 15
    # 2πζfT is 9 to 11: three in a hundred by chance
    assert seen["mode"] <= 3


def test_an_order_that_wanders_quickly_is_suspicious_and_a_mode_as_broad_is_not() -> None:
    """3P of a speed that wanders by 2 % within ten seconds, its amplitude by 20 %, and modes of 1.5 %."""
    seen = {"order": 0, "mode": 0}
    for seed in range(30):
        rng = np.random.default_rng(seed)
        keep = np.exp(-1.0 / 50.0)
        wander, swell = signal.lfilter([np.sqrt(1.0 - keep**2)], [1.0, -keep], rng.normal(size=(2, 4000)))
        order = (1.0 + 0.2 * swell) * np.cos(2.0 * np.pi * np.cumsum(0.5 + 0.01 * wander) / 5.0)
        pole = np.exp((-0.015 + 1j) * 2.0 * np.pi * 0.5 / 5.0)
        mode = signal.lfilter([1.0], np.real(np.poly([pole, pole.conjugate()])), rng.normal(size=4000))
        for name, y in (("order", order), ("mode", mode)):
            noisy = y[1000:] + 0.05 * y.std() * rng.normal(size=3000)
            seen[name] += is_suspiciously_steady(transform(noisy[None]), 600.0, 0.5, 0.015, np.ones(1))
    assert seen == {"order": 30, "mode": 0}
