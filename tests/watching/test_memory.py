"""Memory learnt from series whose memory is known, and what a year cannot know."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.watching.design import RegressionPrior
from jackettwin.watching.hours import Hours
from jackettwin.watching.learning import (
    LARGER,
    OCTAVES,
    LearntModels,
    _beyond_chance,
    _larger,
    _pooled,
    learn,
)

PRIOR = RegressionPrior(np.zeros((2, 1)), np.full((2, 1), 5.0))


def series(rng: np.random.Generator, days: tuple[float, ...]) -> Hours:
    """Return a year of two quantities, alike by 0.6, that move as a sum of processes of equal size."""
    n, root = 700, np.linalg.cholesky(np.array([[1.0, 0.6], [0.6, 1.0]]))
    t = np.sort(rng.uniform(0.0, 365.0, n))
    y = 0.7 * rng.standard_normal((n, 2))
    for time in days:
        x = root @ rng.standard_normal(2)
        for i in range(n):
            keep = np.exp(-(t[i] - t[i - 1]) / time) if i else 0.0
            x = keep * x + np.sqrt(1.0 - keep**2) * (root @ rng.standard_normal(2))
            y[i] += x / np.sqrt(len(days))
    none = np.zeros((n, 2))
    return Hours(t, np.ones((n, 1)), y, np.full((n, 2), 0.5), none, none)


def slow_share(learnt: LearntModels) -> float:
    """Return the share of the variance that lasts longer than ten days, by all models."""
    weight = np.exp(learnt.log_weights)
    return float(weight @ [memory.shares[memory.days > 10.0].sum() for memory in learnt.memories])


def test_one_time_constant_is_found(rng: np.random.Generator) -> None:
    learnt = learn(series(rng, (2.0,)), PRIOR)
    best = learnt.memories[0]
    assert best.days[0] in (1.0, 2.0, 4.0) and best.shares[0] > 0.8
    # two hundred independent values know a standard deviation to 5 %, the noise beside it to less
    assert best.std == pytest.approx(1.0, rel=0.25)
    assert best.scale == pytest.approx(0.7 / np.sqrt(0.5), rel=0.1)
    assert best.correlation[:, 0, 1] == pytest.approx(0.6, abs=0.25)


def test_hidden_weather_is_shared_by_what_is_slow_alone(rng: np.random.Generator) -> None:
    """Processes of a quarter day of each one's own, and of twelve days in common."""
    n = 900
    t = np.sort(rng.uniform(0.0, 365.0, n))
    x, y = np.zeros(3), np.empty((n, 2))
    for i in range(n):
        keep = np.exp(-np.diff(t[[i - 1, i]])[0] / np.array([0.25, 0.25, 12.0])) if i else np.zeros(3)
        x = keep * x + np.sqrt(1.0 - keep**2) * rng.standard_normal(3)
        y[i] = 0.5 * x[:2] + x[2] + 0.1 * rng.standard_normal(2)
    none = np.zeros((n, 2))
    hours = Hours(t, np.ones((n, 1)), y, np.full((n, 2), 0.01), none, none)
    told, untold = (learn(hours, PRIOR, hidden=h).memories[0] for h in (False, True))
    fast, slow = untold.correlation[0, 0, 1], untold.correlation[-1, 0, 1]
    assert untold.days[0] < 1.0 < untold.days[-1]
    assert slow > 0.7 > 0.3 > fast  # spectra of the family are not this one, so that none is 1 or 0
    assert np.ptp(told.correlation[:, 0, 1]) == 0.0


def test_memory_of_a_season_is_expected_where_there_is_some(rng: np.random.Generator) -> None:
    flicker, short = (learn(series(rng, days), PRIOR) for days in (OCTAVES, (1.0,)))
    assert slow_share(flicker) > 0.25 > 2.0 * slow_share(short)


def test_weights_add_up_and_nothing_is_believed_alone(rng: np.random.Generator) -> None:
    learnt = learn(series(rng, (2.0,)), PRIOR)
    assert np.exp(learnt.log_weights).sum() == pytest.approx(1.0)
    assert sum(weight > np.log(0.01) for weight in learnt.log_weights) >= 4


def test_few_values_leave_room_for_larger_processes() -> None:
    """Shares of ν/χ² for factors on a standard deviation: drawn at random, ν = 9."""
    drawn = np.sqrt(9.0 / np.random.default_rng(0).chisquare(9.0, 400_000))
    edges = [0.0, *np.sqrt(np.array(LARGER[1:]) * np.array(LARGER[:-1])), np.inf]
    expected = np.histogram(drawn, edges)[0] / drawn.size
    np.testing.assert_allclose(_larger(9.0, LARGER), expected, atol=2e-3)  # of the draws


def test_a_size_that_is_hardly_known_leans_on_the_others() -> None:
    """Three sizes known to 1 % hold their own; a fourth that is known to a factor e moves to them."""
    sizes, variance = np.array([0.0, 0.1, -0.1, 2.0]), np.array([1e-4, 1e-4, 1e-4, 1.0])
    shift, spread = _pooled(sizes, variance)
    assert np.abs(shift[:3]).max() < 1e-2
    assert 2.0 + shift[3] == pytest.approx(0.0, abs=0.2)  # the scatter of sizes that is granted
    assert spread[3] == pytest.approx(0.2, abs=0.05) and spread[:3] == pytest.approx(0.01, rel=0.01)


def test_sizes_that_differ_stay_as_they_are() -> None:
    """DerSimonian and Laird's estimate with equal weights: the sample's variance less σ²."""
    sizes, noise = np.array([-1.0, 0.0, 1.0]), 0.04
    between = np.var(sizes, ddof=1) - noise
    shift, _ = _pooled(sizes, np.full(3, noise))
    np.testing.assert_allclose(shift, -sizes * noise / (noise + between))


def test_quantities_that_drown_in_noise_are_taken_as_independent(rng: np.random.Generator) -> None:
    loud = series(rng, (2.0,))
    loud = replace(loud, values=loud.values + 15.0 * rng.standard_normal(loud.values.shape),
                   noise=loud.noise + 225.0)  # fmt: skip
    # their data tell nothing of 0.6: the prior's mean is 0, to the grid it is summed on
    assert abs(learn(loud, PRIOR).memories[0].correlation[0, 0, 1]) < 0.35


def test_one_quantity_may_be_larger_than_it_seemed(rng: np.random.Generator) -> None:
    learnt = learn(series(rng, (2.0,)), PRIOR)
    raised = [memory.std / learnt.memories[0].std for memory in learnt.memories]
    for q in range(2):
        assert any(r[q] > 1.2 and r[1 - q] == pytest.approx(1.0) for r in raised)


def test_correlations_by_chance_are_not_believed() -> None:
    """Twelve values of four independent quantities: what is left predicts others better (Stein 1956)."""
    drawn = np.random.default_rng(6).standard_normal((400, 12, 4))
    loss = []
    for x in drawn:
        seen = np.corrcoef(x.T)
        less = _beyond_chance(seen, np.full(4, 12.0), 5.0 / 17.0)
        # Kullback-Leibler from independent ones, up to what is common to both
        loss.append([np.linalg.slogdet(c)[1] + np.trace(np.linalg.inv(c)) for c in (seen, less)])
    assert np.percentile(np.diff(loss), 95) < 0.0 and np.mean(np.diff(loss)) < -0.5


def test_correlations_that_are_known_are_believed() -> None:
    """At 0.9 from sixty values, the variance (1 − 0.81)²/60 is 0.07 % of the square."""
    seen = np.array([[1.0, 0.9], [0.9, 1.0]])
    assert _beyond_chance(seen, np.full(2, 60.0), 0.02)[0, 1] == pytest.approx(
        0.9 * (1.0 - 0.19**2 / 60.0 / 0.81)
    )
    assert (_beyond_chance(np.array([[1.0, -0.2], [-0.2, 1.0]]), np.full(2, 12.0), 0.02) == np.eye(2)).all()
