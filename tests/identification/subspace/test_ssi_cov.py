"""SSI-cov on exact covariances recovers the system; every variant, every order alike."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import ssi_cov
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.subspace.covariances import covariances
from jackettwin.identification.subspace.ssi_cov import (
    LEAST_SQUARE,
    balanced_subspace,
    frequency_and_damping,
    hankel,
    order_poles,
)
from jackettwin.identification.synthetic import simulate

RATE = 10.0


def exact_covariances(n_lags, rng):
    """R_i = C A^{i-1} G of two modes with complex shapes, R_0 with noise on its diagonal."""
    f, zeta = np.array([0.3, 1.1]), np.array([0.01, 0.03])
    lam = 2 * np.pi * f * (-zeta + 1j * np.sqrt(1 - zeta**2))
    shapes = rng.standard_normal((2, 3)) + 0.1j * rng.standard_normal((2, 3))
    right = shapes / (-2.0 * lam.real)[:, None]
    lagged = np.array(
        [2.0 * ((shapes.T * np.exp(lam * i / RATE)) @ right.conj()).real for i in range(n_lags + 1)]
    )
    lagged[0] = lagged[0] + lagged[0].T + 10.0 * np.eye(3)
    return f, zeta, shapes, lagged


@pytest.mark.parametrize("weighting", ["br", "cva"])
@pytest.mark.parametrize("state_matrix", ["shift", "one-lag"])
def test_exact_covariances_give_the_exact_system(rng, weighting, state_matrix):
    f, zeta, shapes, lagged = exact_covariances(30, rng)
    subspace = ssi_cov(lagged, block_rows=15, max_order=4, weighting=weighting, state_matrix=state_matrix)
    (poles,) = order_poles(subspace, [4])
    got_f, got_zeta = frequency_and_damping(poles.eigenvalues, RATE)
    order = np.argsort(got_f)
    # limited by the conditioning of the factorisation, far below any statistical error
    np.testing.assert_allclose(got_f[order], f, rtol=1e-8)
    np.testing.assert_allclose(got_zeta[order], zeta, rtol=1e-6)
    np.testing.assert_allclose(np.diag(mac(poles.shapes[order], shapes)), 1.0, rtol=1e-8)


def test_measurement_noise_at_lag_0_does_not_reach_the_hankel_matrix(rng):
    *_, lagged = exact_covariances(30, rng)
    noisy = lagged.copy()
    noisy[0] += 100.0 * np.eye(3)
    np.testing.assert_array_equal(hankel(lagged, 15), hankel(noisy, 15))


def test_each_order_equals_a_plain_least_squares_solution(rng):
    y = rng.standard_normal((3, 2000)).cumsum(axis=1) * 0.05 + rng.standard_normal((3, 2000))
    lagged = np.array([y[:, i:] @ y[:, : 2000 - i].T / (2000 - i) for i in range(21)])
    subspace = ssi_cov(lagged, block_rows=10, max_order=20)
    u, s, _ = np.linalg.svd(hankel(lagged, 10))
    for order in (2, 7, 20):
        observability = u[:, :order] * np.sqrt(s[:order])
        plain = np.linalg.eigvals(np.linalg.pinv(observability[:-3]) @ observability[3:])
        ours = np.linalg.eigvals(subspace.state_matrix(order))
        # same least squares problem by QR and by pseudo-inverse
        np.testing.assert_allclose(np.sort_complex(ours), np.sort_complex(plain), rtol=0, atol=1e-6)


def test_poles_do_not_depend_on_how_the_hankel_matrix_is_factorised(tower):
    y = simulate(tower, np.random.default_rng(5), sample_rate_hz=5.0).data
    h = hankel(covariances(y / y.std(axis=1, keepdims=True), 40), 20)
    short, full = (balanced_subspace(h, 8, 30, factors=kept) for kept in (False, True))
    assert short.factors is None
    for one, other in zip(order_poles(short, range(1, 31)), order_poles(full, range(1, 31)), strict=True):
        # squaring the matrix costs half of the digits of its smallest singular value at most
        np.testing.assert_allclose(
            np.sort_complex(one.eigenvalues), np.sort_complex(other.eigenvalues), rtol=0, atol=1e-6
        )


def test_a_nearly_singular_hankel_matrix_is_not_squared(rng):
    f, *_, lagged = exact_covariances(30, rng)
    h = hankel(lagged, 15)
    values = np.linalg.svd(h, compute_uv=False)
    assert (values[5] / values[0]) ** 2 < LEAST_SQUARE
    full = balanced_subspace(h, 3, 6)
    # left vectors of values that squaring would lose are orthonormal all the same
    np.testing.assert_allclose(full.factors.left.T @ full.factors.left, np.eye(4), atol=1e-9)
    np.testing.assert_allclose(full.factors.singular_values[:4], values[:4], rtol=1e-9)
    (poles,) = order_poles(balanced_subspace(h, 3, 4, factors=False), [4])
    got_f, _ = frequency_and_damping(poles.eigenvalues, RATE)
    np.testing.assert_allclose(np.sort(got_f), f, rtol=1e-6)
