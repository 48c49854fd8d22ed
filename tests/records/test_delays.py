"""Delays of pairs from their phases: closed forms, invariants, silence where there is nothing to tell."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.records.clocks.channel_delays import Network, against_main, per_channel, ties
from jackettwin.records.clocks.delays import (
    aligned,
    band_lines,
    doubled,
    gain_trajectories,
    long_delays,
    objective,
    phases,
    trajectories,
)

RATE = 20.0


def late(y: np.ndarray, samples: int) -> np.ndarray:
    out = np.roll(y, samples, axis=-1)
    out[..., :samples] = 0.0
    return out


def test_a_pair_is_late_by_its_delay(tower: SimpleNamespace) -> None:
    y = tower.record(1).data[[0, 2]]
    y[1] = late(y[1], 5)
    seen = phases(y, RATE, np.ones(2, complex))
    assert seen is not None
    search = seen.search_s
    value = objective(seen, doubled(seen), search)[:, 0]
    # channel 0 is 0.25 s ahead of channel 1: half a step of the search, and noise
    assert search[np.argmax(value)] == pytest.approx(-0.25, abs=0.02)
    assert value.max() / seen.total[0] > 0.95
    still = aligned(seen, np.array([0.0, 0.25]))
    assert search[np.argmax(objective(still, doubled(still), search)[:, 0])] == pytest.approx(0.0, abs=0.02)


def test_signs_and_gains_do_not_matter_to_a_delay(tower: SimpleNamespace) -> None:
    y = tower.record(2).data[:2]
    one, other = (phases(x, RATE, np.ones(2, complex)) for x in (y, y * np.array([[-3.0], [0.1]])))
    assert one is not None and other is not None
    np.testing.assert_allclose(doubled(one), doubled(other), atol=1e-9)


def test_a_velocity_is_a_quarter_of_a_turn_off(tower: SimpleNamespace) -> None:
    """Turned, its phase is that of an acceleration; not turned, no delay explains it."""
    y = tower.record(3).data[:2]
    lines = np.fft.rfft(y[1])
    omega = 2.0 * np.pi * np.fft.rfftfreq(y.shape[1], 1.0 / RATE)
    y[1] = np.fft.irfft(np.where(omega > 0.3, lines / np.maximum(1j * omega, 0.3j), 0.0), y.shape[1])
    right, wrong = (phases(y, RATE, np.array([1.0, turn])) for turn in (1j, 1.0 + 0.0j))
    assert right is not None and wrong is not None
    at_rest = [float(doubled(seen).real.sum() / seen.total.sum()) for seen in (right, wrong)]
    assert at_rest[0] > 0.9
    assert at_rest[1] < -0.9


def test_a_delay_that_jumps_shows_from_then_on(tower: SimpleNamespace) -> None:
    y = tower.record(4).data[:2]
    y[0, 6_000:] = y[0, 5_996:-4]
    seen = phases(y, RATE, np.ones(2, complex))
    assert seen is not None
    delay, explained, _ = trajectories(seen)
    half = len(delay) // 2
    # a fifth of the jump: two modes and a minute a window
    np.testing.assert_allclose(delay[:half], 0.0, atol=0.04)
    np.testing.assert_allclose(delay[half:], 0.2, atol=0.04)
    assert explained.min() > 0.9


def test_a_gain_shows_whatever_the_force_does(tower: SimpleNamespace) -> None:
    y = tower.record(5).data[:2]
    y[:, 4_000:] *= 3.0
    y[0, 6_000:] *= 2.0
    seen = phases(y, RATE, np.ones(2, complex))
    assert seen is not None
    gain = gain_trajectories(seen)[:, 0]
    half = len(gain) // 2
    assert np.mean(gain[half:]) - np.mean(gain[:half]) == pytest.approx(np.log(2.0), abs=0.03)


def test_long_delays_are_found_and_independent_channels_have_none(rng: np.random.Generator) -> None:
    common = rng.standard_normal(12_000)
    y = np.array([common, late(common, 240), rng.standard_normal(12_000)])
    pairs = np.array([[0, 1], [0, 2], [1, 2]])
    delay, weight = long_delays(band_lines(y, RATE), pairs, 2.0)
    assert delay == pytest.approx([-12.0, 0.0, 0.0], abs=0.1)
    assert weight[0] > 0.0
    assert weight[1] == weight[2] == 0.0


def test_pairs_come_down_to_channels_and_one_wrong_pair_does_not_matter() -> None:
    true = np.array([0.0, 0.2, 0.2, 0.0, 0.0])
    pairs = np.stack(np.triu_indices(5, 1), axis=1)
    delay = true[pairs[:, 0]] - true[pairs[:, 1]]
    delay[3] += 1.0
    network = Network(5, pairs, np.ones(10, dtype=bool), ties([None] * 5), 0.02)
    found = against_main(network, per_channel(network, delay, np.ones(10))[None, :])
    np.testing.assert_allclose(found[0], true, atol=1e-3)


def test_directions_are_tied_by_their_places() -> None:
    """Along x and along y the upper level is late; only its place says that it is one logger."""
    pairs = np.array([[0, 2], [1, 3]])
    network = Network(4, pairs, np.ones(2, dtype=bool), ties([9.0, 9.0, 5.0, 5.0]), 0.02)
    each = per_channel(network, np.array([0.2, 0.2]), np.full(2, 100.0))
    np.testing.assert_allclose(each - each[0], [0.0, 0.0, -0.2, -0.2], atol=1e-6)


@pytest.mark.parametrize("shape", [(2, 0), (2, 50), (2, 400), (1, 4_000)])
def test_short_and_silent_records_have_no_phases(shape: tuple[int, int]) -> None:
    seen = phases(np.zeros(shape), RATE, np.ones(shape[0], complex))
    assert seen is None or not seen.total.any()
