"""A refined mode is the mode it started from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.maximum_likelihood.band_fit import BandFit
from jackettwin.identification.maximum_likelihood.fits import FitStart, accepted_fits
from jackettwin.identification.maximum_likelihood.mode_drift import drifted, frequency_left, long_data_limits
from jackettwin.identification.synthetic import ModalSystem, simulate

T = 600.0


def refined(frequency_hz: float, damping_ratio: float, log_std: float) -> BandFit:
    return BandFit(
        candidate=np.array([0]),
        frequency_hz=np.array([frequency_hz]),
        damping_ratio=np.array([damping_ratio]),
        shapes=np.ones((1, 2)),
        covariance=np.diag([1e-3, log_std])[None] ** 2,
        shape_covariance=np.eye(2)[None],
        cramer_rao=np.ones((1, 2)),
        gain=np.array([np.inf]),
        lack_of_fit=1.0,
        converged=True,
    )


@pytest.mark.parametrize(
    ("frequency_hz", "damping_ratio", "log_std", "expected"),
    [
        (0.281, 0.011, 0.35, False),
        (0.281, 0.0003, 0.5, True),  # ln ζ 3.5 below, 3 · 0.5 allowed
        (0.281, 0.004, 0.2, True),  # at ζ = 0.4 % nobody knows ln ζ better than 0.48
        (0.300, 0.010, 0.35, True),  # seven half bandwidths
        (0.281, 0.160, 1.50, True),  # more damped than a mode
    ],
)
def test_what_a_refined_mode_may_not_do(frequency_hz, damping_ratio, log_std, expected):
    verdict = drifted(
        refined(frequency_hz, damping_ratio, log_std),
        frequency_hz=np.array([0.28]),
        damping_ratio=np.array([0.01]),
        log_damping_std=np.array([0.5]),
        duration_s=T,
        max_damping_ratio=0.15,
    )
    assert verdict.tolist() == [expected]


def test_a_start_more_certain_than_a_record_allows_counts_as_the_limit():
    limit = float(long_data_limits(0.28, 0.01, T)[1])
    moved = 0.01 * np.exp(2.9 * limit)
    given = {"frequency_hz": np.array([0.28]), "damping_ratio": np.array([0.01]), "duration_s": T}
    fit = refined(0.28, moved, limit)
    assert not drifted(fit, log_damping_std=np.array([1e-3]), max_damping_ratio=0.15, **given).any()


def test_frequency_may_move_by_half_bandwidths_and_never_less_than_the_record_blurs():
    assert frequency_left(np.array([0.309]), np.array([0.3]), np.array([0.01]), T).tolist() == [False]
    assert frequency_left(np.array([0.310]), np.array([0.3]), np.array([0.01]), T).tolist() == [True]
    # ζ = 1e-5: the half bandwidth is far below one line, √(ζ/(2πfT)) = 9.4e-5 above it
    assert frequency_left(np.array([0.30005]), np.array([0.3]), np.array([1e-5]), T).tolist() == [False]


def pair_in_waves(seed: int):
    """Return a record of a pair 1.8 % apart in wind, and in waves that push both directions as one."""
    rng = np.random.default_rng(seed)
    first, second = np.array([1.0, 0.42, 0.2]), np.array([-0.35, 1.0, 0.55])
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    shapes = np.array([np.kron(first, x), np.kron(first, y), np.kron(second, x), np.kron(second, y)])
    f, zeta = np.array([0.28, 0.285, 1.4, 1.5]), np.array([0.008, 0.04, 0.012, 0.02])
    wind = ModalSystem(f, zeta, shapes, np.diag([1.0, 3.0, 0.3, 0.3]))
    push = np.array([0.87, 0.5, 0.05, 0.05])
    one_force = 0.01 * (np.outer(push, push) + 1e-9 * np.eye(4))
    waves = ModalSystem(f, zeta, shapes, one_force, force_slope=5.0)
    record, more = (simulate(s, rng, duration_s=T, sample_rate_hz=5.0) for s in (wind, waves))
    return replace(record, data=record.data + more.data)


@pytest.mark.parametrize("seed", [0, 2])
def test_a_close_pair_keeps_its_damping_in_waves(seed):
    """Without a background the lighter mode shrinks to a line, ζ 0.03 to 0.05 %, to stand for the waves."""
    modes = identify(pair_in_waves(seed), IdentificationSettings(lowest_frequency_hz=0.18)).modes
    assert len(modes) == 4
    for mode, f, zeta in zip(modes, [0.28, 0.285, 1.4, 1.5], [0.008, 0.04, 0.012, 0.02], strict=True):
        assert mode.method == "maximum likelihood"
        # three standard deviations, of eight intervals
        assert abs(np.log(mode.damping_ratio / zeta)) < 3.0 * np.sqrt(mode.log_covariance[1, 1])
        assert abs(np.log(mode.frequency_hz / f)) < 3.0 * np.sqrt(mode.log_covariance[0, 0])


def test_a_mode_whose_start_is_nowhere_near_is_left_unrefined(tower, rng):
    y = simulate(tower, rng, sample_rate_hz=5.0).data
    start = FitStart(
        frequency_hz=tower.frequency_hz,
        # the second pair started as if it were forty times lighter than the spectrum has it
        damping_ratio=tower.damping_ratio / np.array([1.0, 1.0, 40.0, 40.0]),
        log_damping_std=np.full(4, 0.1),
        shapes=tower.mode_shapes,
        sure=np.ones(4, dtype=bool),
        derivatives=[0] * 8,
        avoid_hz=(),
        max_damping_ratio=0.15,
    )
    fits, findings = accepted_fits(y / y.std(axis=1, keepdims=True), 5.0, (0.2, 1.6), start)
    assert [np.flatnonzero(fit.candidates).tolist() for fit in fits] == [[0, 1]]
    assert [finding.code for finding in findings] == ["not_refined"]
    assert "1.2, 1.26 Hz are not refined: the fit left the peak at 1.2" in findings[0].text
