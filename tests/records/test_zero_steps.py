"""Steps of a channel's zero are found and taken back; drifts, gusts and sound channels are left alone."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.records.quality.zero_steps import without_steps, zero_steps


@pytest.mark.parametrize("size", [-1.0, 3.0, 10.0])
@pytest.mark.parametrize("at", [1_500, 7_000])
def test_a_step_is_found_and_taken_back(size: float, at: int, tower: SimpleNamespace) -> None:
    sound = tower.record(1).data[0]
    y = sound.copy()
    y[at:] += size * sound.std()
    (step,) = zero_steps(y)
    # two radians of the first mode, 0.18 Hz, where the step is as large as the vibration
    assert abs(step.at - at) < 40.0 / (2.0 * np.pi * 0.18) / abs(size) + 5.0
    assert step.by == pytest.approx(size * sound.std(), rel=0.05)
    left = without_steps(y, [step], 20.0)
    kept = np.isfinite(left)
    assert kept.mean() > 0.99
    off = np.abs(left[kept] - sound[kept]) > 0.1 * sound.std()
    assert off.mean() < 0.01


def test_two_steps_of_one_channel_are_both_taken_back(tower: SimpleNamespace) -> None:
    """A single step explains three quarters of both at most; the channel was of another time then."""
    sound = tower.record(2).data[1]
    y = sound.copy()
    y[4_000:] += 40.0 * sound.std()
    y[8_000:] -= 100.0 * sound.std()
    steps = zero_steps(y)
    assert [step.at for step in steps] == pytest.approx([4_000, 8_000], abs=3)
    left = without_steps(y, steps, 20.0)
    kept = np.isfinite(left)
    # zeros of three stretches of the vibration itself, each of about 35 cycles
    assert np.abs(left[kept] - sound[kept] - np.median(left[kept] - sound[kept])).max() < 0.2 * sound.std()


def test_sound_channels_drifts_and_swings_have_none(tower: SimpleNamespace) -> None:
    t = np.linspace(0.0, 1.0, 12_000)
    for seed in range(5):
        for row in tower.record(seed).data:
            for slow in (0.0, 5.0 * t, 3.0 * np.sin(2.0 * np.pi * 1.5 * t), 3.0 * t**2):
                assert not zero_steps(row + slow * row.std())
            gap = row.copy()
            gap[5_000:7_500] = np.nan  # a line across it would have the level of its ends
            assert not zero_steps(gap)
