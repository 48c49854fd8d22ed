"""Stated standard deviations of the directions of pairs."""

import numpy as np
import pytest

from jackettwin.watching.history import History, deviations, nearest_modes

KEPT, NONE = np.array([0]), np.zeros((400, 0))


@pytest.fixture
def pair(rng: np.random.Generator) -> History:
    """Return a pair 1 % apart, each frequency known to 0.3 %, whose directions are stated to first order."""
    hz = np.array([0.300, 0.303, 1.2]) * np.exp(0.003 * rng.standard_normal((400, 3)))
    mixed = 0.003 * np.sqrt(2.0)
    angle, std = np.full((2, 400, 3), np.nan)
    gap = np.abs(np.log(hz[:, 1] / hz[:, 0]))
    angle[:, 0] = 0.3 + mixed / 0.01 * rng.standard_normal(400)
    std[:, 0] = np.hypot(mixed / gap, 0.05)
    states = np.zeros(400, dtype=np.intp)
    return History(
        np.arange(400.0), ("a", "b", "c"), hz, 0.003 * hz, hz, hz, NONE, (), states, ("all",), angle, std
    )


def test_the_other_mode_of_a_pair_is_the_nearest_one(pair: History) -> None:
    near = nearest_modes(pair, KEPT)
    assert near.mode.tolist() == [1]
    assert near.gap == pytest.approx(np.log(0.303 / 0.300), rel=0.05)


def test_a_pair_that_noise_moves_apart_gains_no_weight(pair: History) -> None:
    near = nearest_modes(pair, KEPT)
    _, std = deviations(pair, "angle", KEPT, np.array([0.3]), np.ones(1), near)
    assert std[:, 0] == pytest.approx(
        np.full(400, np.hypot(0.003 * np.sqrt(2.0) / near.gap[0], 0.05)), rel=1e-6
    )  # rounding, where both frequencies nearly agree
    _, stated = deviations(pair, "angle", KEPT, np.array([0.3]), np.ones(1))
    assert np.ptp(stated) > 0.3


def test_without_both_frequencies_a_direction_is_taken_as_stated(pair: History) -> None:
    near = nearest_modes(pair, KEPT)
    pair.frequency[:5, 1] = np.nan
    _, std = deviations(pair, "angle", KEPT, np.array([0.3]), np.ones(1), near)
    assert pair.angle_std is not None
    assert np.array_equal(std[:5, 0], pair.angle_std[:5, 0])
