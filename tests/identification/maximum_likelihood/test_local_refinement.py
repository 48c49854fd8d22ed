"""NarrowBand bands: groups of neighbours, a background for the modes outside, an honest sharpness."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from calibration import are_standard

from jackettwin.identification import identify
from jackettwin.identification.maximum_likelihood import likelihood
from jackettwin.identification.maximum_likelihood.background import with_background
from jackettwin.identification.maximum_likelihood.local_refinement import groups, refine_group
from jackettwin.identification.maximum_likelihood.modal_spectrum import kernel, poles
from jackettwin.identification.maximum_likelihood.parameters import Parameters, coherent_pairs
from jackettwin.identification.maximum_likelihood.periodogram import Periodogram, group_starts, periodogram
from jackettwin.identification.maximum_likelihood.spectral_model import expected, log_distance
from jackettwin.identification.synthetic import ModalSystem, simulate

RATE = 5.0


def test_neighbours_go_together_and_bands_meet_halfway():
    f = np.array([0.18, 0.19, 0.25, 0.7, 0.75, 1.2])
    sure = np.array([True, True, False, True, True, True])
    found = groups(f, sure, (0.1, 2.0))
    assert [list(np.flatnonzero(g.members)) for g in found] == [[0, 1, 2], [3, 4], [5]]
    assert found[0].band_hz == pytest.approx((0.18 / 1.35, 0.19 * 1.35))
    # 0.75 · 1.35 is beyond the middle (on a logarithmic axis) of 0.75 and 1.2
    assert found[1].band_hz[1] == found[2].band_hz[0] == pytest.approx(np.sqrt(0.75 * 1.2))


def test_the_reach_stays_inside_the_band():
    (only,) = groups(np.array([0.2]), np.array([True]), (0.18, 0.22))
    assert only.band_hz == (0.18, 0.22)


def test_a_background_follows_its_force(tower, rng):
    """Its expected periodogram is that of the force: 1 at all lines, also together with itself."""
    y = simulate(tower, rng, sample_rate_hz=RATE).data
    modes = (tower.frequency_hz[:2], tower.damping_ratio[:2])
    data = periodogram(y, RATE, (0.21, 0.4), modes=modes, derivatives=[0] * 8)
    p = with_background(data, likelihood.start(data, *modes, tower.mode_shapes[:2]))
    assert p.background == 2
    lam = poles(np.exp(p.log_f[:2]), np.exp(p.log_zeta[:2]))
    # (RELATIVE_FREQUENCY)² and a leakage of the same order
    np.testing.assert_allclose(
        sum(kernel(data.omega, data.variance, data.duration_s, lam, lam)), 1.0, atol=5e-3
    )


def test_a_background_leaks_nothing(tower, rng):
    """Its force, extended as a power to far below the band, is that of no process: it has no peak to leak."""
    y = simulate(tower, rng, sample_rate_hz=RATE).data
    modes = (tower.frequency_hz[:2], tower.damping_ratio[:2])
    data = periodogram(y, RATE, (0.21, 0.4), modes=modes, derivatives=[0] * 8)
    p = with_background(data, likelihood.start(data, *modes, tower.mode_shapes[:2]))
    steep = replace(p, colour=np.array([3.0, -2.0, 1.0, 1.0]))
    of_background = expected(data, steep).coloured[:, [0, 1], [0, 1]].real
    power = np.exp(-np.array([3.0, -2.0]) * log_distance(data, steep)[:, :2])
    # 1 to (RELATIVE_FREQUENCY)²; with its leak, 0.1 to 20 instead of 1
    np.testing.assert_allclose(of_background / power, 1.0, atol=2e-3)


def test_forces_that_fall_with_frequency_leave_the_pair_where_it_is(tower, rng):
    """Spectra that are exactly the model's, exponents of 2: the fit finds the pair and its damping.

    The peaks alone hardly tell the exponents; drawn to white forces, they put the wide peak 0.2 % lower.
    """
    y = simulate(tower, rng, sample_rate_hz=RATE).data
    f, zeta = tower.frequency_hz[:2], tower.damping_ratio[:2]
    data = periodogram(y, RATE, (0.21, 0.4), modes=(f, zeta), derivatives=[0] * 8)
    true = replace(
        likelihood.start(data, f, zeta, tower.mode_shapes[:2]), colour=np.full(2, 2.0), exponent=2.0
    )
    matrix = expected(data, true, share=0.0).matrix
    floor = np.broadcast_to(np.median(np.einsum("kaa->ka", matrix).real, axis=0), data.floor.shape)
    exact = replace(data, density=matrix, floor=floor, dither=3.0 * floor)
    start = likelihood.start(exact, f, zeta, tower.mode_shapes[:2])
    assert start.exponent == 2.0
    found = likelihood.maximise(exact, start).parameters
    # the prior of the noise keeps a little: 5e-5 and 2 % in one of two records
    np.testing.assert_allclose(np.exp(found.log_f), f, rtol=2e-4)
    np.testing.assert_allclose(np.exp(found.log_zeta), zeta, rtol=0.03)


def third_pair():
    """Return a tower whose shapes lag, and exact spectra about its third pair, in tails of the second."""
    f = np.array([0.176, 0.178, 0.762, 0.787, 1.264, 1.39])
    zeta = np.array([0.038, 0.011, 0.049, 0.037, 0.043, 0.025])
    x, y, lag = np.array([1.0, 0.0]), np.array([0.0, 1.0]), 0.04 - 0.03j
    heights = [1.0, 0.45, 0.2, 0.1], [-0.3, 0.6, 0.8, 0.6], [0.2, -0.5, 0.4, 0.7]
    directions = (y + lag * x, x + lag * y)
    shapes = np.array([np.kron(h, direction) for h in heights for direction in directions])
    shapes *= np.repeat([3.0, 1.0, 0.2], 2)[:, None]
    lines = np.arange(588, 1126) / 600.0
    start = group_starts(lines, 600.0, f[4:], zeta[4:])
    count = np.diff(np.append(start, len(lines))).astype(float)
    omega, none = 2.0 * np.pi * np.add.reduceat(lines, start) / count, np.zeros((len(start), 8))
    blank = Periodogram(omega, count, np.zeros((len(start), 8, 8), complex), none, none, 600.0, 600.0)
    pairs = coherent_pairs(np.log(f))
    moved = shapes[pairs[:, 0]] * shapes[pairs[:, 1]].conj()
    size = np.linalg.norm(shapes, axis=1)
    coherence = 0.9 * moved.sum(axis=1) / size[pairs[:, 0]] / size[pairs[:, 1]]
    noise = np.array([[-9.0], [0.0]]) * np.ones(8)
    true = Parameters(
        np.log(f), np.log(zeta), np.full(6, 2.0), shapes.real, coherence, noise, pairs, lag=shapes.imag
    )
    matrix = expected(blank, true).matrix
    floor = np.broadcast_to(np.median(np.einsum("kaa->ka", matrix).real, axis=0), none.shape)
    return true, replace(blank, density=matrix, floor=floor, dither=3.0 * floor)


def test_modes_beside_the_band_take_part_as_they_are():
    """Tails of a strong pair are no power of frequency: as a background alone they move ζ, and fit worse."""
    true, data = third_pair()
    error, value = {}, {}
    for beside in ([2, 3], []):
        modes = [*beside, 4, 5]
        f, zeta = np.exp(true.log_f[modes]), np.exp(true.log_zeta[modes])
        first = likelihood.start(data, f, zeta, true.shapes[modes], len(beside))
        first = with_background(data, replace(first, lag=np.zeros((2, 8))))
        optimum = likelihood.maximise(data, first)
        found, value[len(beside)] = optimum.parameters, optimum.value
        error[len(beside)] = (
            np.abs(found.log_f[found.n_fixed :] - true.log_f[4:]).max(),
            np.abs(found.log_zeta[found.n_fixed :] - true.log_zeta[4:]).max(),
        )
        np.testing.assert_allclose(np.exp(found.log_f[2 : found.n_fixed]), f[: len(beside)], rtol=1e-6)
    # what is left is of the first pair, and of the dither, whose share of E is not of the model
    assert error[2][0] < 1e-3
    assert error[2][1] < 0.02
    assert error[0][1] > 1.5 * error[2][1]
    # Kass & Raftery 1995: a difference of three is strong evidence
    assert value[2] > value[0] + 5.0


def single_force(rng):
    """Ten minutes of a tower whose modes all share one force of bent spectrum in either direction."""
    f = np.array([0.30, 0.31, 1.2, 1.26, 2.1])
    zeta = np.array([0.030, 0.010, 0.020, 0.012, 0.02])
    x, y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    first, second, third = [1.0, 0.45, 0.2, 0.1], [-0.3, 0.6, 0.8, 0.6], [0.2, -0.5, 0.4, 0.7]
    shapes = np.array(
        [np.kron(first, y), np.kron(first, x), np.kron(second, y), np.kron(second, x), np.kron(third, x)]
    )
    at_top = shapes[:, :2]
    system = ModalSystem(f, zeta, shapes, at_top @ at_top.T + 1e-6 * np.eye(5), 0.005)
    record = simulate(system, rng, sample_rate_hz=RATE)
    lines = np.fft.rfft(record.data, axis=1)
    at = np.fft.rfftfreq(record.data.shape[1], 1.0 / RATE)
    curvature = 1.0 / np.sqrt((1.0 + (at / 0.6) ** 2) ** 2 + 1e-3)
    return system, np.fft.irfft(lines * curvature, record.data.shape[1], axis=1)


def one_force_without_noise(seed):
    """Ten minutes of four modes in six sensors, all moved by one white force."""
    shapes = np.random.default_rng(9).standard_normal((4, 6))
    drive = np.random.default_rng(seed).standard_normal(4)
    f, zeta = np.array([0.31, 0.62, 1.3, 2.2]), np.array([0.012, 0.01, 0.02, 0.015])
    system = ModalSystem(f, zeta, shapes, np.outer(drive, drive) + 1e-9 * np.eye(4), 0.0)
    return system, simulate(system, np.random.default_rng([5, seed]), sample_rate_hz=7.0)


def test_records_without_noise_are_refined():
    """As one's own simulation gives them: two records, three modes of four refined, intervals that hold."""
    refined, inside = 0, 0
    for seed in range(2):
        system, record = one_force_without_noise(seed)
        modes = identify(record).modes
        for f, zeta in zip(system.frequency_hz, system.damping_ratio, strict=True):
            mode = min(modes, key=lambda m: abs(m.frequency_hz - f))
            refined += mode.unrefined is not None
            inside += mode.damping_ratio_interval_90[0] < zeta < mode.damping_ratio_interval_90[1]
    assert refined >= 6
    # of eight: fewer than five have a probability of 0.5 % if each holds with 90 %
    assert inside >= 5


def test_damping_under_one_bent_force_is_as_sharp_as_the_record_allows_and_no_sharper():
    """Five records of two pairs, judged from both sides.

    Without background and with little added power the ratios of the channels would claim a third of the
    limit.
    """
    scores, sharpness = [], []
    for seed in range(5):
        system, y = single_force(np.random.default_rng([11, seed]))
        y = y / y.std(axis=1, keepdims=True)
        start = {
            "frequency_hz": system.frequency_hz,
            "damping_ratio": system.damping_ratio,
            "shapes": system.mode_shapes / np.abs(y).std(axis=1),
            "sure": np.ones(5, dtype=bool),
            "derivatives": [0] * 8,
        }
        for group in groups(system.frequency_hz, start["sure"], (0.2, 2.3))[:2]:
            fit = refine_group(y, RATE, group, **start)
            zeta = system.damping_ratio[fit.candidate]
            std = np.sqrt(fit.covariance[:, 1, 1])
            scores += list(np.log(fit.damping_ratio / zeta) / std)
            sharpness += list(std * np.sqrt(2.0 * np.pi * zeta * fit.frequency_hz * 600.0))
    assert len(sharpness) == 20
    assert are_standard(np.array(scores))
    assert 0.8 < np.median(sharpness) < 1.6


def test_a_single_channel_has_nothing_to_lag_behind(tower, rng):
    """Its modes are fitted in narrow bands as well, shapes of one number, and stay where they are."""
    y = simulate(tower, rng, sample_rate_hz=RATE).data[1:2]
    f, zeta = tower.frequency_hz[[0, 2]], tower.damping_ratio[[0, 2]]
    (low, _) = groups(f, np.array([True, True]), (0.2, 2.0))
    fit = refine_group(
        y / y.std(),
        RATE,
        low,
        frequency_hz=f,
        damping_ratio=zeta,
        shapes=np.ones((2, 1)),
        sure=np.array([True, True]),
        derivatives=[0],
    )
    assert fit.converged
    assert fit.shapes.shape == (1, 1)
    assert abs(np.log(fit.frequency_hz[0] / f[0])) < 3.0 * np.sqrt(fit.covariance[0, 0, 0])
