"""A rotor stops: its orders sweep down through the modes while the thrust's release rings out."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from jackettwin.identification import identify
from jackettwin.records import Channel, Record

RATE_HZ, STOP_S, RATED_HZ = 25.0, 30.0, 0.19
MODES = {"fore-aft": (0.294, 0.0026), "side-side": (0.293, 0.0024), "second": (1.7, 0.01)}


def moved(force: np.ndarray, frequency_hz: float, damping_ratio: float) -> np.ndarray:
    """Return the acceleration of one mode."""
    omega = 2.0 * np.pi * frequency_hz
    poles = [1.0, 2.0 * damping_ratio * omega, omega**2]
    numerator, denominator, _ = signal.cont2discrete(([1.0, 0.0, 0.0], poles), 1.0 / RATE_HZ)
    return np.asarray(signal.lfilter(numerator.ravel(), denominator, force))


def stopped(seed: int, spin_down_s: float, orders: float) -> Record:
    """Return ten minutes of a nacelle: 1P and 3P fall to zero with the square of the speed as their size."""
    rng = np.random.default_rng(seed)
    n = int(600.0 * RATE_HZ)
    t = np.arange(n) / RATE_HZ
    speed = np.clip(1.0 - (t - STOP_S) / spin_down_s, 0.0, 1.0)
    phase = 2.0 * np.pi * np.cumsum(RATED_HZ * speed) / RATE_HZ
    blades = orders * speed**2 * np.sin(3.0 * phase)
    thrust = (t < STOP_S).astype(float)
    fore = moved(
        0.15 * rng.normal(size=n) + 3.0 * thrust + blades + 0.5 * orders * speed**2 * np.sin(phase),
        *MODES["fore-aft"],
    )
    side = moved(0.1 * rng.normal(size=n) + 0.5 * thrust + blades, *MODES["side-side"])
    second = moved(0.3 * rng.normal(size=n) + 2.0 * thrust, *MODES["second"])
    y = np.array([fore + 0.5 * second, side])
    y += 0.002 * y.std() * rng.normal(size=y.shape)
    channels = (
        Channel("FA", quantity="acceleration", direction=(1.0, 0.0, 0.0)),
        Channel("SS", quantity="acceleration", direction=(0.0, 1.0, 0.0)),
    )
    return Record(y, RATE_HZ, channels)


@pytest.mark.parametrize("spin_down_s", [20.0, 60.0, 120.0])
@pytest.mark.parametrize("orders", [0.3, 1.0])
def test_orders_that_sweep_down_are_no_modes(spin_down_s: float, orders: float) -> None:
    """3P begins at 0.57 Hz and passes the first pair; what is ok is a mode, and its intervals hold."""
    told = [m for m in identify(stopped(2, spin_down_s, orders)).modes if m.status == "ok"]
    for mode in told:
        near = [(f, z) for f, z in MODES.values() if abs(mode.frequency_hz / f - 1.0) < 0.01]
        assert near
        std_f, std_z = np.sqrt(np.diag(mode.log_covariance)) if mode.log_covariance is not None else (0, 0)
        # four standard deviations, of either mode of the pair
        assert any(abs(np.log(mode.frequency_hz / f)) < 4.0 * std_f for f, _ in near)
        assert any(abs(np.log(mode.damping_ratio / z)) < 4.0 * std_z for _, z in near)
