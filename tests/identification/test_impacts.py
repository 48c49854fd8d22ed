"""Blows of a hammer at 2 kHz and 512 Hz, one or several in a record, tell all modes."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import identify
from jackettwin.records import Channel, Record

FRAME = (np.array([30.0, 55.0, 110.0, 180.0, 320.0]), np.array([0.010, 0.008, 0.012, 0.006, 0.010]))
TOWER = (np.array([4.1, 4.6, 12.0, 19.0]), np.array([0.010, 0.012, 0.010, 0.020]))


def struck(
    modes: tuple[np.ndarray, np.ndarray], rate_hz: float, duration_s: float, blows_s: list[float]
) -> Record:
    """Return four accelerations of a structure that is struck at these times, with 1 % noise."""
    rng = np.random.default_rng(len(blows_s))
    t = np.arange(int(duration_s * rate_hz)) / rate_hz
    shapes = rng.normal(size=(len(modes[0]), 4))
    y = np.zeros((4, len(t)))
    for blow in blows_s:
        after = np.maximum(t - blow, 0.0)
        for f, zeta, shape in zip(*modes, shapes, strict=True):
            omega = 2.0 * np.pi * f
            decay = np.exp(-zeta * omega * after) * np.sin(omega * np.sqrt(1.0 - zeta**2) * after)
            y += np.outer(shape, rng.normal() * omega * decay)
    y += 0.01 * y.std() * rng.normal(size=y.shape)
    return Record(y, rate_hz, tuple(Channel(f"a{i}", quantity="acceleration") for i in range(4)))


@pytest.mark.parametrize(
    ("modes", "rate_hz", "duration_s", "blows_s"),
    [
        (FRAME, 2000.0, 4.0, [0.5]),
        (FRAME, 2000.0, 60.0, [2.0, 9.0, 16.0, 25.0, 33.0, 40.0, 48.0, 55.0]),
        (TOWER, 512.0, 120.0, [3.0, 25.0, 50.0, 77.0, 100.0]),
    ],
    ids=["one blow", "eight blows", "five blows, close modes"],
)
def test_modes_of_blows(
    modes: tuple[np.ndarray, np.ndarray], rate_hz: float, duration_s: float, blows_s: list[float]
) -> None:
    found = identify(struck(modes, rate_hz, duration_s, blows_s)).modes
    assert [m.status.value for m in found] == ["ok"] * len(modes[0])
    for mode, f, zeta in zip(found, *modes, strict=True):
        assert mode.frequency_hz == pytest.approx(f, rel=2e-3)
        low, high = mode.damping_ratio_interval_90 or (0.0, 0.0)
        assert low / 1.1 < zeta < 1.1 * high
    one = len(blows_s) == 1
    assert all((m.method == "decay") == one for m in found)
