"""Derivatives against finite differences; the fit against the information limit of Au 2014."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from calibration import are_standard, is_calibrated

from jackettwin.identification.maximum_likelihood import accuracy, likelihood
from jackettwin.identification.maximum_likelihood.admission import likelihood_gain, required_gain
from jackettwin.identification.maximum_likelihood.background import with_background
from jackettwin.identification.maximum_likelihood.periodogram import periodogram
from jackettwin.identification.maximum_likelihood.prior import prior_of
from jackettwin.identification.maximum_likelihood.refinement import refine
from jackettwin.identification.maximum_likelihood.spectral_model import expected, linear_curvature
from jackettwin.identification.synthetic import ModalSystem, simulate

RATE, BAND = 5.0, (0.15, 2.0)


def of(system, rng, **options):
    y = simulate(system, rng, sample_rate_hz=RATE, **options).data
    return y / y.std(axis=1, keepdims=True), system.mode_shapes / y.std(axis=1)


def rough(system, y):
    modes = (system.frequency_hz, system.damping_ratio)
    return periodogram(y, RATE, BAND, modes=modes, derivatives=[0] * len(y))


def refined(system, y, shapes, sure):
    return refine(
        y,
        RATE,
        BAND,
        frequency_hz=system.frequency_hz,
        damping_ratio=system.damping_ratio,
        shapes=shapes,
        sure=np.asarray(sure),
        derivatives=[0] * len(y),
    )


@pytest.fixture
def fitted(tower, rng):
    y, shapes = of(tower, rng)
    data = rough(tower, y)
    p = likelihood.start(data, tower.frequency_hz, tower.damping_ratio, shapes)
    # somewhere off the start, coherences and colours at work
    return data, p.moved(0.03 * rng.standard_normal(len(p.vector)))


@pytest.fixture
def fitted_narrow(tower, rng):
    """The first pair with the third mode beside its band, shapes that lag, and a background."""
    y, shapes = of(tower, rng)
    f, zeta = tower.frequency_hz[[2, 0, 1]], tower.damping_ratio[[2, 0, 1]]
    data = periodogram(y, RATE, (0.21, 0.4), modes=(f[1:], zeta[1:]), derivatives=[0] * 8, dither_share=0.3)
    beside = likelihood.start(data, f, zeta, shapes[[2, 0, 1]], 1)
    p = with_background(data, replace(beside, lag=np.zeros((2, 8))))
    step = 0.03 * rng.standard_normal(len(p.vector))
    step[: p.n_fixed] = step[len(p.log_f) : len(p.log_f) + p.n_fixed] = 0.0
    return data, p.moved(step)


def central(function, p, k, step):
    h = np.zeros(len(p.vector))
    h[k] = step
    return (function(p.moved(h)) - function(p.moved(-h))) / (2.0 * step)


@pytest.mark.parametrize("kind", ["fitted", "fitted_narrow"])
def test_score_equals_finite_differences(kind, request):
    data, p = request.getfixturevalue(kind)
    prior = prior_of(data, p)
    score, _ = likelihood.scoring(data, prior, likelihood.evaluate(data, prior, p))
    for k in range(0, len(score), 7):
        slope = central(lambda q: likelihood.objective(data, prior, q), p, k, 1e-6)
        # differences of a value near 1e4 lose 1e-5; the kernel's own differences 1e-7 of the score
        assert score[k] == pytest.approx(slope, rel=1e-4, abs=1e-2)


def test_information_is_the_mean_curvature(fitted):
    """With the model itself as data, minus the slope of the score is the Fisher information."""
    data, p = fitted
    exact = replace(data, density=expected(data, p, 0.0).matrix)
    prior = prior_of(exact, p)
    _, fisher = likelihood.scoring(exact, prior, likelihood.evaluate(exact, prior, p))
    size = np.sqrt(np.diag(fisher))
    for k in range(0, len(size), 11):
        column = -central(
            lambda q: likelihood.scoring(exact, prior, likelihood.evaluate(exact, prior, q))[0], p, k, 1e-5
        )
        # the prior's own curvature is its Fisher information only at its centre: 1 of 10³ or more
        np.testing.assert_allclose(fisher[:, k] / size / size[k], column / size / size[k], atol=5e-3)


def test_claimed_scatter_is_near_the_long_data_law(tower, rng):
    y, shapes = of(tower, rng)
    found = refined(tower, y, shapes, [True] * 4)
    limit = 1.0 / np.sqrt(2.0 * np.pi * found.damping_ratio * found.frequency_hz * 600.0)
    ratio = np.sqrt(found.covariance[:, 1, 1]) / limit
    assert np.all((ratio > 0.8) & (ratio < 1.5))
    # no estimate is sharper than the bound of its model; the bound itself is taken at the estimate
    assert np.all(found.cramer_rao[:, 1] < 1.02 * np.sqrt(found.covariance[:, 1, 1]))
    assert found.lack_of_fit < 1.3


def test_estimates_scatter_as_they_claim():
    """A hundred and fifty records, one mode, ζfT = 6: not biased, and scattered as claimed."""
    system = ModalSystem(np.array([0.5]), np.array([0.02]), np.array([[1.0, 0.5, -0.3]]), np.eye(1), 0.05)
    z, ratio = [], []
    for seed in range(150):
        y, shapes = of(system, np.random.default_rng([3, seed]))
        found = refined(system, y, shapes, [True])
        ratio.append(found.damping_ratio[0] / 0.02)
        z.append(np.log(ratio[-1]) / np.sqrt(found.covariance[0, 1, 1]))
    assert abs(np.mean(ratio) - 1.0) < 3.5 * np.std(ratio) / np.sqrt(150)
    assert is_calibrated(int(np.sum(np.abs(z) < 1.96)), 150)
    assert are_standard(np.array(z))


def test_linear_bend_equals_second_differences(fitted, rng):
    data, p = fitted
    n = 3 * len(p.log_f)
    middle = expected(data, p)
    root = rng.standard_normal((len(p.vector) - n, 5)) * 1e-3
    curvature = linear_curvature(data, p, middle, root @ root.T)
    plain = np.zeros_like(curvature)
    for step in np.vstack([np.zeros((n, 5)), root]).T:
        plain += expected(data, p.moved(step)).matrix + expected(data, p.moved(-step)).matrix
        plain -= 2.0 * middle.matrix
    # rounding of E over the square of the step, and its fourth order in the noise
    np.testing.assert_allclose(curvature, plain, rtol=1e-3, atol=1e-5 * np.abs(curvature).max())


def test_curvature_biases_as_foretold():
    """Three hundred spectra of one light mode, ζfT = 3, drawn from the model itself.

    The linear part of each error is taken away, which has no mean: what is left is the bias of second order.
    """
    system = ModalSystem(np.array([0.5]), np.array([0.01]), np.array([[1.0, 0.5, -0.3]]), np.eye(1), 0.05)
    rng = np.random.default_rng(5)
    y, shapes = of(system, rng)
    data = rough(system, y)
    p = likelihood.maximise(data, likelihood.start(data, *at(system), shapes)).parameters
    p = replace(p, log_zeta=np.log(system.damping_ratio))
    data = replace(data, dither=np.full_like(data.dither, 1e-3 * data.floor.min()))
    prior = replace(prior_of(data, p), centre=p.vector)
    matrix = expected(data, p, 0.0).matrix
    root = np.linalg.cholesky(matrix)
    fisher = likelihood.scoring(data, prior, likelihood.evaluate(data, prior, p))[1]
    left = []
    for _ in range(300):
        drawn = replace(data, density=wishart(root, data.count, rng))
        linear = np.linalg.solve(
            fisher, likelihood.scoring(drawn, prior, likelihood.evaluate(drawn, prior, p))[0]
        )
        left.append((likelihood.maximise(drawn, p).parameters.vector - p.vector - linear)[:2])
    foretold = accuracy.curvature_bias(data, p, accuracy.accuracy_of(data, p))[:2]
    error = np.std(left, axis=0) / np.sqrt(len(left))
    assert foretold[1] > 10.0 * error[1] / 3.0
    # the next order is the bias times σ², 0.05; three standard errors
    assert abs(np.mean(left, axis=0)[1] - foretold[1]) < 3.0 * error[1] + 0.1 * foretold[1]


def at(system):
    return system.frequency_hz, system.damping_ratio


def wishart(root, count, rng):
    """Return means of so many outer products of complex Gaussian vectors of covariance root rootᴴ."""
    out = np.empty_like(root)
    for k, n in enumerate(count.astype(int)):
        x = root[k] @ (rng.standard_normal((root.shape[1], n, 2)) @ np.array([1.0, 1.0j])) / np.sqrt(2.0)
        out[k] = x @ x.conj().T / n
    return out


def test_a_mode_the_spectrum_needs_is_admitted_and_a_repeated_one_is_not(tower, rng):
    y, shapes = of(tower, rng)
    system = ModalSystem(
        np.append(tower.frequency_hz, [1.21, 0.6]),
        np.append(tower.damping_ratio, [0.015, 0.03]),
        np.vstack([tower.mode_shapes, tower.mode_shapes[2:3], tower.mode_shapes[:1]]),
        np.eye(6),
    )
    doubled = np.vstack([shapes, shapes[2:3], shapes[:1]])
    found = refined(system, y, doubled, [True, True, True, False, False, False])
    assert list(np.sort(found.candidate)) == [0, 1, 2, 3]


def test_gain_of_a_mode_already_there_is_small(fitted, tower):
    data, p = fitted
    p = likelihood.maximise(data, p).parameters
    gain, _ = likelihood_gain(data, p, float(np.exp(p.log_f[0])), float(np.exp(p.log_zeta[0])), p.shapes[0])
    assert gain < 0.1 * required_gain(data)


def test_exponent_of_coloured_forces_is_found(tower, rng):
    y, shapes = of(ModalSystem(**{**vars(tower), "force_slope": 2.0}), rng)
    data = rough(tower, y)
    p = likelihood.maximise(
        data, likelihood.start(data, tower.frequency_hz, tower.damping_ratio, shapes)
    ).parameters
    # exponents of the two lower modes are seen over most of the band
    np.testing.assert_allclose(p.colour[:2], 2.0, atol=0.4)


def test_a_hump_in_the_force_spectrum_is_a_lack_of_fit(tower, rng):
    """NarrowBand-band force at 0.75 Hz, as from a rotor of unsteady speed: not what the model says."""
    y, shapes = of(tower, rng)
    n = y.shape[1]
    f = np.fft.rfftfreq(n, 1.0 / RATE)
    lines = np.exp(-0.5 * ((f - 0.75) / 0.02) ** 2) * (rng.standard_normal((2, len(f))).T @ [1.0, 1j])
    hump = np.fft.irfft(lines, n)
    y = y + 0.5 * np.outer(shapes[2] / np.abs(shapes[2]).max(), hump / hump.std())
    found = refined(tower, y, shapes, [True] * 4)
    assert found.lack_of_fit > 1.4
