"""Forces as Gaussian processes: their densities and their state space."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as la
from numpy.testing import assert_allclose

from jackettwin.sensing.latent_forces import LatentForce


@pytest.mark.parametrize("kind", ["gust", "disc", "wave"])
def test_the_state_space_has_the_density_that_is_said(kind: str) -> None:
    force = LatentForce("f", np.zeros(1), np.zeros((1, 12)), kind, 0.8, 3.0)
    A, Q, h = force.dynamics()
    assert h @ la.solve_continuous_lyapunov(A, -Q) @ h == pytest.approx(9.0, rel=1e-10)
    omega = np.array([0.05, 0.3, 0.8, 2.0, 9.0])
    made = [abs(h @ np.linalg.solve(1j * w * np.eye(len(A)) - A, np.sqrt(np.diag(Q)))) ** 2 for w in omega]
    assert_allclose(force.density(omega), made, rtol=1e-10)
    w = np.linspace(0.0, 4000.0, 4_000_001)
    # of a gust, 2a/πω lies beyond
    beyond = 9.0 * 2.0 * 0.8 / np.pi / 4000.0 if kind == "gust" else 0.0
    assert np.trapezoid(force.density(w), w) / np.pi + beyond == pytest.approx(9.0, rel=1e-5)
    # a history has the density in every band: 16,000 coefficients in the narrowest are within 2.4 %
    drawn = force.drawn(400_000, 0.2, np.random.default_rng(1))
    f, power = (
        2.0 * np.pi * np.fft.rfftfreq(drawn.size, 0.2),
        np.abs(np.fft.rfft(drawn)) ** 2 * 0.2 / drawn.size,
    )
    for low, high in ((0.05, 0.3), (0.5, 1.5), (1.5, 5.0)):
        band = (f > low) & (f < high)
        assert power[band].sum() == pytest.approx(force.density(f[band]).sum(), rel=0.05)


def test_levels_and_rates_are_replaced_together() -> None:
    force = LatentForce("f", np.zeros(1), np.zeros((1, 12)), "gust", 0.8, 3.0)
    assert force.with_level(2.0, 0.1) == replace(force, level=2.0, rate=0.1)
