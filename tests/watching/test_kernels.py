"""The filter against the Cholesky factor of the whole series' covariance."""

import numpy as np

from jackettwin.watching.design import RegressionPrior
from jackettwin.watching.hours import Hours
from jackettwin.watching.memory import Memory, empty_bank, filtered, prior_belief

N, M, P = 60, 3, 2


def series(rng: np.random.Generator) -> tuple[Hours, Memory, np.ndarray]:
    days = np.cumsum(rng.exponential(0.4, N))
    rows = np.column_stack([np.ones(N), rng.standard_normal(N)])
    values = 0.01 * rng.standard_normal((N, M))
    values[rng.random((N, M)) < 0.2] = np.nan
    noise = rng.uniform(1e-6, 1e-5, (N, M))
    none = np.zeros((N, M))
    memory = Memory(
        np.array([1.1, 0.9, 1.3]), np.array([1e-3, 2e-3, 1.5e-3]), np.array([1.5, 8.0, 60.0]),
        np.array([0.8, 0.05, 0.15]),
        np.array([[1.0, 0.6, 0.1], [0.6, 1.0, -0.2], [0.1, -0.2, 1.0]]),
    )  # fmt: skip
    return Hours(days, rows, values, noise, none, none), memory, np.full((M, P), 0.02)


def covariance(hours: Hours, memory: Memory, prior: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the covariance of all seen values, row after row, their values and (row, quantity)."""
    at = [(i, q) for i in range(N) for q in range(M) if np.isfinite(hours.values[i, q])]
    out = np.zeros((len(at), len(at)))
    for a, (i, q) in enumerate(at):
        for b, (j, r) in enumerate(at):
            gap = abs(hours.days[i] - hours.days[j])
            out[a, b] = sum(
                c[q, r] * np.exp(-gap * a) for c, a in zip(memory.slow, 1.0 / memory.days, strict=True)
            )
            if q == r:
                out[a, b] += hours.rows[i] @ (prior[q] ** 2 * hours.rows[j])
        out[a, a] += hours.noise[i, q] * memory.scale[q] ** 2
    return out, np.array([hours.values[i, q] for i, q in at]), np.array(at)


def test_innovations_are_those_of_the_cholesky_factor(rng: np.random.Generator) -> None:
    hours, memory, prior = series(rng)
    sigma, y, at = covariance(hours, memory, prior)
    lower = np.linalg.cholesky(sigma)
    known = rng.standard_normal(prior.shape)
    y = y - np.array([hours.rows[i] @ known[q] for i, q in at])
    belief = prior_belief(memory, RegressionPrior(known, prior))
    done = filtered(memory, belief, empty_bank(M, belief.mean.size), hours, -np.inf)
    z = (done.innovation / np.sqrt(done.spread))[at[:, 0], at[:, 1]]
    np.testing.assert_allclose(z, np.linalg.solve(lower, y), atol=1e-8)
    expected = -0.5 * (y @ np.linalg.solve(sigma, y) + np.linalg.slogdet(2 * np.pi * sigma)[1])
    assert abs(done.log_likelihood - expected) < 1e-8 * abs(expected)


def test_what_is_said_of_steps_is_that_of_the_whole_series(rng: np.random.Generator) -> None:
    """Σ hhᵀ/s and Σ hν/s are SᵀΣ⁻¹S and SᵀΣ⁻¹y of the steps in the series; of two steps together as well."""
    hours, memory, prior = series(rng)
    sigma, y, at = covariance(hours, memory, prior)
    begins = (25, 40)
    belief = prior_belief(memory, RegressionPrior(np.zeros_like(prior), prior))
    bank, last = empty_bank(M, belief.mean.size, ramps=True), -np.inf
    for first, end in zip((0, *begins), (*begins, N), strict=True):
        part = Hours(*(getattr(hours, n)[first:end] for n in hours.__dataclass_fields__))
        done = filtered(memory, belief, bank.with_begin() if first else bank, part, last)
        belief, bank, last = done.belief, done.bank, float(part.days[-1])
    steps = [(at[:, 0] >= first)[:, None] * (at[:, 1][:, None] == np.arange(M)) for first in begins]
    for k, step in enumerate(steps):
        score = step.T @ np.linalg.solve(sigma, y)
        np.testing.assert_allclose(bank.info[k], step.T @ np.linalg.solve(sigma, step), rtol=1e-8)
        np.testing.assert_allclose(bank.score[k], score, rtol=1e-7, atol=1e-6 * np.abs(score).max())
    both = steps[1].T @ np.linalg.solve(sigma, steps[0])
    assert bank.cross is not None
    np.testing.assert_allclose(bank.cross[1, 0], both, rtol=1e-7, atol=1e-9 * np.abs(both).max())


def test_a_day_at_a_time_is_the_whole_at_once(rng: np.random.Generator) -> None:
    hours, memory, prior = series(rng)
    belief = prior_belief(memory, RegressionPrior(np.zeros_like(prior), prior))
    bank = empty_bank(M, belief.mean.size)
    whole = filtered(memory, belief, bank, hours, -np.inf)
    last = -np.inf
    for i in range(N):
        one = Hours(*(getattr(hours, n)[i : i + 1] for n in hours.__dataclass_fields__))
        belief = filtered(memory, belief, bank, one, last).belief
        last = float(one.days[-1])
    np.testing.assert_allclose(belief.mean, whole.belief.mean, rtol=1e-12)
    np.testing.assert_allclose(belief.cov, whole.belief.cov, rtol=1e-10, atol=1e-18)
