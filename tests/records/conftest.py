from __future__ import annotations

from datetime import UTC, datetime
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from jackettwin.records import Channel, Record

HEIGHTS_M = (144.0, 77.0, 41.0, 28.0)
SHAPES = np.array([[1.0, 0.45, 0.2, 0.12], [-0.5, 1.0, 0.7, 0.45]])


def oscillator(force: np.ndarray, frequency_hz: float, damping_ratio: float, rate_hz: float) -> np.ndarray:
    """Return the acceleration of one mode under a force held over each step."""
    omega = 2 * np.pi * frequency_hz
    system = signal.StateSpace(
        [[0.0, 1.0], [-(omega**2), -2 * damping_ratio * omega]], [[0.0], [1.0]],
        [[-(omega**2), -2 * damping_ratio * omega]], [[1.0]],
    )  # fmt: skip
    discrete = system.to_discrete(1.0 / rate_hz).to_tf()
    return signal.lfilter(discrete.num.ravel(), discrete.den, force)


def tower_record(
    seed: int, *, rate_hz: float = 20.0, duration_s: float = 600.0, noise: float = 0.02
) -> Record:
    rng = np.random.default_rng(seed)
    n = int(rate_hz * duration_s)
    rows, channels = [], []
    for axis, frequencies in (("x", (0.178, 0.76)), ("y", (0.176, 0.74))):
        modal = [
            oscillator(rng.normal(size=2 * n), f, z, rate_hz)[n:]
            for f, z in zip(frequencies, (0.01, 0.02), strict=True)
        ]
        motion = SHAPES.T @ np.array(modal)
        motion += noise * motion.std(axis=1, keepdims=True) * rng.normal(size=motion.shape)
        for height, row in zip(HEIGHTS_M, motion, strict=True):
            rows.append(row)
            direction = (float(axis == "x"), float(axis == "y"), 0.0)
            channels.append(Channel(f"acc_{height:.0f}_{axis}", height_m=height, direction=direction))
    return Record(np.array(rows), rate_hz, tuple(channels), name=f"tower_{seed}")


@pytest.fixture
def tower() -> SimpleNamespace:
    """A tower of two modes in each direction under noise: what clean records look like."""
    return SimpleNamespace(record=tower_record, oscillator=oscillator, shapes=SHAPES)


@pytest.fixture
def record(rng: np.random.Generator) -> Record:
    """Three channels of two kinds with a hole, and everything a record can know."""
    data = rng.normal(size=(3, 400))
    data[1, 30:45] = np.nan
    channels = (
        Channel("acc_top_x", height_m=144.0, direction=(1.0, 0.0, 0.0)),
        Channel("acc_top_y", node="tower_top", direction=(0.0, 1.0, 0.0)),
        Channel("wind_hub_x", "wind speed", "m/s", height_m=149.6, direction=(1.0, 0.0, 0.0)),
    )
    return Record(
        data,
        12.5,
        channels,
        start_utc=datetime(2025, 1, 1, 13, tzinfo=UTC),
        conditions={"mean_wind_speed_m_s": 12.0, "yaw_deg": 30.0, "state": "parked"},
        metadata={
            "source": "a test",
            "turbine": {"row": 3},
            "channel_metadata": {"acc_top_x": {"sensor": "MEMS 7"}},
        },
        name="r",
    )
