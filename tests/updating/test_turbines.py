"""Turbines that share what their drawings have wrong, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.updating import stacked
from jackettwin.updating.model_error.marginal import covariance, errors_given

DRAWN, WEIGHED = 3.0, 2.0


@pytest.mark.parametrize("n", [1, 2, 10])
def test_what_is_shared_is_learnt_and_what_is_not_stays(n: int) -> None:
    """One datum a turbine, r = −(γφ + δψ) − e: φ is known to 1/(1 + nγ²/(1 + δ²)), each ψ never fully."""
    names = {f"t{i}": ("drawn", "weighed") for i in range(n)}
    gains = {turbine: np.array([[DRAWN, WEIGHED]]) for turbine in names}
    farm = stacked(gains, names, {"drawn"})
    assert farm.names[0] == (None, "drawn") and len(farm.names) == n + 1
    A = covariance(farm.gains)
    np.testing.assert_allclose(A, np.eye(n) * (1.0 + WEIGHED**2) + DRAWN**2)
    r = np.full(n, -6.0)
    mean, variance = errors_given(r, farm.gains)
    information = n * DRAWN**2 / (1.0 + WEIGHED**2)
    assert variance[0, 0] == pytest.approx(1.0 / (1.0 + information))
    assert mean[0] == pytest.approx(6.0 * n * DRAWN / (1.0 + WEIGHED**2) / (1.0 + information))
    # the own error is what is left of 6 once the shared one is known
    left = (6.0 - DRAWN * mean[0]) * WEIGHED / (1.0 + WEIGHED**2)
    np.testing.assert_allclose(mean[1:], left)


def test_a_farm_that_shares_nothing_is_each_alone(rng: np.random.Generator) -> None:
    names = {"a": ("foot", "foot", "mass"), "b": ("foot", "mass")}
    gains = {"a": rng.normal(size=(4, 3)), "b": rng.normal(size=(3, 2))}
    farm = stacked(gains, names, set())
    A = covariance(farm.gains)
    np.testing.assert_allclose(A[:4, :4], covariance(gains["a"]))
    np.testing.assert_allclose(A[4:, 4:], covariance(gains["b"]))
    assert not A[:4, 4:].any()
    # shared, the first foot of both is one unknown, and the second stays a's
    shared = stacked(gains, names, {"foot"})
    between = covariance(shared.gains)[:4, 4:]
    np.testing.assert_allclose(between, np.outer(gains["a"][:, 0], gains["b"][:, 0]))
