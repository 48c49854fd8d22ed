"""Pairs whose directions turn within a record, and forces that only seem to turn them."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import ModalEstimate
from jackettwin.identification.selection.turning import turning_doubted
from jackettwin.identification.status import ModeStatus

RATE_HZ, HALF = 5.0, 1500


def mode(frequency_hz: float) -> ModalEstimate:
    return ModalEstimate(frequency_hz, 0.02, np.ones(4, complex), 1.0, 0.0, 1.0)


def oscillator(frequency_hz: float, damping_ratio: float, force: np.ndarray) -> np.ndarray:
    """Return the displacement of a single mass under impulses at the samples, by its impulse response."""
    t = np.arange(4 * HALF) / RATE_HZ
    omega = 2.0 * np.pi * frequency_hz
    response = np.exp(-damping_ratio * omega * t) * np.sin(omega * np.sqrt(1.0 - damping_ratio**2) * t)
    spectrum = np.fft.rfft(response, 8 * HALF) * np.fft.rfft(force, 8 * HALF)
    return np.fft.irfft(spectrum)[2 * HALF : 4 * HALF]


@pytest.mark.parametrize(
    ("turn_deg", "factor", "told"),
    [(90.0, 1.0, True), (-90.0, 4.0, True), (0.0, 1.0, False), (0.0, 4.0, False)],
)
def test_a_pair_that_turns_is_doubted_and_forces_that_change_are_not(
    turn_deg: float, factor: float, told: bool
) -> None:
    """Ten minutes of two levels in x and y; forces along one mode grow by a factor as the other's fall."""
    flagged = []
    for seed in range(8):
        rng = np.random.default_rng([seed, 8])
        level = np.ones((2, 4 * HALF))
        level[0, 3 * HALF :], level[1, : 3 * HALF] = factor, factor
        force = level * rng.standard_normal((2, 4 * HALF))
        fore_aft, side_side = oscillator(0.3, 0.01, force[0]), oscillator(0.315, 0.03, force[1])
        yaw = np.radians(turn_deg) * (np.arange(2 * HALF) >= HALF)
        x, y = (
            np.cos(yaw) * fore_aft - np.sin(yaw) * side_side,
            np.sin(yaw) * fore_aft + np.cos(yaw) * side_side,
        )
        data = np.array([x, y, 0.5 * x, 0.5 * y])
        data += 0.03 * data.std(axis=1, keepdims=True) * rng.standard_normal(data.shape)
        out = turning_doubted([mode(0.3), mode(0.315), mode(1.2)], data, RATE_HZ)
        assert out[2].status is ModeStatus.OK
        flagged.append([m.status is ModeStatus.DOUBTFUL for m in out[:2]])
    # 93 % of pairs that turn are found, and all of the others must not be
    assert np.sum(flagged) >= 12 if told else not np.any(flagged)
