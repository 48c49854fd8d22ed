"""Filter and smoother at rest against closed forms, and against the normal distribution written out."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jackettwin.errors import InputError, NumericalError
from jackettwin.sensing import discrete, steady_smoother


def model(rng: np.random.Generator, n: int = 4, m: int = 2) -> tuple[np.ndarray, ...]:
    A = rng.standard_normal((n, n))
    F = 0.9 * A / np.abs(np.linalg.eigvals(A)).max()
    G = rng.standard_normal((n, n))
    return F, G @ G.T, rng.standard_normal((m, n)), rng.uniform(0.5, 2.0, m)


def test_the_scalar_riccati_equation_has_its_root() -> None:
    """P² + (R − F²R − Q) P − QR = 0."""
    f, q, r = 0.95, 0.3, 2.0
    found = steady_smoother(np.array([[f]]), np.array([[q]]), np.eye(1), np.array([r]))
    b = r - f * f * r - q
    assert found.P[0, 0] == pytest.approx(0.5 * (-b + np.sqrt(b * b + 4.0 * q * r)), rel=1e-12)


def test_smoothing_is_the_mean_of_the_joint_normal_distribution(rng: np.random.Generator) -> None:
    """All states of 60 samples given all readings, by one dense matrix."""
    F, Q, C, R = model(rng)
    s = steady_smoother(F, Q, C, R)
    n, N = len(F), 60
    stationary = s.stationary
    cov = np.zeros((N * n, N * n))
    for j in range(N):
        block = stationary
        for k in range(j, N):
            cov[k * n : k * n + n, j * n : j * n + n] = block
            cov[j * n : j * n + n, k * n : k * n + n] = block.T
            block = F @ block
    H = np.kron(np.eye(N), C)
    _, y = s.draw(N, rng)
    S = H @ cov @ H.T + np.kron(np.eye(N), np.diag(R))
    exact = (cov @ H.T @ np.linalg.solve(S, y.ravel())).reshape(N, n)
    found, _ = s.smooth(y)
    # Λ of an endless record stands for that of 60 samples: 0.9^120
    assert_allclose(found, exact, atol=1e-4 * np.abs(exact).max())
    after = cov - cov @ H.T @ np.linalg.solve(S, H @ cov)
    middle = slice(30 * n, 31 * n)
    assert_allclose(s.smoothed, after[middle, middle], atol=1e-6 * np.abs(s.smoothed).max())
    wrong = steady_smoother(F, Q, -C, R).smooth(y)[0]
    assert np.abs(wrong - exact).max() > 0.5 * np.abs(exact).max()


def test_a_stream_tells_what_the_whole_record_does_up_to_its_lag(rng: np.random.Generator) -> None:
    F, Q, C, R = model(rng)
    s = steady_smoother(F, 1e-3 * Q, C, R)
    _, y = s.draw(600, rng)
    whole, _ = s.smooth(y)
    slowest = np.abs(np.linalg.eigvals(s.closed_loop)).max()
    for lag in (10, 40):
        tolerance = 3.0 * slowest**lag
        pieces, start = [], None
        for first in range(0, 400, 100):
            piece, start = s.smooth(y[first : first + 100 + lag], start, ahead=lag)
            pieces.append(piece)
        off = np.abs(np.concatenate(pieces) - whole[:400]).max() / np.abs(whole).max()
        assert 1e-3 * tolerance < off < tolerance


def test_errors_are_as_large_as_said(rng: np.random.Generator) -> None:
    """Two-sided: 20,000 samples of four states, correlated over some tens."""
    s = steady_smoother(*model(rng))
    x, y = s.draw(20_000, rng)
    ratio = (s.smooth(y)[0] - x).var(axis=0) / np.diag(s.smoothed)
    assert (np.abs(ratio - 1.0) < 0.1).all()


def test_the_filter_knows_what_the_smoother_does_of_the_last_sample(rng: np.random.Generator) -> None:
    """Of which both have read everything; and its errors are as large as P less what a reading tells."""
    F, Q, C, R = model(rng)
    s = steady_smoother(F, Q, C, R)
    x, y = s.draw(20_000, rng)
    found = s.filtered(y)
    assert_allclose(found[-1], s.smooth(y)[0][-1], rtol=1e-9)
    known = s.P - s.gain @ C @ s.P
    assert_allclose((found - x).var(axis=0) / np.diag(known), 1.0, atol=0.1)


def test_a_discrete_step_of_an_oscillator(rng: np.random.Generator) -> None:
    """Its stationary variance is that of continuous time, q/(4ζω³) of displacement."""
    w, zeta, q = 2.0, 0.05, 3.0
    F, Q = discrete(np.array([[0.0, 1.0], [-w * w, -2 * zeta * w]]), np.diag([0.0, q]), 0.05)
    s = steady_smoother(F, Q, np.array([[1.0, 0.0]]), np.ones(1))
    assert s.stationary[0, 0] == pytest.approx(q / (4.0 * zeta * w**3), rel=1e-10)
    assert s.stationary[1, 1] == pytest.approx(q / (4.0 * zeta * w), rel=1e-10)


def test_what_decays_within_a_step_is_noise_of_its_own() -> None:
    """A rate of 3,000 in steps of 0.05 s beside one of 0.1: e^{150} and e^{0.005}."""
    rates = np.array([3000.0, 0.1])
    F, Q = discrete(-np.diag(rates), np.diag(2.0 * rates), 0.05)
    assert_allclose(F, np.diag(np.exp(-0.05 * rates)), atol=1e-12)
    assert_allclose(Q, np.diag(1.0 - np.exp(-0.1 * rates)), atol=1e-12)


def test_bad_models_are_refused() -> None:
    with pytest.raises(InputError, match="must be positive"):
        steady_smoother(0.9 * np.eye(1), np.eye(1), np.eye(1), np.zeros(1))
    with pytest.raises(NumericalError, match="does not decay"):
        steady_smoother(1.1 * np.eye(1), np.eye(1), np.eye(1), np.ones(1))
