"""The information of a record of known modes, against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification.synthetic import ModalSystem, cramer_rao, simulate

ONE = ModalSystem(np.array([1.0]), np.array([0.01]), np.array([[1.0, 0.5]]), np.eye(1), 1e-3)


def bound(system, duration_s=3000.0):
    return cramer_rao(system, duration_s=duration_s, sample_rate_hz=10.0, band_hz=(0.3, 3.0))


def test_one_mode_without_noise_is_known_to_aus_limits():
    """CoV(ζ) = 1/√(2πζfT), CoV(f) = √(ζ/2πfT) for a wide band around a light mode (Au 2014)."""
    f, zeta = bound(ONE)
    # unknown force level and exponent cost some per cent of ζ
    assert zeta[0] == pytest.approx(1.0 / np.sqrt(2.0 * np.pi * 0.01 * 3000.0), rel=0.06)
    assert f[0] == pytest.approx(np.sqrt(0.01 / (2.0 * np.pi * 3000.0)), rel=0.06)


def test_noise_takes_information_away_and_length_adds_it():
    noisy = bound(replace(ONE, noise_ratio=2.0))[1][0]
    plain = bound(ONE)[1][0]
    assert noisy > 1.05 * plain
    assert bound(ONE, 12000.0)[1][0] == pytest.approx(0.5 * plain, rel=0.02)


def test_noise_has_the_ratio_asked_for(rng):
    system = replace(ONE, noise_ratio=0.5)
    loud = simulate(system, np.random.default_rng(4), duration_s=3000.0, sample_rate_hz=10.0).data
    still = simulate(ONE, np.random.default_rng(4), duration_s=3000.0, sample_rate_hz=10.0).data
    assert np.std(loud - still, axis=1) / np.std(still, axis=1) == pytest.approx(0.5, rel=0.05)
