"""Bayes factors of steps against numerical integration."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import f as fisher, norm

from jackettwin.watching.diagnosis import expected_information
from jackettwin.watching.directions import SIZE_WEIGHTS, SIZES, Pattern, directions_of, log_bayes_factors
from jackettwin.watching.hours import OUTLIER
from jackettwin.watching.scatter import STRONGER, log_outlier_ratios, log_ratios, steadiness

LABELS, HZ = ("a", "b", "c"), np.array([0.30, 0.31, 1.0])


def test_pairs_and_all_modes_are_bet_on_and_stakes_add_up_to_the_share() -> None:
    found = directions_of("frequency", LABELS, HZ)
    assert found.names == ("a", "b", "c", "a and b", "all modes", "any")
    assert abs(np.exp(found.log_weights).sum() - 0.7) < 1e-12
    np.testing.assert_allclose(np.exp(found.log_size_weights).sum(axis=1), 1.0, rtol=1e-12)


def test_a_pattern_is_one_more_bet_and_those_alike_are_one() -> None:
    soft, brace = np.array([-0.1, -0.1, -1.0]), np.array([0.0, -0.3, -0.2])
    given = (Pattern("soil", soft), Pattern("scour", 1.1 * soft, 0.5), Pattern("brace", brace, 0.5))
    found = directions_of("frequency", LABELS, HZ, given)
    assert found.names[5:] == ("soil (or 1 alike)", "brace", "any")
    assert abs(np.exp(found.log_weights).sum() - 0.7) < 1e-12
    assert found.log_weights[5] - found.log_weights[6] == pytest.approx(np.log(3.0))
    assert found.members[6].tolist() == [False, True, True]


def test_a_pattern_that_falls_is_bet_on_as_a_mode_that_falls(rng: np.random.Generator) -> None:
    found = directions_of("frequency", LABELS, HZ, [Pattern("of the model", np.array([0.0, 0.0, -3e-3]))])
    info, score = 1e6 * np.eye(3), 1e3 * rng.standard_normal(3)
    factors = log_bayes_factors(found, info[None], score[None])[0]
    assert factors[found.names.index("of the model")] == pytest.approx(factors[found.names.index("c")])


def test_a_factor_is_the_integral_over_sizes(rng: np.random.Generator) -> None:
    found = directions_of("frequency", LABELS, HZ)
    root = rng.standard_normal((3, 3))
    info, score = 1e6 * (root @ root.T), 1e3 * rng.standard_normal(3)
    u = found.vectors[3]
    a, c = u @ info @ u, u @ score
    total = 0.0
    z = np.linspace(-8.0, 8.0, 40_001)
    for size, share in zip(SIZES["frequency"], SIZE_WEIGHTS["frequency"], strict=True):
        for sign, side in ((-1.0, 0.7), (1.0, 0.3)):
            d = sign * size + z * size / 3
            total += side * share * np.trapezoid(np.exp(c * d - 0.5 * a * d * d) * norm.pdf(z), z)
    got = log_bayes_factors(found, info[None], score[None])[0, 3]
    assert abs(got - np.log(total)) < 1e-8


def test_weights_of_sizes_that_are_stored_for_all_directions_are_those_of_each(
    rng: np.random.Generator,
) -> None:
    found = directions_of("frequency", LABELS, HZ)
    stored = replace(found, log_size_weights=found.log_size_weights[0])
    info, score = 1e6 * np.eye(3), 1e3 * rng.standard_normal(3)
    one, other = (log_bayes_factors(d, info[None], score[None]) for d in (found, stored))
    np.testing.assert_array_equal(one, other)


def test_a_size_that_is_not_tested_along_a_direction_is_tested_along_the_others() -> None:
    found = directions_of("frequency", LABELS, HZ)
    chosen = np.ones(found.log_size_weights.shape, dtype=np.bool_)
    chosen[0] = np.abs(found.sizes) == np.abs(found.sizes).max()
    info, score = 1e7 * np.eye(3), -1e7 * np.array([1e-3, 1e-3, 0.0])  # each falls by a thousandth, 3 σ
    all_of, some = (log_bayes_factors(d, info[None], score[None])[0] for d in (found, found.testing(chosen)))
    assert some[0] < all_of[0] - 2.0
    np.testing.assert_array_equal(some[1:], all_of[1:])


def test_under_no_change_a_factor_has_mean_one(rng: np.random.Generator) -> None:
    """What makes the watch's promise: E[BF] = 1 for b ~ N(0, A)."""
    found = directions_of("frequency", LABELS, HZ)
    info = np.diag([200.0, 300.0, 100.0])  # little enough that the factors' own scatter is finite
    score = rng.standard_normal((200_000, 3)) * np.sqrt(np.diag(info))
    factors = np.exp(log_bayes_factors(found, np.broadcast_to(info, (200_000, 3, 3)), score))
    # the scatter of the mean is measured on the factors themselves
    assert np.all(np.abs(factors.mean(axis=0) - 1.0) < 4.0 * factors.std(axis=0) / np.sqrt(200_000))


def test_louder_noise_speaks_for_itself_and_quiet_noise_against() -> None:
    nu = np.array([200.0])
    n = np.array([40.0])
    assert np.all(log_ratios(9.0 * n, n, nu) > 10.0)
    assert np.all(log_ratios(n, n, nu) < 0.0)
    assert log_ratios(0.0 * n, 0.0 * n, nu).tolist() == [[0.0] * len(STRONGER)]


def test_scatter_ratios_have_mean_one() -> None:
    n, nu = 12.0, 16.0
    x = np.geomspace(1e-4, 1e6, 200_001)
    ratio = np.exp(log_ratios(n * x, np.full(x.size, n), np.full(x.size, nu)))
    mean = np.trapezoid(ratio * fisher.pdf(x, n, nu)[:, None], x, axis=0)
    np.testing.assert_allclose(mean, 1.0, rtol=1e-5)  # of the grid


def test_scatter_ratios_have_mean_one_with_outliers() -> None:
    """One value in 250 is an outlier. Counted as noise at the limit of rejection, their mean was 14."""
    share = 0.004
    z = np.linspace(-OUTLIER, OUTLIER, 20_001)
    kept = np.exp(log_ratios(z**2, np.ones(z.size), np.full(z.size, 1e6)))
    mean = (1.0 - share) * np.trapezoid(kept * norm.pdf(z)[:, None], z, axis=0)
    mean += share * np.exp(log_outlier_ratios(np.array([share]))[0])
    np.testing.assert_allclose(mean, 1.0, rtol=2e-3)  # of outliers among louder noise


def test_restless_noise_is_not_steady(rng: np.random.Generator) -> None:
    n = np.full(200, 20.0)
    steady = rng.chisquare(20.0, 200)
    restless = steady * 6.0 / rng.chisquare(6.0, 200)
    assert steadiness(restless, n) <= 10.0 < steadiness(steady, n)


def test_what_all_causes_predict_alike_tells_nothing() -> None:
    share = np.array([0.2, 0.3, 0.5])
    assert expected_information(share, np.ones(3), np.ones(3)) < 1e-9
    entropy = -np.sum(share * np.log(share))
    assert abs(expected_information(share, np.array([0.0, 50.0, 99.0]), np.ones(3)) - entropy) < 1e-6
