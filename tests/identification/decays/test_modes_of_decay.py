"""Modes of a decay: close pairs, as nearly symmetric structures have them."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification.decays.modes_of_decay import modes_of_decay

RATE_HZ, F, ZETA = 20.0, 0.28, np.array([0.017, 0.018])
SHAPES = np.array([[1.0, 0.1, 0.4, 0.04], [-0.05, 0.6, -0.02, 0.25]])


def decay(f: np.ndarray, shapes: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the decay of modes on four channels, with noise, and noise alone."""
    t = np.arange(3200) / RATE_HZ
    zeta = ZETA[: len(f)]
    poles = 2.0 * np.pi * f * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    noise = 0.003 * np.random.default_rng(seed).standard_normal((4, 5000))
    return (shapes.T @ np.exp(np.outer(poles, t))).real + noise[:, :3200], noise[:, 3200:]


@pytest.mark.parametrize("split", [0.003, 0.02, 0.05])
@pytest.mark.parametrize("seed", range(2))
def test_a_close_pair_is_two_modes(split: float, seed: int) -> None:
    """A low model order has one pole between the two, which alone explains the most."""
    f = F * np.array([1.0, 1.0 + split])
    y, noise = decay(f, SHAPES, seed)
    found = modes_of_decay(y, RATE_HZ, F, noise)
    assert found is not None
    order = np.argsort(found.fit.frequency_hz)
    # a tenth of the split, and some 2 % of ζ by the Cramér-Rao bound of this noise at the least split
    np.testing.assert_allclose(found.fit.frequency_hz[order], f, atol=0.1 * split * F)
    np.testing.assert_allclose(found.fit.damping_ratio[order], ZETA, rtol=0.08)


def test_one_mode_stays_one() -> None:
    y, noise = decay(np.array([F]), SHAPES[:1], 0)
    found = modes_of_decay(y, RATE_HZ, F, noise)
    assert found is not None
    np.testing.assert_allclose(found.fit.frequency_hz, [F], rtol=1e-3)


def test_a_close_pair_is_two_modes_beside_others() -> None:
    """Other modes explain more of what one pole leaves than its neighbour does, as on unlike legs."""
    t = np.arange(2200) / RATE_HZ
    f, zeta = (
        np.array([0.3523, 0.3571, 1.7222, 1.197, 1.8422]),
        np.array([0.0235, 0.0203, 0.022, 0.0097, 0.022]),
    )
    shapes = np.array(
        [
            [1.0, -0.78, 0.32, -0.25],
            [0.5, 0.8, 0.16, 0.26],
            [0.02, 0.05, -0.1, -0.3],
            [0.05, 0.02, 0.3, 0.02],
            [0.02, 0.04, -0.3, 0.1],
        ]
    )
    poles = 2.0 * np.pi * f * (-zeta + 1j * np.sqrt(1.0 - zeta**2))
    y = (shapes.T @ np.exp(np.outer(poles, t))).real
    found = modes_of_decay(y + 1e-6 * np.random.default_rng(0).standard_normal(y.shape), RATE_HZ, 0.354, None)
    assert found is not None
    order = np.argsort(found.fit.frequency_hz)[:2]
    np.testing.assert_allclose(found.fit.frequency_hz[order], f[:2], rtol=1e-3)
    np.testing.assert_allclose(found.fit.damping_ratio[order], zeta[:2], rtol=0.02)
