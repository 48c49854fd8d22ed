"""Forces that come in gusts widen the interval of the damping, steady ones do not."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import ModalEstimate
from jackettwin.identification.selection.gusts import concentration, less_information, widened

F_HZ, ZETA, DURATION_S = 2.0, 0.02, 600.0


def motion(power: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return lines of a mode's envelope and their frequencies, under forces of a power that changes."""
    n = len(power)
    rng = np.random.default_rng([seed, 12])
    force = np.sqrt(power) * (rng.standard_normal(n) + 1j * rng.standard_normal(n))
    lines = np.fft.fftshift(np.fft.fft(force))
    hz = F_HZ + (np.arange(n) - n // 2) / DURATION_S
    return lines / (1j * (hz - F_HZ) + ZETA * F_HZ), hz


@pytest.mark.parametrize(("share", "expected"), [(1.0, 1.0), (0.5, 2.0), (0.25, 4.0)])
def test_forces_in_a_share_of_the_record_tell_as_much_as_a_record_of_that_share(
    share: float, expected: float
) -> None:
    power = (np.arange(1200) < 1200 * share).astype(float)
    found = [concentration(*motion(power, seed), F_HZ, ZETA, DURATION_S) for seed in range(20)]
    # 2 s of memory at either end of the gust are smoothed over, 3 % of a quarter; 20 seeds of 5 % scatter
    assert np.mean(found) == pytest.approx(expected, rel=0.05)


def test_gusts_shorter_than_the_memory_of_the_mode_are_none() -> None:
    power = 1.0 + 0.99 * np.sign(np.sin(2.0 * np.pi * 40.0 * np.arange(1200) / 1200.0))
    found = [concentration(*motion(power, seed), F_HZ, 0.0005, DURATION_S) for seed in range(20)]
    assert np.mean(found) == pytest.approx(1.0, abs=0.05)


def test_only_the_variance_of_a_likelihoods_damping_is_multiplied() -> None:
    covariance = np.array([[1e-6, 1e-5], [1e-5, 0.04]])
    mode = ModalEstimate(F_HZ, ZETA, np.ones(2, complex), 1.0, 0.0, 1.0).with_covariance(covariance)
    assert widened(mode, 4.0) is mode
    likely = ModalEstimate(
        F_HZ, ZETA, np.ones(2, complex), 1.0, 0.0, 1.0, method="maximum likelihood"
    ).with_covariance(covariance)
    wider = widened(likely, 4.0)
    assert wider.damping_ratio_std == pytest.approx(2.0 * likely.damping_ratio_std)
    assert wider.frequency_interval_90 == pytest.approx(likely.frequency_interval_90)
    assert widened(likely, 1.0) is likely


def test_steady_forces_widen_nothing(rng: np.random.Generator) -> None:
    mode = ModalEstimate(F_HZ, ZETA, np.ones(2, complex), 1.0, 0.0, 1.0, log_covariance=np.eye(2))
    t = np.arange(6000) / 10.0
    response = np.exp(-2.0 * np.pi * F_HZ * ZETA * t) * np.sin(2.0 * np.pi * F_HZ * t)
    for calm, gusty in ((1.0, False), (0.1, True)):
        level = np.where((t > 200.0) & (t < 300.0), 1.0, calm)
        force = np.fft.rfft(level * rng.standard_normal(6000), 12_000)
        y = np.fft.irfft(np.fft.rfft(response, 12_000) * force)[:6000]
        times = less_information([mode], np.array([y, 0.5 * y]), 10.0, np.ones(2))
        assert (times[0] > 1.0) == gusty
