"""A level followed through weather: the filter and smoother against all data at once, and jumps found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.watching import level as module
from jackettwin.watching.level import (
    FAST_DAYS,
    Hypotheses,
    Mixture,
    Readings,
    after_row,
    forecast,
    halved,
    mixture_quantiles,
    no_rows,
    rooted,
    smoothed,
)

SLOW = 20.0
SLOPES = np.array([0.01, 0.04])
COEFFICIENTS = np.array([[0.02, 2e-3], [0.02, 1e-3]])
NOISE = 1.5e-3


def readings(rng: np.random.Generator, n: int, level: np.ndarray) -> Readings:
    """Return daily rows of two quantities that a condition and the level move; one value is missing."""
    days = np.cumsum(rng.uniform(0.6, 1.6, n))
    rows = np.stack([np.ones(n), np.cos(days / 20.0)], axis=1)
    values = 1e-3 * rows[:, 1:] + level[:, None] * SLOPES + NOISE * rng.standard_normal((n, 2))
    values[3, 1] = np.nan
    return Readings(days, rows, values, np.full((n, 2), NOISE**2), np.arange(n) == n // 2)


def followed(known: Hypotheses, read: Readings) -> tuple[list[Hypotheses], Readings]:
    every, noise = [known], read.noise.copy()
    for r in range(read.days.size):
        known, noise[r] = after_row(known, read, r)
        every.append(known)
    return every, replace(read, noise=noise)


def test_filter_and_smoother_are_the_regression_on_all_data(
    rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of one hypothesis that never jumps: the mean and variance of a joint normal distribution, given all."""
    monkeypatch.setattr(module, "_GRID", np.array([[4e-4, 3e-3, 1.5, SLOW]]))
    monkeypatch.setattr(module, "JUMPS_A_DAY", 1e-300)
    n = 12
    read = readings(rng, n, np.linspace(0.0, -0.1, n))
    start = no_rows(SLOPES, COEFFICIENTS)
    every, read = followed(start, read)
    mean, cov = of_all_data(read, 4e-4, 3e-3, 1.5)
    last = every[-1]
    best = int(np.argmax(last.weights))
    # both are exact: what differs is rounding of matrices whose elements span six decades
    assert last.mean[best, -4] == pytest.approx(mean[n - 1], rel=1e-6)
    assert last.cov[best, -4, -4] == pytest.approx(cov[n - 1, n - 1], rel=1e-6)
    half = smoothed(start, last, read)
    np.testing.assert_allclose([m.level[0] for m in half], mean[:n], rtol=1e-6)
    np.testing.assert_allclose([m.level_std[0] ** 2 for m in half][1:], np.diag(cov)[1:n], rtol=1e-5)
    # less the reference: the weighted mean of the levels up to the middle, copied there
    weight = np.nansum(np.where(np.isfinite(read.values), SLOPES**2 / NOISE**2, 0.0), axis=1)[: n // 2 + 1]
    less = np.eye(n)
    less[:, : n // 2 + 1] -= weight / weight.sum()
    np.testing.assert_allclose([m.shift[0] for m in half], less @ mean[:n], rtol=1e-5, atol=1e-9)
    variance = np.diag(less @ cov[:n, :n] @ less.T)
    np.testing.assert_allclose([m.shift_std[0] ** 2 for m in half], variance, rtol=1e-4)
    now = last.mixture
    assert now.shift[best] == pytest.approx((less @ mean[:n])[-1], rel=1e-5)
    assert now.shift_std[best] ** 2 == pytest.approx(variance[-1], rel=1e-4)


def of_all_data(
    read: Readings, unexplained: float, walk: float, scale: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return mean and covariance of the levels after the rows, from the joint distribution of all."""
    n, m = read.values.shape
    t = read.days
    level = walk**2 * (np.minimum.outer(t, t) - t[0])
    apart = np.abs(np.subtract.outer(t, t))
    slow = unexplained**2 / 6.0 * (np.exp(-apart / FAST_DAYS) + np.exp(-apart / SLOW))
    total = np.zeros((n * m, n * m))
    cross = np.zeros((n, n * m))
    for a in range(m):
        for b in range(m):
            part = SLOPES[a] * SLOPES[b] * level + slow
            if a == b:
                part = part + slow + (read.rows * COEFFICIENTS[a] ** 2) @ read.rows.T
                part = part + np.diag(scale * read.noise[:, a] + unexplained**2 / 3.0)
            total[a * n : (a + 1) * n, b * n : (b + 1) * n] = part
        cross[:, a * n : (a + 1) * n] = SLOPES[a] * level
    y = read.values.T.ravel()
    seen = np.isfinite(y)
    gain = np.linalg.solve(total[np.ix_(seen, seen)], cross[:, seen].T).T
    return gain @ y[seen], level - gain @ cross[:, seen].T


def test_a_jump_is_found_where_and_as_large_as_it_is(rng: np.random.Generator) -> None:
    n, begun, size = 120, 70, -0.18
    read = readings(rng, n, np.where(np.arange(n) >= begun, size, 0.0))
    every, _ = followed(no_rows(SLOPES, COEFFICIENTS), read)
    jump = every[begun + 20].jump
    assert jump is not None and jump.probability > 0.95
    assert jump.days[0] <= read.days[begun] <= jump.days[2]
    assert jump.size[0] < size < jump.size[2]
    # without one, no jump is sure: 1e-3 a day are expected
    quiet, _ = followed(no_rows(SLOPES, COEFFICIENTS), readings(rng, n, np.zeros(n)))
    assert all(one.jump is None or one.jump.probability < 0.95 for one in quiet[1:])


def test_a_row_costs_the_same_whatever_came_before(rng: np.random.Generator) -> None:
    """Hypotheses are merged and left out: how many there are has a bound."""
    n = 300
    read = readings(rng, n, np.where(np.arange(n) >= 150, -0.1, 0.0))
    every, _ = followed(no_rows(SLOPES, COEFFICIENTS), read)
    most = module._MOST + module._PARENTS * len(module.JUMPS) * (module._YOUNG_ROWS + 1)
    assert max(known.log_weight.size for known in every) <= most


def test_an_outlier_is_no_jump(rng: np.random.Generator) -> None:
    read = readings(rng, 60, np.zeros(60))
    read.values[40] += np.array([0.05, 0.0])
    every, _ = followed(no_rows(SLOPES, COEFFICIENTS), read)
    now = every[-1].mixture
    low, high = mixture_quantiles(now.weights, now.level, now.level_std, (0.05, 0.95))
    assert low < 0.0 < high
    assert high - low < 0.1


def test_a_window_from_few_roots_smooths_as_the_whole_does(rng: np.random.Generator) -> None:
    read = readings(rng, 80, np.where(np.arange(80) >= 60, -0.18, 0.0))
    start = no_rows(SLOPES, COEFFICIENTS)
    every, used = followed(start, read)
    whole = smoothed(start, every[-1], used)
    cut = 40
    begun, _ = followed(halved(every[cut]), _from(read, cut))
    roots = rooted(every[cut], begun[-1])
    assert roots.log_weight.size <= 8 < every[cut].log_weight.size
    later, _ = followed(roots, _from(read, cut))
    part = smoothed(roots, later[-1], _from(used, cut))
    of = [mixture_quantiles(m.weights, m.level, m.level_std, (0.5,))[0] for m in (whole[-10], part[-10])]
    width = float(whole[-10].level_std.max())
    assert abs(of[0] - of[1]) < 0.2 * width  # merged by moments, and six hypotheses of each


def _from(read: Readings, cut: int) -> Readings:
    return Readings(read.days[cut:], read.rows[cut:], read.values[cut:], read.noise[cut:], read.copied[cut:])


def test_what_is_forecast_gets_wider(rng: np.random.Generator) -> None:
    every, _ = followed(no_rows(SLOPES, COEFFICIENTS), readings(rng, 40, np.zeros(40)))
    spans = [
        np.ptp(mixture_quantiles(m.weights, m.level, m.level_std, (0.05, 0.95)))
        for m in (every[-1].mixture, forecast(every[-1], 30.0), forecast(every[-1], 365.0))
    ]
    assert spans[0] < spans[1] < spans[2]
    assert forecast(every[-1], 30.0).weights.sum() == pytest.approx(1.0)


def test_a_forecast_has_the_variance_of_its_walk_and_its_jumps(rng: np.random.Generator) -> None:
    """Of a random walk and of one jump that comes at a known rate and is equally likely of each size."""
    every, _ = followed(no_rows(SLOPES, COEFFICIENTS), readings(rng, 40, np.zeros(40)))
    last, days = every[-1], 200.0

    def variance(m: Mixture) -> tuple[float, float]:
        level, shift = (w @ (s**2 + v**2) - (w @ v) ** 2 for w, v, s in (
            (m.weights, m.level, m.level_std), (m.weights, m.shift, m.shift_std)))  # fmt: skip
        return float(level), float(shift)

    walked = last.weights @ module._GRID[last.model, 1] ** 2 * days
    jumped = (1.0 - np.exp(-module.JUMPS_A_DAY * days)) * np.mean(np.square(module.JUMPS))
    more = np.subtract(variance(forecast(last, days)), variance(last.mixture))
    np.testing.assert_allclose(more, walked + jumped, rtol=1e-9)
