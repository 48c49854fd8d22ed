"""The threshold with which false alarms come as often as is promised, no more rarely."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import norm

from jackettwin.watching import start
from jackettwin.watching.overshoot import overshoot_share

from .conftest import made


def test_the_share_is_that_of_siegmunds_series() -> None:
    """ν(μ) = 2μ⁻² exp(−2 Σ Φ(−½μ√n)/n), and e^{−0.583μ} for small μ (Siegmund 1985)."""
    n = np.arange(1, 200_000)
    for mu in (0.2, 0.5, 1.0, 2.0, 4.0):
        exact = 2.0 / mu**2 * np.exp(-2.0 * np.sum(norm.cdf(-0.5 * mu * np.sqrt(n)) / n))
        # the closed form is an approximation: it is lower by 0.012 at most
        np.testing.assert_allclose(overshoot_share(np.array(mu)), exact, atol=0.015)
    np.testing.assert_allclose(overshoot_share(np.array(0.05)), np.exp(-0.583 * 0.05), rtol=5e-3)


def test_alarms_come_as_often_as_promised(rng: np.random.Generator) -> None:
    """Steps of unit noise that are tested together, with nothing changed: the mean time is the promise.

    It was 1.8 times that: R exceeds its threshold by a look's evidence.
    """
    mu, weight = np.array([0.25, 0.5, 1.0, 2.0]), np.array([0.2, 0.4, 0.3, 0.1])
    promised, number = 150.0, 800
    threshold = promised * float(weight @ overshoot_share(mu))
    r, times = np.zeros((number, mu.size)), []
    looks = 0
    while len(r):
        looks += 1
        z = rng.standard_normal((len(r), 1))
        r = (1.0 + r) * np.exp(np.minimum(z * mu - 0.5 * mu**2, 500.0))
        over = r @ weight >= threshold
        times += [looks] * int(over.sum())
        r = r[~over]
    # times are nearly exponential: their mean over 800 is known to 3.5 %, and ν is asymptotic
    assert abs(np.mean(times) / promised - 1.0) < 0.15


def test_accurate_records_lower_the_threshold_and_hidden_weather_leaves_it() -> None:
    baseline = made(days=100)
    watch = start(baseline)
    assert 0.02 < watch.crossing < 0.9
    np.testing.assert_allclose(watch.log_threshold, np.log(10.0 * 365.25 * watch.crossing))
    hidden = replace(
        baseline, conditions=np.zeros((baseline.days.size, 0)), condition_names=(),
    )  # fmt: skip
    assert start(hidden).crossing == 1.0
    assert start(baseline.between(0.0, 40.0)).crossing == 1.0


def test_steps_that_would_take_longer_than_a_year_are_not_tested() -> None:
    """They would hold weight in R and raise no alarm: 0.07 % where a mode wanders by 0.1 % for two days."""
    watch = start(made(days=100))
    tested = watch.blocks[0].directions.log_size_weights > -1e6
    small, large = np.argsort(np.abs(watch.blocks[0].directions.sizes))[[0, -1]]
    assert not tested[:, small].any() and tested[:, large].all()
    quick = start(made(days=100), arl_years=0.1)  # a lower threshold is reached by smaller steps
    assert np.all(tested <= (quick.blocks[0].directions.log_size_weights > -1e6))
    assert np.exp(watch.blocks[0].directions.log_size_weights).sum(axis=1).max() < 1.0
