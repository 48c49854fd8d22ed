"""Faults planted in a record of known modes: whatever is called ok is one of them, and none is lost.

``qualify/screening.py`` does the same over random systems and three strengths.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.identification.synthetic import ModalSystem, simulate

RATE, DURATION_S = 10.0, 600.0
HALF = [0, 1, 2]
SYSTEM = ModalSystem(
    np.array([0.3, 0.47, 1.1, 2.3]),
    np.array([0.01, 0.02, 0.015, 0.01]),
    np.random.default_rng(12).standard_normal((4, 6)),
    np.diag([1.0, 1.5, 3.0, 6.0]),
)
T = np.arange(int(RATE * DURATION_S)) / RATE
WANDERING = 2.0 * np.pi * np.cumsum(1.1 * (1.0 + 0.02 * np.sin(2.0 * np.pi * T / 400.0))) / RATE
"""Phase of a tone around the third mode that drifts by ±2 %."""


def read_late(y: np.ndarray, delay_s: np.ndarray) -> np.ndarray:
    y = y.copy()
    y[HALF] = [np.interp(T - delay_s, T, row) for row in y[HALF]]
    return y


def lost_seconds(y: np.ndarray) -> np.ndarray:
    short = np.delete(y, np.s_[2_500:2_670], axis=1)
    return np.vstack([short[HALF], y[3:, :-170]])


def rms(y: np.ndarray) -> np.ndarray:
    return y.std(axis=1, keepdims=True)


FIRST = np.arange(6)[:, None] < 1
UPPER = np.arange(6)[:, None] < 3
PLANTED: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "nothing": lambda y: y,
    "half read late": lambda y: read_late(y, np.full(T.shape, 0.2)),
    "half late from the middle on": lambda y: read_late(y, 0.2 * (T > 300.0)),
    "a slow clock": lambda y: read_late(y, 450e-6 * T),
    "seconds lost": lost_seconds,
    "stored backwards": lambda y: np.where(FIRST, y[:, ::-1], y),
    "a gain that grows": lambda y: y * np.where(FIRST, np.linspace(1.0, 4.0, y.shape[1]), 1.0),
    "half turned": lambda y: y * np.where(UPPER & (T > 350.0), -1.0, 1.0),
    "zeros that step": lambda y: y + 5.0 * rms(y) * (T > 200.0),
    "a tone that drifts through a mode": lambda y: y + 0.5 * rms(y) * np.sin(WANDERING),
    "a steady tone": lambda y: y + 0.7 * rms(y) * np.sin(2.0 * np.pi * 0.8 * T),
    "not stationary": lambda y: y * np.where(T > 300.0, 10.0, 1.0),
}


@pytest.mark.parametrize("fault", PLANTED)
def test_nothing_planted_is_ok_and_no_mode_is_lost(fault: str) -> None:
    record = simulate(SYSTEM, np.random.default_rng(3), duration_s=DURATION_S, sample_rate_hz=RATE)
    faulty = replace(record, data=PLANTED[fault](record.data))
    modes = examine(faulty, IdentificationSettings(refine=False)).identification.modes
    fine = [mode.frequency_hz for mode in modes if mode.status == "ok"]
    # four of the largest standard deviations, 0.5 % of f in ten minutes
    assert all(np.min(np.abs(np.log(f / SYSTEM.frequency_hz))) < 0.02 for f in fine)
    assert len(fine) <= len(SYSTEM.frequency_hz)
    for f in SYSTEM.frequency_hz:
        assert min(abs(mode.frequency_hz / f - 1.0) for mode in modes) < 0.03
