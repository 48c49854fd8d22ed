"""Damping from the likelihoods of many records: closed forms, scatter, and a simulated mode."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.support.sightings import sightings

from jackettwin.identification import ModalEstimate, fuse, identify
from jackettwin.identification.many_records import joint_damping as joint
from jackettwin.identification.many_records.joint_damping import joint_damping, jointly
from jackettwin.identification.maximum_likelihood.line_likelihood import (
    LOG_ZETA,
    NOISE_WEIGHTS,
    likelihood_interval,
    over_noise,
)
from jackettwin.identification.synthetic import ModalSystem, simulate


def seen(log_zeta, std, *, likelihood=True):
    """Return sightings with normal likelihoods of ln ζ, or with estimates of that spread alone."""
    covariance = np.diag([1e-6, std**2])
    modes = [
        ModalEstimate(0.3, float(np.exp(x)), np.ones(3, complex), 1.0, 0.0, 1.0, log_covariance=covariance)
        for x in log_zeta
    ]
    out = sightings(modes, [600.0] * len(modes))
    if not likelihood:
        return out
    one = -0.5 * ((LOG_ZETA - np.asarray(log_zeta)[:, None]) / std) ** 2
    return replace(out, damping_log_likelihood=np.repeat(one[:, None], len(NOISE_WEIGHTS), axis=1))


def test_equal_normal_likelihoods_give_the_mean_and_the_root_n_interval():
    joint = joint_damping(seen([-5.1, -4.9, -5.0, -5.0], 0.4))
    # a seventh of its standard deviation, as a scatter that is not excluded moves the mean of ζ up
    assert np.log(joint.damping_ratio) == pytest.approx(-5.0, abs=0.03)
    # σ/√n, and a tenth for a scatter that is not excluded, whose estimate is 0: a fifth if there must be one
    assert joint.log_std == pytest.approx(0.2, rel=0.1)
    assert joint.scatter == 0.0


def test_a_scatter_that_four_records_have_by_chance_is_no_higher_mean():
    """χ² of 4.1 with three degrees of freedom; at its likeliest scatter the mean would be 0.17 higher."""
    joint = joint_damping(seen([-6.0, -4.0, -5.0, -5.0], 0.7))
    assert np.log(joint.damping_ratio) == pytest.approx(-5.0, abs=0.14)


def test_scatter_between_records_widens_the_interval_and_is_told(rng):
    true = rng.normal(-5.0, 0.6, 60)
    joint = joint_damping(seen(true + rng.normal(0.0, 0.3, 60), 0.3))
    assert joint.scatter == pytest.approx(0.6, abs=0.2)
    # √((τ² + σ²)/n), and the mean of ζ, not of ln ζ: half a variance higher
    assert joint.log_std == pytest.approx(np.sqrt((0.36 + 0.09) / 60), rel=0.4)
    assert np.log(joint.damping_ratio) == pytest.approx(-5.0 + 0.18, abs=0.3)


def test_the_nodes_left_out_of_many_records_that_scatter_change_nothing(rng, monkeypatch):
    """300 records: interpolated over a step to what was left out, the mean was twice the true one."""
    true = rng.normal(-5.0, 0.6, 300)
    many = seen(true + rng.normal(0.0, 0.3, 300), 0.3)
    windowed = joint_damping(many)
    monkeypatch.setattr(joint, "MANY_RECORDS", 10**9)
    whole = joint_damping(many)
    # what the nodes left out have of the likelihood, which is nothing
    assert windowed.damping_ratio == pytest.approx(whole.damping_ratio, rel=1e-3)
    assert windowed.interval_90 == pytest.approx(whole.interval_90, rel=1e-3)
    # five standard errors √((τ² + σ²)/n) of the mean of ζ
    assert np.log(windowed.damping_ratio) == pytest.approx(-5.0 + 0.18, abs=0.2)


@pytest.mark.parametrize("true_range", [0, 3])
def test_many_records_show_the_noise_that_the_prior_does_not_know(true_range, rng):
    """Each record favours its range of noise by e^0.7; in the others it would have half the damping."""
    away = np.where(np.arange(len(NOISE_WEIGHTS)) == true_range, 0.0, -np.log(2.0))
    means = -5.0 + rng.normal(0.0, 0.4, 200)[:, None] + away
    each = -0.5 * ((LOG_ZETA - means[:, :, None]) / 0.4) ** 2 + np.where(away == 0.0, 0.0, -0.7)[:, None]
    joint = jointly(each)
    # τ² of the first scatter, not excluded, moves the mean by half a node at most; three standard errors
    assert np.log(joint.damping_ratio) == pytest.approx(-5.0, abs=3.0 * 0.4 / np.sqrt(200) + 0.02)
    assert joint.interval_90[0] < np.exp(-5.0) < joint.interval_90[1] * 1.05
    by_prior = likelihood_interval(np.sum([over_noise(one) for one in each], axis=0))
    assert by_prior[2] < -5.1
    # few records are not trusted to show it
    few = jointly(each[:3])
    assert few.log_std > 0.2


def test_estimates_alone_are_averaged_as_before():
    assert joint_damping(seen([-5.0, -5.2], 0.3, likelihood=False)) is None


def test_pieces_of_a_light_mode_are_fused_without_bias():
    """ζfT = 0.35: estimates one by one are 1.6 to 2 times the truth, and so was their mean."""
    shapes = np.array([[1.0, 0.7, 0.3], [0.6, -0.8, 0.9]])
    ratio = 0.35 / (0.3 * 600.0)
    system = ModalSystem(np.array([0.3, 1.1]), np.array([ratio, 0.01]), shapes, np.eye(2))
    found = [identify(simulate(system, np.random.default_rng([3, k]), sample_rate_hz=6.0)) for k in range(8)]
    mode = min(fuse(found).modes, key=lambda m: abs(m.frequency_hz - 0.3))
    low, high = mode.damping_ratio_interval_90
    assert low < ratio < high
    assert abs(np.log(mode.damping_ratio / ratio)) < 3.0 * mode.damping_ratio_std / mode.damping_ratio
    # eight records tell it to about 1/√(8 · 2πζfT) = 0.24
    assert mode.damping_ratio_std / mode.damping_ratio < 0.5
