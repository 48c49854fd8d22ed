from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage, signal

from jackettwin.records.quality import faults
from jackettwin.signals import runs


def test_runs_cover_both_ends() -> None:
    assert runs(np.array([True, True, False, True])).tolist() == [[0, 2], [3, 1]]
    assert runs(np.zeros(3, dtype=bool)).shape == (0, 2)


@pytest.mark.parametrize(("width", "height"), [(1, 10.0), (2, -20.0), (4, 50.0)])
def test_planted_spikes_are_marked_and_nothing_else(
    width: int, height: float, rng: np.random.Generator
) -> None:
    y = rng.normal(size=20_000)
    at = np.arange(500, 19_500, 700)
    planted = np.zeros(len(y), dtype=bool)
    for k in range(width):
        planted[at + k] = True
    y[planted] = height  # at least 9 standard deviations beyond anything the noise does here
    assert np.array_equal(faults.spikes(y), planted)


@pytest.mark.parametrize("kind", ["noise", "laplace", "tone", "quantised", "steps", "bursts"])
def test_lively_but_sound_signals_have_no_spikes(kind: str, rng: np.random.Generator) -> None:
    t = np.arange(60_000) / 100.0
    signals = {
        "noise": rng.normal(size=len(t)),
        "laplace": rng.laplace(size=len(t)),
        "tone": np.sin(2 * np.pi * 23.0 * t),
        "quantised": np.round(3.0 * np.sin(2 * np.pi * 0.18 * t)),
        "steps": np.repeat(rng.normal(size=600), 100),
        "bursts": rng.normal(size=len(t)) * (1.0 + 2.0 * (np.sin(0.05 * t) > 0.0)),
    }
    # e^-8 of Laplace noise lies beyond the threshold; nothing of the others does
    allowed = 1e-3 if kind == "laplace" else 0.0
    assert faults.spikes(signals[kind]).mean() <= allowed


@pytest.mark.parametrize("level", [0.8, 1.5, 2.5])
def test_clipping_is_marked_at_both_rails(level: float, rng: np.random.Generator) -> None:
    y = rng.normal(size=20_000)
    expected = np.abs(y) >= level
    assert np.array_equal(faults.clipped(np.clip(y, -level, level)), expected)


def test_one_rail_of_a_quantised_signal(rng: np.random.Generator) -> None:
    y = np.minimum(np.round(rng.normal(size=20_000), 2), 1.2)
    assert np.array_equal(faults.clipped(y), y == 1.2)


@pytest.mark.parametrize("step", [0.0, 1e-3, 0.05, 0.3])
def test_neither_tones_nor_coarse_converters_are_clipped(step: float, rng: np.random.Generator) -> None:
    t = np.arange(30_000) / 50.0
    for y in (np.sin(2 * np.pi * 0.1801 * t), rng.normal(size=len(t))):
        assert not faults.clipped(np.round(y / step) * step if step else y).any()


def test_a_frozen_reading_is_marked_whole(rng: np.random.Generator) -> None:
    y = rng.normal(size=5000)
    y[1000:1300] = y[1000]
    marked = faults.stuck(y, 100)
    assert marked[1000:1300].all() and marked.sum() == 300


def test_a_smooth_motion_on_a_large_offset_is_not_frozen(rng: np.random.Generator) -> None:
    """Gravity in a vertical channel: its rounding in single precision hides the bends of calm minutes."""
    t = np.arange(60_000) / 100.0
    calm = np.where((t > 200.0) & (t < 400.0), 0.02, 1.0)
    y = (9.81 + 2e-3 * calm * np.sin(2 * np.pi * 0.3 * t) + 1e-6 * calm * rng.normal(size=t.size)).astype(
        np.float32
    )
    assert not faults.stuck(y.astype(float), 100).any()
    joined = rng.normal(size=5000)
    joined[2000:2600] = np.linspace(joined[2000], joined[2599], 600)
    assert faults.stuck(joined.astype(np.float32).astype(float), 100).sum() == 600


def test_a_coarse_slow_signal_is_not_frozen() -> None:
    t = np.arange(30_000) / 50.0
    assert not faults.stuck(np.round(4 * np.sin(2 * np.pi * 0.02 * t)), 50).any()


@pytest.mark.parametrize("hold", [1, 2, 5, 20])
def test_hold_length_is_counted(hold: int, rng: np.random.Generator) -> None:
    assert faults.hold_length(np.repeat(rng.normal(size=500), hold)) == hold


@pytest.mark.parametrize(
    "y", [np.full(50, 0.1), np.full(50, np.nan), np.array([1.0]), np.zeros(0), np.full(9, 1e300)]
)
def test_what_does_not_vary_is_constant_and_disturbs_no_detector(y: np.ndarray) -> None:
    assert faults.is_constant(y)
    assert not faults.spikes(y).any() and not faults.clipped(y).any() and not faults.stuck(y, 5).any()
    assert faults.hold_length(y) == 1


def test_tiny_signals_on_a_large_offset_are_not_constant() -> None:
    assert not faults.is_constant(1e3 + 1e-9 * np.sin(np.arange(100.0)))


def test_crests_of_a_smooth_response_are_no_spikes(rng: np.random.Generator) -> None:
    """A tower mode at 20 Hz without noise: flanks follow the running median, its crests do not."""
    pole = np.exp((-0.01 + 1j) * 2 * np.pi * 1.3 / 20.0)
    response = signal.lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], rng.normal(size=24_000))
    smooth = signal.lfilter(*signal.butter(4, 2.0, fs=20.0), response)
    assert not faults.spikes(smooth).any()
    smooth[[3000, 7001, 7002]] += 10.0 * smooth.std()
    assert np.flatnonzero(faults.spikes(smooth)).tolist() == [3000, 7001, 7002]


def test_the_first_motion_after_a_release_is_no_spike(rng: np.random.Generator) -> None:
    """Modes up to half the sample rate set in at once and die out within seconds; a planted spike is told."""
    t = np.arange(2400) / 20.0 - 10.0
    f, zeta = np.array([0.38, 1.2, 6.3, 9.2]), np.array([0.013, 0.01, 0.05, 0.06])
    poles = 2.0 * np.pi * f * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    for _ in range(20):
        phase = 2.0 * np.pi * rng.uniform(size=4)
        decays = np.exp(np.outer(poles, np.maximum(t, 0.0)) + 1j * phase[:, None]).real
        y = np.where(t > 0.0, [1.0, 0.3, 2.0, 2.0] @ decays, 0.0) + 1e-3 * rng.normal(size=t.size)
        assert not faults.spikes(y).any()
        y[1500] += 20.0
        assert np.flatnonzero(faults.spikes(y)).tolist() == [1500]


@pytest.mark.parametrize("step", [1.5, 2.5, 4.0])
def test_a_step_of_a_coarse_reading_is_no_spike(step: float, rng: np.random.Generator) -> None:
    """Most samples round to one level, so that the scatter is zero and every other level was a spike."""
    t = np.arange(12_000) / 20.0
    modes = [(0.33, 1.0), (1.1, 0.7), (2.3, 0.4)]
    noise = ndimage.gaussian_filter1d(rng.normal(size=(3, 12_000)), 60.0, axis=1)
    y = sum(a * row / row.std() * np.sin(2 * np.pi * f * t) for (f, a), row in zip(modes, noise, strict=True))
    coarse = np.round(y / (step * y.std()))
    assert not faults.spikes(coarse).any()
    coarse[5000] += 12.0
    assert np.flatnonzero(faults.spikes(coarse)).tolist() == [5000]


def test_a_coarse_reading_is_told_by_its_levels(rng: np.random.Generator) -> None:
    y = rng.standard_normal(6_000)
    assert faults.quantiser_step(np.round(y)) == 1.0
    assert faults.quantiser_step(0.25 * np.round(4.0 * y)) == 0.25
    impulse = np.where(np.arange(6000) == 500, 1.0, 0.0)
    assert faults.quantiser_step(impulse) == 0.0 and faults.spikes(impulse).sum() == 1
    assert faults.quantiser_step(y) == 0.0
