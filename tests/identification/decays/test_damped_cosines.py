"""Damped cosines in noise: the Cramér–Rao bound, and intervals that hold the truth."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from calibration import is_calibrated
from numpy.testing import assert_allclose
from scipy import signal

from jackettwin.identification.decays.damped_cosines import (
    DampedCosines,
    _jacobian,
    _products,
    _project,
    damped_cosines,
)
from jackettwin.identification.mode_shapes import mac

RATE, F, ZETA, SIGMA = 10.0, 0.3, 0.02, 0.05
SHAPE = np.array([1.0, 0.5, -0.3])
T = np.arange(3000) / RATE


def decay(f: float = F, zeta: float = ZETA, phase: float = 0.4) -> npt.NDArray[np.float64]:
    omega = 2.0 * np.pi * f
    return np.asarray(np.exp(-zeta * omega * T) * np.cos(omega * np.sqrt(1.0 - zeta**2) * T + phase))


def fitted(noise: npt.NDArray[np.float64]) -> DampedCosines:
    return damped_cosines(np.outer(SHAPE, decay()) + noise, RATE, np.array([0.31]), np.array([0.03]))


def test_without_noise_it_is_exact() -> None:
    fit = fitted(np.zeros((3, 3000)))
    assert_allclose([fit.frequency_hz[0], fit.damping_ratio[0]], [F, ZETA], rtol=1e-6)
    assert mac(fit.amplitudes[0], SHAPE.astype(complex)) > 1.0 - 1e-9


def test_two_modes_and_a_constant() -> None:
    y = np.outer(SHAPE, decay()) + np.outer([0.2, -1.0, 0.4], decay(0.33, 0.01, 1.0)) + 3.0
    fit = damped_cosines(y, RATE, np.array([0.305, 0.325]), np.array([0.03, 0.03]))
    assert_allclose(fit.frequency_hz, [F, 0.33], rtol=1e-6)
    assert_allclose(fit.damping_ratio, [ZETA, 0.01], rtol=1e-5)


def test_products_are_those_of_the_slopes() -> None:
    """Steps rest on products formed without the slopes themselves; the score's variance on the slopes."""
    rng, t = np.random.default_rng(7), T[:400]
    y = rng.standard_normal((4, 400))
    p = np.log([2.0 * np.pi * 0.3, 2.0 * np.pi * 0.7, 0.02, 0.05])
    value, slope, second = _products(_project(y, t, p))
    flat = _jacobian(_project(y, t, p)).reshape(4, -1)
    assert_allclose(second, flat @ flat.T, rtol=1e-9)
    step = 1e-6 * np.eye(4)
    ahead, behind = ([_products(_project(y, t, p + side * d))[0] for d in step] for side in (1.0, -1.0))
    assert value > 0.0
    assert_allclose(slope, np.subtract(ahead, behind) / 2e-6, rtol=1e-5)


def test_intervals_hold_the_truth_and_the_bound_is_that_of_yao_and_pandit() -> None:
    """Var α = var ω = 16 α³ σ² Δt / A² for a mode that dies within the record (Yao & Pandit 1995)."""
    scores, claimed = [], []
    for seed in range(200):
        fit = fitted(SIGMA * np.random.default_rng(seed).standard_normal((3, 3000)))
        std = np.sqrt(np.diag(fit.log_covariance))
        off = np.log([fit.frequency_hz[0] / F, fit.damping_ratio[0] / ZETA])
        scores.append(off / std)
        claimed.append(np.sqrt(np.diag(fit.cramer_rao)))
    inside = np.mean(np.abs(scores) < 1.96, axis=0)
    assert all(is_calibrated(round(200 * share), 200) for share in inside)
    alpha = 2.0 * np.pi * F * ZETA
    closed = np.sqrt(16.0 * alpha**3 * SIGMA**2 / RATE / np.sum(SHAPE**2))
    relative = np.array([closed / (2.0 * np.pi * F), closed / alpha])
    # the constant that is fitted beside, and ζ that is not small, are worth a per cent
    assert_allclose(np.mean(claimed, axis=0), relative, rtol=0.02)
    # what is claimed is what is scattered: ± 15 % is three standard deviations for 200
    assert_allclose(np.std(scores, axis=0), 1.0, atol=0.15)


def test_noise_that_is_strongest_at_the_mode_widens_the_interval() -> None:
    rng = np.random.default_rng(3)
    pole = 0.995 * np.exp(2j * np.pi * F / RATE)
    b, a = [1.0], np.real(np.poly([pole, pole.conjugate()]))
    narrow = signal.lfilter(b, a, rng.standard_normal((3, 9000)), axis=1)
    narrow *= SIGMA / narrow.std()
    y = np.outer(SHAPE, decay()) + narrow[:, :3000]
    fit = damped_cosines(y, RATE, np.array([0.3]), np.array([0.02]), noise=narrow[:, 3000:])
    ratio = np.sqrt(np.diag(fit.log_covariance) / np.diag(fit.cramer_rao))
    assert np.all(ratio > 3.0)


@pytest.mark.parametrize("after", [500, 3000])
def test_intervals_hold_the_truth_where_wind_goes_on(after: int) -> None:
    """Wind moves the mode that decays: some lines of noise tell how much, few of a short rest."""
    pole = np.exp(2.0 * np.pi * F / RATE * (-ZETA + 1j))
    b, a = [1.0], np.real(np.poly([pole, pole.conjugate()]))
    scores = []
    for seed in range(150):
        forces = np.random.default_rng(seed).standard_normal(3500 + after)
        wind = signal.lfilter(b, a, forces)[500:]
        both = np.outer(SHAPE, 0.05 * wind / wind.std())
        y = np.outer(SHAPE, decay()) + both[:, :3000]
        fit = damped_cosines(y, RATE, np.array([0.3]), np.array([0.02]), noise=both[:, 3000:])
        off = np.log([fit.frequency_hz[0] / F, fit.damping_ratio[0] / ZETA])
        scores.append(off / np.sqrt(np.diag(fit.log_covariance)))
    inside = np.mean(np.abs(scores) < 1.96, axis=0)
    assert all(is_calibrated(round(150 * share), 150) for share in inside), inside


@pytest.mark.parametrize("seed", range(3))
def test_a_record_of_forces_is_not_explained(seed: int) -> None:
    pole = 0.98 * np.exp(2j * np.pi * F / RATE)
    forces = np.random.default_rng(seed).standard_normal((1, 3000))
    y = signal.lfilter([1.0], np.real(np.poly([pole, pole.conjugate()])), forces)
    fit = damped_cosines(np.asarray(y), RATE, np.array([F]), np.array([0.02]))
    assert fit.explained < 0.5
