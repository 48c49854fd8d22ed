"""Averages by the hour, and what is set aside."""

import numpy as np
import pytest

from jackettwin.watching.hours import DOUBTED, NEIGHBOURS, by_hour, outliers


def test_an_hour_is_a_weighted_mean_and_its_scatter() -> None:
    days = np.array([0.001, 0.01, 0.02, 0.05])
    values = np.array([[1.0], [2.0], [np.nan], [5.0]])
    noise = np.array([[1.0], [4.0], [1.0], [1.0]])
    hours = by_hour(days, np.zeros(4, dtype=np.intp), np.ones((4, 1)), values, noise, 1 / 24)
    np.testing.assert_allclose(hours.values[:, 0], [(1.0 + 2.0 / 4) / 1.25, 5.0])
    np.testing.assert_allclose(hours.noise[:, 0], [0.8, 1.0])
    np.testing.assert_allclose(hours.chi2[:, 0], [0.2**2 + 0.8**2 / 4, 0.0])
    assert hours.freedom[:, 0].tolist() == [1.0, 0.0]


def test_states_are_averaged_apart() -> None:
    states = np.array([0, 1, 0, 1], dtype=np.intp)
    values = np.array([[1.0], [10.0], [3.0], [30.0]])
    hours = by_hour(
        np.array([0.0, 0.005, 0.01, 0.015]), states, np.ones((4, 1)), values, np.ones((4, 1)), 1 / 24
    )
    assert sorted(hours.values[:, 0].tolist()) == [2.0, 20.0]


def test_a_value_apart_is_set_aside_and_a_step_is_not(rng: np.random.Generator) -> None:
    tail = rng.standard_normal((NEIGHBOURS, 1))
    today = rng.standard_normal((8, 1))
    today[3] = 9.0
    apart, *_ = outliers(today, np.ones((8, 1)), tail)
    assert np.flatnonzero(apart[:, 0]).tolist() == [3]
    shifted, *_ = outliers(today + 50.0, np.ones((8, 1)), tail)
    assert np.array_equal(shifted, apart)


@pytest.mark.parametrize("number", [3, 4])
def test_two_outliers_of_a_few_values_are_set_aside_alone(number: int, rng: np.random.Generator) -> None:
    """The middle of four lay between both pairs: all were rejected, as loud noise.

    Of three it was an outlier, and the good value was rejected: an alarm with 26 nats.
    """
    tail, today = rng.standard_normal((NEIGHBOURS, 1)), rng.standard_normal((number, 1))
    today[[1, 2], 0] -= [15.0, 17.0]
    apart, *_ = outliers(today, np.ones((number, 1)), tail)
    assert np.flatnonzero(apart[:, 0]).tolist() == [1, 2]
    shifted, *_ = outliers(rng.standard_normal((number, 1)) - 15.0, np.ones((number, 1)), tail)
    assert not shifted.any()


def test_a_doubted_value_stands_at_the_limit_of_doubt() -> None:
    """With its own variance times the factor no value that is kept is more than 2.2 deviations away."""
    tail, std = np.tile([[0.0], [0.1], [-0.1]], (3, 1)), 0.5
    today = np.array([[0.0], [1.5], [0.1], [-1.9], [0.0], [1.0], [-0.1], [0.1]])
    apart, doubt, _ = outliers(today, np.full(today.shape, std**2), tail)
    assert not apart.any()
    # the median of the day is 0.05, of which half of a tenth is the most by which one of a window differs
    distance = np.abs(today - 0.05) / np.sqrt(std**2 * doubt)
    far = np.abs(today[:, 0]) > 1.2
    np.testing.assert_allclose(distance[far], DOUBTED, atol=0.1 / std)
    np.testing.assert_array_equal(doubt[~far], 1.0)
