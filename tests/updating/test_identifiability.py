"""Verdicts on a case whose answer is known from the physics: tower modes see the vertical springs."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.soil import family
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import Problem, Residuals, Target, single, support_model
from jackettwin.updating.posterior.identifiability import USABLE, Verdict, contradicted, identifiability
from jackettwin.updating.posterior.laplace import laplace_draws
from jackettwin.updating.posterior.predictive import predict_quantities, support_quantities
from jackettwin.updating.posterior.smc import sample_posterior
from jackettwin.updating.prior import BoxPrior
from jackettwin.updating.search.profile import profile

TRUTH = np.array([2.5e9, 1e8, 2.5e9, 1e8])  # k, c horizontal; k, c vertical
MODES = (1, 2, 4)


@pytest.fixture(scope="module")
def problem(jacket15: Assembly) -> Problem:
    """f1, f2, f4 and ζ1 of separate horizontal and vertical Kelvin–Voigt supports."""
    model = support_model(
        jacket15,
        family=family("kelvin-voigt"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        tie="horizontal-vertical",
        bounds={"k": (1e8, 1e11), "c": (1e6, 1e10)},
        highest_mode=5,
    )
    poles = model.predict(TRUTH, MODES).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    targets = (
        Target(1, f[0], 1e-3 * f[0], zeta[0], 0.15 * zeta[0]),
        Target(2, f[1], 1e-3 * f[1]),
        Target(4, f[2], 1e-3 * f[2]),
    )
    return single(model, Residuals(targets, relative=False))


@pytest.fixture(scope="module")
def draws(problem: Problem) -> np.ndarray:
    return sample_posterior(problem, particles=100, islands=3, seed=1).log_theta


@pytest.fixture(scope="module")
def verdicts(problem: Problem, draws: np.ndarray) -> dict[str, Verdict]:
    return {v.name: v for v in identifiability(problem, draws)}


def test_vertical_stiffness_is_identified_and_horizontal_damping_is_not(verdicts: dict[str, Verdict]) -> None:
    assert verdicts["k_vertical"].verdict == "identified"
    assert verdicts["k_vertical"].reason.startswith("fixed by f")
    assert verdicts["c_horizontal"].verdict == "unidentified"
    assert verdicts["c_horizontal"].ratio > verdicts["c_vertical"].ratio


def spread(problem: Problem, column: int, z: np.ndarray) -> Verdict:
    """Return the verdict on one parameter whose draws are these, the others a tenth about the truth."""
    rng = np.random.default_rng(2)
    draws = np.log(TRUTH) + 0.1 * rng.standard_normal((z.size, 4))
    draws[:, column] = z
    return identifiability(problem, draws)[column]


def test_what_the_data_contradict_is_not_identified(verdicts: dict[str, Verdict]) -> None:
    found = contradicted([*verdicts.values()], "one foot softer than the others")
    before = [v.verdict for v in verdicts.values()]
    assert "identified" in before
    assert [v.verdict for v in found] == ["weak" if one == "identified" else one for one in before]
    assert all(one is v for one, v in zip(found, verdicts.values(), strict=True) if v.verdict != "identified")
    doubted = [one for one, v in zip(found, before, strict=True) if v == "identified"]
    assert all("one foot softer" in one.reason and one.decided_by == "misfit" for one in doubted)


def test_an_interval_too_long_to_use_is_not_identified(problem: Problem) -> None:
    """A factor of four between bounds of three decades has a fifth of their deviation, and is no use."""
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(4000)
    short = spread(problem, 2, np.log(TRUTH[2]) + 0.15 * noise)
    long = spread(problem, 2, np.log(TRUTH[2]) + 0.4 * noise)
    assert (short.verdict, short.decided_by) == ("identified", "data")
    assert (long.verdict, long.decided_by) == ("weak", "data")
    # 2 · 1.645 standard deviations; 4000 draws tell a quantile to 3 %
    assert long.interval_factor == pytest.approx(np.exp(3.29 * 0.4), rel=0.1)
    assert long.ratio < 0.3 and "factor of" in long.reason


def test_an_interval_that_ends_at_a_bound_is_the_bounds(problem: Problem) -> None:
    low = float(problem.prior.low[2])
    leaning = spread(problem, 2, low + 0.2 * np.abs(np.random.default_rng(4).standard_normal(4000)))
    assert (leaning.verdict, leaning.decided_by) == ("weak", "bounds")
    assert leaning.interval_factor < 2.0


def test_an_interval_that_is_the_priors_is_not_the_datas(problem: Problem) -> None:
    """A prior of 10 % gives a short interval whatever the data say."""
    p = problem.parameters[2]
    informed = replace(p, median=TRUTH[2], log_std=0.1)
    parameters = (*problem.parameters[:2], informed, problem.parameters[3])
    prior = replace(problem, parameters=parameters, prior=BoxPrior.of(parameters))
    noise = np.random.default_rng(5).standard_normal(4000)
    untold = spread(prior, 2, np.log(TRUTH[2]) + 0.098 * noise)
    half = spread(prior, 2, np.log(TRUTH[2]) + 0.07 * noise)
    told = spread(prior, 2, np.log(TRUTH[2]) + 0.04 * noise)
    assert [(v.verdict, v.decided_by) for v in (untold, half, told)] == [
        ("unidentified", "prior"), ("weak", "prior"), ("identified", "data"),
    ]  # fmt: skip


def test_zener_between_bounds_of_seven_decades_is_not_identified(jacket15: Assembly) -> None:
    """Its posterior is a quarter of the prior's width, and still spans a factor of dozens."""
    model = support_model(
        jacket15, family=family("zener"), rayleigh=Rayleigh.minimum(0.0055, 0.1832), highest_mode=5
    )
    poles = model.predict(np.array([2.6e9, 8e8, 1e10]), MODES).poles
    f, zeta = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    targets = (
        Target(1, f[0], 3e-3 * f[0], zeta[0], 0.15 * zeta[0]),
        Target(2, f[1], 3e-3 * f[1]),
        Target(4, f[2], 5e-3 * f[2]),
    )
    wide = single(model, Residuals(targets, relative=False))
    draws = sample_posterior(wide, particles=300, islands=3, seed=1).log_theta
    found = {v.name: v for v in identifiability(wide, draws)}
    assert found["k0"].ratio < 0.4 and found["k0"].interval_factor > 10.0 > USABLE
    assert (found["k0"].verdict, found["k0"].decided_by) == ("weak", "data")
    assert found["k1"].decided_by == "bounds"


def test_without_a_posterior_nothing_is_identified(problem: Problem, draws: np.ndarray) -> None:
    found = identifiability(problem, draws, converged=False)
    assert {v.decided_by for v in found} == {"no posterior"}
    assert "identified" not in {v.verdict for v in found}


def test_before_any_value_is_known_the_design_says_the_same(verdicts: dict[str, Verdict]) -> None:
    assert verdicts["c_horizontal"].verdict_before == "unidentified"
    assert verdicts["k_vertical"].ratio_before < verdicts["k_horizontal"].ratio_before


def test_a_profile_is_least_at_the_solution_and_rises_as_the_data_say(problem: Problem) -> None:
    sharp, flat = profile(problem, TRUTH, 2), profile(problem, TRUTH, 1)
    assert sharp.values[np.argmin(sharp.cost)] == pytest.approx(TRUTH[2])
    assert sharp.cost[0] > 50.0 and sharp.cost[-1] > 10.0
    # the interval's ends lie between points that are not far apart
    near = sharp.cost < sharp.cost.min() + 8.0
    assert near.sum() >= 5 and np.abs(np.diff(sharp.cost[near])).max() < 4.0
    # nothing sees the horizontal dashpots until they lock
    assert flat.cost[flat.values < TRUTH[1]].max() < 0.5


def test_predictions_contain_the_truth(problem: Problem, draws: np.ndarray) -> None:
    q = predict_quantities(problem.model, np.exp(draws), (1, 4, 5))
    truth = problem.model.predict(TRUTH, (1, 4, 5)).poles
    for values, true in (
        (q.damping_ratio, -truth.real / np.abs(truth)),
        (q.undamped_hz, problem.model.undamped_hz(TRUTH, (1, 4, 5))),
    ):
        low, high = np.quantile(values, [0.05, 0.95], axis=0)
        assert (low <= true).all() and (true <= high).all()


def test_supports_are_stated_as_data_see_them(problem: Problem) -> None:
    """Kelvin–Voigt: constant stiffness, a loss factor ωc/k that grows with the frequency."""
    seen = support_quantities(problem.model, TRUTH[None])
    omega = problem.model.condensed.pinned.omega
    assert seen["storage_stiffness_vertical"][0] == pytest.approx(2.5e9)
    assert seen["static_stiffness_vertical"][0] == pytest.approx(2.5e9)
    assert seen["loss_factor_vertical"][0] == pytest.approx(omega[0] * 1e8 / 2.5e9)
    assert seen["stiffness_growth_vertical"][0] == pytest.approx(1.0)
    assert seen["loss_factor_growth_vertical"][0] == pytest.approx(omega[3] / omega[0])


def test_laplace_keeps_the_prior_of_what_no_data_see(problem: Problem) -> None:
    z = laplace_draws(problem, TRUTH, n=2000)
    ratio = z.std(axis=0) / problem.prior.std
    # clipping at the bounds narrows a normal of the prior's width by a few per cent
    assert ratio[1] > 0.7 and ratio[2] < 0.1
