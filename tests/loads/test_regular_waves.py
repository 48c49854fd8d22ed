"""Stokes and stream-function waves through raschii (an optional extra)."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.regular_waves import THEORIES, regular_wave
from jackettwin.loads.waves import airy_wave

raschii = pytest.importorskip("raschii")
G = 9.80665


@pytest.mark.parametrize("theory", THEORIES)
def test_small_waves_are_airy_waves(theory: str) -> None:
    points = np.array([[4.0, 0.0, -3.0], [20.0, 5.0, -30.0]])
    steep = regular_wave(theory, height=0.02, period=8.0, depth=50.0, direction=0.3)
    linear = airy_wave(height=0.02, period=8.0, depth=50.0, direction=0.3)
    assert steep.k == pytest.approx(float(linear.k[0]), rel=1e-5)
    for ours, theirs in zip(steep.motion(points, np.array([1.0])), linear.motion(points, 1.0), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=5e-3, atol=1e-5)  # second order in steepness


def test_stream_function_meets_bernoulli_and_kinematics_at_the_surface() -> None:
    """In the moving frame: (u−c, w) runs along the surface and g η + ½|·|² is constant there."""
    wave = regular_wave("stream-function", height=12.0, period=11.0, depth=40.0, order=20)
    c = wave.omega / wave.k
    x = np.linspace(0.0, 2.0 * np.pi / wave.k, 41)
    flat = np.stack([x, 0 * x, 0 * x], axis=1)
    eta = wave.elevation(flat, np.zeros(1))[0]
    assert eta.max() - eta.min() == pytest.approx(12.0, rel=1e-6)
    surface = np.stack([x, 0 * x, eta], axis=1)
    u = wave.motion(surface, np.zeros(1))[0][0]
    head = G * eta + 0.5 * ((u[:, 0] - c) ** 2 + u[:, 2] ** 2)
    np.testing.assert_allclose(head, head.mean(), rtol=1e-4)  # 20 harmonics of a steep wave
    h = 1e-3
    slope = (wave.elevation(flat + [h, 0, 0], np.zeros(1)) - wave.elevation(flat - [h, 0, 0], np.zeros(1)))[0]
    np.testing.assert_allclose(u[:, 2], (u[:, 0] - c) * slope / (2 * h), atol=2e-3 * np.abs(u).max())


@pytest.mark.parametrize("theory", THEORIES)
def test_velocity_is_raschiis_and_acceleration_its_total_derivative(theory: str) -> None:
    wave = regular_wave(theory, height=10.0, period=12.0, depth=40.0)
    model, n = (raschii.StokesWave, 5) if theory == "stokes-5" else (raschii.FentonWave, 12)
    theirs = model(height=10.0, depth=40.0, period=12.0, N=n, g=G)
    p = np.array([[10.0, 0.0, -5.0], [-30.0, 0.0, -20.0], [70.0, 0.0, -8.0]])
    u, a = (field[0] for field in wave.motion(p, np.zeros(1)))
    np.testing.assert_allclose(u[:, [0, 2]], theirs.velocity(p[:, 0], p[:, 2] + 40.0), rtol=1e-9)
    h = 1e-4
    follow = (wave.motion(p + h * u, np.array([h]))[0] - wave.motion(p - h * u, np.array([-h]))[0])[0] / (
        2 * h
    )
    np.testing.assert_allclose(a, follow, atol=1e-5)


def test_breaking_waves_and_unknown_theories_are_refused() -> None:
    with pytest.raises(InputError, match="breaks"):
        regular_wave("stokes-5", height=40.0, period=12.0, depth=40.0)
    with pytest.raises(InputError, match="stokes-5, stream-function"):
        regular_wave("cnoidal", height=4.0, period=12.0, depth=40.0)
