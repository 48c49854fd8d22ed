"""Stokes and stream-function waves through raschii (an optional extra)."""

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.loads.sea.regular_waves import THEORIES, regular_wave
from jackettwin.loads.sea.waves import airy_wave

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
    np.testing.assert_allclose(wave.pressure(surface, np.zeros(1))[0], G * eta, atol=2e-4 * head.mean())
    h = 1e-3
    slope = (wave.elevation(flat + [h, 0, 0], np.zeros(1)) - wave.elevation(flat - [h, 0, 0], np.zeros(1)))[0]
    np.testing.assert_allclose(u[:, 2], (u[:, 0] - c) * slope / (2 * h), atol=2e-3 * np.abs(u).max())


@pytest.mark.parametrize("theory", THEORIES)
def test_velocity_is_raschiis_and_acceleration_its_total_derivative_and_what_pressure_drives(
    theory: str,
) -> None:
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
    pushed = [(wave.pressure(p - h * e, 0.0) - wave.pressure(p + h * e, 0.0))[0] / (2 * h) for e in np.eye(3)]
    np.testing.assert_allclose(np.stack(pushed, axis=1), a, atol=1e-5)  # Euler: Du/Dt = −∇p/ρ


@pytest.mark.parametrize(("height", "period", "depth"), [(2.0, 12.0, 5.0), (20.0, 14.0, 50.0)])
def test_long_waves_have_harmonics_enough(height: float, period: float, depth: float) -> None:
    """H within 0.1 %, and water that neither vanishes nor spins."""
    wave = regular_wave("stream-function", height=height, period=period, depth=depth, direction=0.7)
    eta = wave.elevation(np.zeros((1, 3)), np.linspace(0.0, period, 801))
    assert eta.max() - eta.min() == pytest.approx(height, rel=1e-3)
    at, h = np.array([1.0, 2.0, -0.4 * depth]), 1e-3
    u = [
        (wave.motion(np.array([at + h * e]), 1.0)[0] - wave.motion(np.array([at - h * e]), 1.0)[0])[0, 0]
        for e in np.eye(3)
    ]
    gradient = np.array(u) / (2.0 * h)
    # central differences at 1 mm of fields of order 1
    assert abs(np.trace(gradient)) < 1e-6 * np.abs(gradient).max() + 1e-9
    np.testing.assert_allclose(gradient, gradient.T, atol=1e-6 * np.abs(gradient).max())


def test_stokes_is_the_stream_function_where_it_holds() -> None:
    """Two thirds of the breaking height at an Ursell number of 15: crest and velocity below it within 1 %."""
    waves = [regular_wave(theory, height=8.0, period=11.0, depth=25.0) for theory in THEORIES]
    below = np.array([[0.0, 0.0, -12.0]])
    crest, speed = (
        [float(w.elevation(below, np.zeros(1))[0, 0]) for w in waves],
        [w.motion(below, np.zeros(1))[0][0, 0, 0] for w in waves],
    )
    assert crest[0] == pytest.approx(crest[1], rel=0.01)
    assert speed[0] == pytest.approx(speed[1], rel=0.01)


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize(
    ("height", "period", "depth"),
    [(40.0, 12.0, 40.0), (12.0, 6.0, 40.0), (3.0, 3.0, 50.0), (8.5, 10.0, 10.0)],
)
def test_breaking_waves_are_refused(theory: str, height: float, period: float, depth: float) -> None:
    with pytest.raises(InputError, match="breaks"):
        regular_wave(theory, height=height, period=period, depth=depth)


@pytest.mark.parametrize(
    ("height", "period", "depth"), [(6.0, 15.0, 12.0), (2.0, 12.0, 5.0), (5.0, 20.0, 10.0)]
)
def test_stokes_is_refused_where_it_does_not_hold(height: float, period: float, depth: float) -> None:
    """There its own crests and troughs lie up to twice the asked height apart."""
    with pytest.raises(InputError, match="Ursell.*use the stream function"):
        regular_wave("stokes-5", height=height, period=period, depth=depth)


def test_unknown_theories_are_refused() -> None:
    with pytest.raises(InputError, match="stokes-5, stream-function"):
        regular_wave("cnoidal", height=4.0, period=12.0, depth=40.0)
