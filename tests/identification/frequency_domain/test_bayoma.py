"""BAYOMA: most probable values near the truth, and posterior deviations as large as the scatter."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from jackettwin.identification import IdentificationSettings, identify
from jackettwin.identification.frequency_domain.band_posterior import (
    BandPosterior,
    band_posterior,
    one_mode_cost,
    several_modes_cost,
    transfer,
)
from jackettwin.identification.mode_shapes import mac
from jackettwin.identification.record_steps import moving_channels
from jackettwin.identification.synthetic import ModalSystem, cramer_rao, simulate
from jackettwin.records import read_record

RATE_HZ, DURATION_S, BAND_HZ = 8.0, 600.0, (0.42, 0.58)
ONE = ModalSystem(
    np.array([0.5]), np.array([0.01]), np.array([[1.0, 0.5, -0.3]]), np.array([[1.0]]), noise_ratio=0.1
)
PAIR = ModalSystem(
    np.array([0.48, 0.52]),
    np.array([0.01, 0.015]),
    np.array([[1.0, 0.5, -0.3, 0.2], [-0.4, 1.0, 0.2, 0.6]]),
    np.array([[1.0, 0.2], [0.2, 0.8]]),
    noise_ratio=0.1,
)


def posterior(
    system: ModalSystem, seed: int, starts_hz: list[float]
) -> tuple[BandPosterior | None, np.ndarray]:
    record = simulate(system, np.random.default_rng(seed), duration_s=DURATION_S, sample_rate_hz=RATE_HZ)
    scale = record.data.std(axis=1)
    lines = np.fft.rfft(record.data / scale[:, None], axis=1)
    f = np.arange(lines.shape[1]) / DURATION_S
    at = (f >= BAND_HZ[0]) & (f <= BAND_HZ[1])
    return band_posterior(lines[:, at], f[at], starts_hz), scale


def within_chance(z: np.ndarray) -> bool:
    """Tell whether the mean square of standardised errors is that of deviations of one, two-sided.

    Limits of 1 in 1000; the mean is that of a maximum of a likelihood, biased by a part of its deviation.
    """
    low, high = stats.chi2.ppf([0.0005, 0.9995], len(z) - 1) / (len(z) - 1)
    return bool(low < np.var(z, ddof=1) < high)


def test_posterior_deviations_are_the_scatter_over_records() -> None:
    z, ratio = [], []
    for seed in range(100):
        found, scale = posterior(ONE, seed, [0.5])
        assert found is not None
        assert len(found.frequency_hz) == 1
        std = np.sqrt(np.diag(found.log_covariance[0]))
        ratio.append(std)
        shape, true = found.shapes[:, 0], ONE.mode_shapes[0] / scale
        true = true / np.linalg.norm(true)
        error = shape * np.sign(shape @ true) - true
        logs = np.log([found.frequency_hz[0] / 0.5, found.damping_ratio[0] / 0.01])
        z.append([*(logs / std), *(error / found.shape_std[:, 0])])
    for column in np.array(z).T:
        assert within_chance(column)
    assert np.all(np.abs(np.mean(z, axis=0)) < 0.8)
    # no method is more certain than the likelihood allows; the mode takes no part in the noise's slope here
    bound = np.ravel(cramer_rao(ONE, duration_s=DURATION_S, sample_rate_hz=RATE_HZ, band_hz=BAND_HZ))
    np.testing.assert_allclose(np.median(ratio, axis=0), bound, rtol=0.2)


def test_of_a_pair_both_modes_are_found_with_their_deviations() -> None:
    z, alike = [], []
    for seed in range(12):
        found, scale = posterior(PAIR, seed, [0.48])
        if found is None or len(found.frequency_hz) != 2:
            continue
        order = np.argsort(found.frequency_hz)
        std = np.sqrt(np.einsum("mii->mi", found.log_covariance))[order]
        logs = np.log(
            np.stack(
                [
                    found.frequency_hz[order] / PAIR.frequency_hz,
                    found.damping_ratio[order] / PAIR.damping_ratio,
                ]
            )
        ).T
        z.append((logs / std).ravel())
        alike.append(np.diag(mac(found.shapes.T[order], PAIR.mode_shapes / scale)))
    for column in np.array(z).T:
        assert within_chance(column)
    # of twelve records one may tell one mode only: the search is for a local maximum
    assert len(z) >= 11
    assert np.median(alike) > 0.98


def test_the_likelihood_of_several_is_that_of_one() -> None:
    """With one mode both costs are the same function: the determinant and the eigenvector say the same."""
    rng = np.random.default_rng(1)
    f = np.linspace(0.4, 0.6, 60)
    lines = rng.standard_normal((1, 60)) + 1j * rng.standard_normal((1, 60))
    theta = np.log([0.5, 0.02, 0.3, 0.5])
    outer = np.real(np.einsum("ak,bk->kab", lines, lines.conj()))
    several = np.array([theta[0], theta[1], 0.5 * theta[2], theta[3], 1.0])
    alone, _ = one_mode_cost(theta, outer, f)
    # the power that counts as rounding moves the logarithm of the determinant by as much
    assert several_modes_cost(several, lines, f, 0.0, 1)[0] == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("n_modes", [1, 3])
def test_slopes_of_the_cost_are_differences(n_modes: int) -> None:
    rng, f = np.random.default_rng(n_modes), np.linspace(0.4, 0.6, 40)
    lines = rng.standard_normal((3, 40)) + 1j * rng.standard_normal((3, 40))
    outer = np.real(np.einsum("ak,bk->kab", lines, lines.conj()))
    poles = [*np.log(rng.uniform(0.45, 0.55, n_modes)), *np.log(rng.uniform(0.01, 0.05, n_modes))]

    def cost(theta: np.ndarray) -> tuple[float, np.ndarray]:
        if n_modes == 1:
            return one_mode_cost(theta, outer, f)
        return several_modes_cost(theta, lines, f, 7.0, 5)

    theta = np.array([*poles, *rng.normal(0.0, 0.5, 2 if n_modes == 1 else 2 * n_modes**2 + 1)])
    steps = 1e-5 * np.eye(len(theta))
    differences = [(cost(theta + e)[0] - cost(theta - e)[0]) / 2e-5 for e in steps]
    # rounding of a cost of some hundreds over the step, and the step's square
    np.testing.assert_allclose(cost(theta)[1], differences, rtol=1e-5, atol=1e-5)


def test_the_transfer_function_at_resonance() -> None:
    h = transfer(np.array([0.5]), np.array([0.5]), np.array([0.02]))[0, 0]
    assert abs(h) == pytest.approx(1.0 / (2.0 * 0.02))


def test_as_a_method_it_states_intervals(tower: ModalSystem, rng: np.random.Generator) -> None:
    record = simulate(tower, rng, duration_s=1200.0, sample_rate_hz=10.0)
    found = identify(record, IdentificationSettings(method="bayoma"))
    assert all(mode.method == "bayoma" and mode.damping_ratio_interval_90 for mode in found.modes)
    for f in (1.20, 1.26):
        near = min(found.modes, key=lambda mode: abs(mode.frequency_hz - f))
        assert abs(np.log(near.frequency_hz / f)) < 4.0 * near.frequency_std_hz / f


@pytest.mark.parametrize(
    ("name", "pair_hz"), [("pile_U12_s308", (0.1743, 0.1788)), ("pile_U12_s301", (0.1734, 0.1778))]
)
def test_the_first_pair_of_a_record_without_noise_is_found(name: str, pair_hz: tuple[float, float]) -> None:
    """One shape leaves the other direction unexplained, 10⁴ times the noise: the search has to get there.

    In the second record the broad side-side mode has no peak, and the narrow one beside it alone no width.
    Frequencies of the pair as the subspace method with its refinement finds them.
    """
    record = moving_channels(read_record(Path(str(files("jackettwin"))) / f"data/records/{name}.parquet"))
    settings = IdentificationSettings(method="bayoma", lowest_frequency_hz=0.11, highest_frequency_hz=0.5)
    found = identify(record, settings).modes
    assert len(found) == 2
    for mode, f in zip(found, pair_hz, strict=True):
        low, high = mode.frequency_interval_90 or (0.0, 0.0)
        assert low < f < high
        assert high / low < 1.1


def test_shapes_and_their_deviations_are_in_the_units_of_the_record(
    tower: ModalSystem, rng: np.random.Generator
) -> None:
    """A channel in a tenth of its unit has ten times the entry, and ten times its deviation."""
    record = simulate(tower, rng, duration_s=1200.0, sample_rate_hz=10.0)
    small = np.ones(len(record.channels))
    small[-1] = 0.1
    settings = IdentificationSettings(method="bayoma")
    plain, scaled = (
        identify(replace(record, data=record.data * units[:, None]), settings).modes[0]
        for units in (np.ones_like(small), small)
    )
    relative = [mode.mode_shape_std / np.abs(mode.mode_shape) for mode in (plain, scaled)]
    np.testing.assert_allclose(relative[1], relative[0], rtol=1e-3)
