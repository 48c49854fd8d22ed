"""The posterior against quadrature and Laplace; it refuses what has not converged."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import logsumexp

from jackettwin.errors import InputError, NumericalError
from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import (
    Problem,
    Residuals,
    SupportModel,
    Target,
    Uncertainty,
    law_probability,
    single,
    support_model,
)
from jackettwin.updating.posterior.convergence import convergence
from jackettwin.updating.posterior.importance_sampling import weighted_draws
from jackettwin.updating.posterior.laplace import log_covariance
from jackettwin.updating.posterior.nested_sampling import sample_nested
from jackettwin.updating.posterior.smc import Posterior, _evaluate, _moved, gathered, sample_posterior
from jackettwin.updating.prior import BoxPrior

TRUTH = np.array([3e9, 0.15])
MODES = (1, 2, 4)


@pytest.fixture(scope="module")
def model(maxwell_3: Callable[..., SupportModel]) -> SupportModel:
    return maxwell_3(bounds={"k": (1e8, 1e11), "loss_factor": (1e-3, 0.6)})


def record_of(model: SupportModel, seconds: float) -> Residuals:
    """Return the truth's modes as one record gives them: Au's long-data law."""
    targets = []
    for mode, pole in zip(MODES, model.predict(TRUTH, MODES).poles, strict=True):
        f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
        f_std = f * np.sqrt(zeta / (2 * np.pi * f * seconds))
        targets.append(Target(mode, f, f_std, zeta, zeta / np.sqrt(2 * np.pi * zeta * f * seconds)))
    return Residuals(tuple(targets), relative=False)


@pytest.fixture(scope="module")
def posterior(model: SupportModel) -> Posterior:
    return sample_posterior(single(model, record_of(model, 600.0)), particles=200, islands=4)


def evidence_by_quadrature(problem: Problem, z: np.ndarray) -> float:
    """Return ln Z of two parameters on a grid over what draws z (n, 2) reach, between the bounds."""
    reach = 0.5 * np.ptp(z, axis=0)
    ends = (
        np.maximum(problem.prior.low, z.min(axis=0) - reach),
        np.minimum(problem.prior.high, z.max(axis=0) + reach),
    )
    n = 80
    cell = (ends[1] - ends[0]) / n
    axes = [low + step * (np.arange(n) + 0.5) for low, step in zip(ends[0], cell, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    log_l, _ = problem.log_likelihood(grid, problem.anchor(z.mean(axis=0)))
    return float(logsumexp(log_l + problem.prior.log_density(grid)) + np.log(cell).sum())


def test_log_evidence_is_that_of_quadrature(model: SupportModel, posterior: Posterior) -> None:
    exact = evidence_by_quadrature(single(model, record_of(model, 600.0)), posterior.log_theta)
    assert posterior.log_evidence == pytest.approx(exact, abs=0.1)
    # what is promised holds by a margin of several standard deviations
    assert posterior.log_evidence_std < 0.03


@pytest.mark.parametrize("data", ["frequencies", "a damping ratio"])
def test_log_evidence_of_valleys(model: SupportModel, data: str) -> None:
    """One runs along the loss factor to its bound, one bends from bound to bound."""
    targets = record_of(model, 600.0).targets
    if data == "frequencies":
        targets = tuple(Target(t.mode, t.frequency_hz, t.frequency_std_hz) for t in targets)
    else:
        first = targets[0]
        targets = (Target(1, damping_ratio=first.damping_ratio, damping_ratio_std=first.damping_ratio_std),)
    problem = single(model, Residuals(targets, relative=False))
    posterior = sample_posterior(problem, particles=150, seed=5)
    exact = evidence_by_quadrature(problem, posterior.log_theta)
    assert posterior.log_evidence == pytest.approx(exact, abs=0.1)
    assert posterior.log_evidence_std < 0.03


def test_more_records_are_weighted_draws_around_fewer(model: SupportModel, posterior: Posterior) -> None:
    """The posterior of 600 s from that of 450 s is the sampled one, from far away, too, in steps."""
    problem = single(model, record_of(model, 600.0))
    fewer = sample_posterior(single(model, record_of(model, 450.0)), particles=100, islands=2).log_theta
    rng = np.random.default_rng(4)
    exact, std = np.quantile(posterior.log_theta, [0.05, 0.5, 0.95], axis=0), posterior.log_theta.std(axis=0)
    for away in (0.0, 4.0):
        draws = weighted_draws(problem, fewer.mean(axis=0) + away * std, np.cov(fewer.T), rng)
        assert draws is not None
        # three standard deviations of quantiles of 300 draws, the ends having a quarter of the density
        assert np.abs((np.quantile(draws, [0.05, 0.5, 0.95], axis=0) - exact) / std).max() < 0.35


def test_two_hills_hold_their_shares(jacket15: Assembly) -> None:
    """A dashpot of the ground damps little where it yields and where it locks; the prior likes less."""
    model = support_model(
        jacket15,
        family=family("kelvin-voigt"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        highest_mode=1,
        bounds={"k": (5e8, 2e9), "c": (1e7, 1e11)},
        priors={"c": (3e8, 1.5)},
    )
    problem = single(model, Residuals((Target(1, 0.1815, 0.0015, 0.01, 0.0005),), relative=False))
    between = np.log(1e9)
    axes = [np.linspace(*ends, 100) for ends in zip(problem.prior.low, problem.prior.high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    log_l, _ = problem.log_likelihood(grid, problem.anchor(grid.mean(axis=0)))
    density = np.exp(log_l + problem.prior.log_density(grid) - log_l.max())
    locked = density[grid[:, 1] > between].sum() / density.sum()
    drawn = sample_posterior(problem, particles=150, islands=4, seed=3)
    # four standard deviations of a share told by so many effective draws
    within = 4.0 * np.sqrt(locked * (1.0 - locked) / drawn.convergence.ess_bulk.min())
    assert (drawn.log_theta[:, 1] > between).mean() == pytest.approx(locked, abs=within)
    assert 0.2 < locked < 0.4 and within < 0.1


@pytest.mark.parametrize("level", [0.68, 0.9])
def test_an_interval_holds_the_share_of_draws_that_it_says(posterior: Posterior, level: float) -> None:
    low, high = np.log(posterior.interval(level).T)
    inside = (posterior.log_theta > low) & (posterior.log_theta < high)
    # quantiles between draws: one draw of each side may fall either way
    np.testing.assert_allclose(inside.mean(axis=0), level, atol=2.0 / len(inside))


def test_an_update_gives_the_posterior_of_90_percent(posterior: Posterior) -> None:
    """An update's own draws, from the posterior or from Laplace, are cut at the same quantiles."""
    of_update = SimpleNamespace(log_theta=posterior.log_theta)
    interval = Uncertainty.interval_90.fget(of_update)
    np.testing.assert_allclose(interval, posterior.interval(0.9), rtol=1e-12)


def test_the_truth_lies_inside_the_intervals(posterior: Posterior) -> None:
    low, high = posterior.interval(0.9).T
    assert (low < TRUTH).all() and (high > TRUTH).all()
    assert (posterior.convergence.rhat < 1.05).all()
    assert posterior.convergence.ess_bulk.min() > 100.0


def test_nested_sampling_says_the_same(model: SupportModel, posterior: Posterior) -> None:
    """It shares nothing with the swarm but the likelihood."""
    pytest.importorskip("dynesty")
    nested = sample_nested(single(model, record_of(model, 600.0)), live=60)
    # dynesty's own ln Z has a standard deviation of √(H/live) ≈ 0.2 a run with H ≈ 4 nats
    assert nested.log_evidence == pytest.approx(posterior.log_evidence, abs=0.5)
    std = posterior.log_theta.std(axis=0)
    apart = (nested.log_theta.mean(axis=0) - posterior.log_theta.mean(axis=0)) / std
    assert np.abs(apart).max() < 0.3
    np.testing.assert_allclose(nested.log_theta.std(axis=0), std, rtol=0.25)


def test_with_much_data_it_is_the_laplace_approximation(model: SupportModel) -> None:
    problem = single(model, record_of(model, 1e5))
    posterior = sample_posterior(problem, particles=120, islands=3, seed=1)
    laplace = np.sqrt(np.diag(log_covariance(problem, TRUTH)))
    # some 500 effective draws know a standard deviation to 3 %; the posterior is not quite normal
    np.testing.assert_allclose(posterior.log_theta.std(axis=0), laplace, rtol=0.12)
    np.testing.assert_allclose(posterior.log_theta.mean(axis=0), np.log(TRUTH), atol=0.5 * laplace.max())


def test_the_same_seed_gives_the_same_draws(model: SupportModel) -> None:
    residuals = record_of(model, 600.0)
    first, second = (
        sample_posterior(single(model, residuals), particles=150, islands=2, seed=4) for _ in range(2)
    )
    np.testing.assert_array_equal(first.log_theta, second.log_theta)


@pytest.mark.parametrize("particles", [6, 12])
def test_too_few_particles_are_refused(jacket15: Assembly, particles: int) -> None:
    """A curved valley over seven decades, which six can neither fill nor make a covariance of."""
    model = support_model(
        jacket15, family=family("zener"), rayleigh=Rayleigh.minimum(0.0055, 0.1832), highest_mode=5
    )
    poles = model.predict(np.array([2.6e9, 8e8, 1e10]), (1, 2, 4)).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    targets = (Target(1, f[0], 3e-3 * f[0], zeta[0], 0.15 * zeta[0]), Target(2, f[1], 3e-3 * f[1]))
    problem = single(model, Residuals((*targets, Target(4, f[2], 5e-3 * f[2])), relative=False))
    with pytest.raises(NumericalError, match="did not converge"):
        sample_posterior(problem, particles=particles, islands=4, seed=1)


def test_islands_that_disagree_are_no_posterior(model: SupportModel, rng: np.random.Generator) -> None:
    problem = single(model, record_of(model, 600.0))
    z = rng.standard_normal((4, 200, 2))
    z[3] += 2.0
    with pytest.raises(NumericalError, match="did not converge"):
        gathered(problem, z=z, poles=z.astype(complex), log_l=z[..., 0], log_z=np.full(4, 9.0))


def test_draws_that_agree_are_a_posterior_even_if_their_evidence_is_not_known(
    model: SupportModel, rng: np.random.Generator
) -> None:
    problem = single(model, record_of(model, 600.0))
    z = rng.standard_normal((4, 200, 2))
    runs = {"z": z, "poles": z.astype(complex), "log_l": z[..., 0]}
    sharp = gathered(problem, **runs, log_z=np.array([9.0, 9.1, 9.2, 9.1]))
    blurred = gathered(problem, **runs, log_z=np.array([9.0, 10.0, 11.0, 10.0]))
    assert sharp.evidence_known and not blurred.evidence_known
    # four runs with a standard deviation of 0.82 between them
    assert blurred.log_evidence_std == pytest.approx(0.41, abs=0.01)
    fits = [SimpleNamespace(law=n, uncertainty=SimpleNamespace(posterior=sharp)) for n in ("one", "other")]
    assert law_probability(fits) == pytest.approx({"one": 0.5, "other": 0.5})
    fits[1].uncertainty.posterior = blurred
    assert law_probability(fits) is None
    with pytest.raises(NumericalError, match="no evidence"):
        gathered(problem, **runs, log_z=np.array([9.0, np.nan, 9.0, 9.0]))


def test_runs_that_sit_apart_or_stand_still_are_noticed(rng: np.random.Generator) -> None:
    good = rng.standard_normal((4, 100, 1))
    assert convergence(good).problem is None
    apart = good + np.array([0.0, 0.0, 0.0, 2.0])[:, None, None]
    assert convergence(apart).problem.startswith("R-hat")
    # four distinct values a run, equally spread in every run: they agree, but there are few of them
    still = np.repeat(good[:1, :5], 20, axis=1) + np.zeros((4, 1, 1))
    assert convergence(still).problem is not None


def test_where_the_data_say_nothing_the_sampler_keeps_the_prior() -> None:
    """A swarm drawn from a normal prior and moved a hundred times keeps its mean and spread."""
    prior = BoxPrior(np.full(2, -50.0), np.full(2, 50.0), np.array([1.0, -2.0]), np.array([0.5, 2.0]))

    class Silent:
        def log_likelihood(self, z: np.ndarray, near: object) -> tuple[np.ndarray, tuple[()]]:
            return np.zeros(len(z)), ()

    rng = np.random.default_rng(7)
    problem: Any = Silent()
    swarm = _evaluate(problem, prior, prior.draw(2000, rng), None)
    for _ in range(100):
        swarm = _moved(problem, prior, swarm, 1.0, rng, wide=False)
    # 2000 draws tell a mean to 0.022 and a standard deviation to 0.016 of it: four times that
    np.testing.assert_allclose((swarm.z.mean(axis=0) - prior.mean) / prior.scale, 0.0, atol=0.09)
    np.testing.assert_allclose(swarm.z.std(axis=0), prior.scale, rtol=0.065)


def test_without_standard_deviations_there_is_no_likelihood(model: SupportModel) -> None:
    with pytest.raises(InputError, match="no likelihood"):
        sample_posterior(single(model, Residuals((Target(1, 0.18),), relative=False)))
