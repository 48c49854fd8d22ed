"""Record after record: what stays is known better and better, what drifts is noticed."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from jackettwin.errors import InputError
from jackettwin.structure import Assembly, Rayleigh
from jackettwin.updating import Problem, Residuals, SupportModel, Target, family, single, support_model
from jackettwin.updating.sequential import DrawnPrior, drift_log_odds, follow_records

MODES = (1, 2, 4)


@pytest.fixture(scope="module")
def model(jacket15: Assembly) -> SupportModel:
    return support_model(
        jacket15,
        family=family("maxwell-3"),
        rayleigh=Rayleigh.minimum(0.0055, 0.1832),
        bounds={"k": (1e9, 1e10), "loss_factor": (1e-2, 0.5)},
        highest_mode=5,
    )


def records(model: SupportModel, stiffness: np.ndarray, seed: int) -> list[Problem]:
    """Return one day's fused records for each stiffness: 0.1 % on f, 10 % on ζ."""
    rng = np.random.default_rng(seed)
    problems = []
    for k in stiffness:
        targets = []
        for mode, pole in zip(MODES, model.predict(np.array([k, 0.1]), MODES).poles, strict=True):
            f, zeta = abs(pole) / (2 * np.pi), -pole.real / abs(pole)
            f_seen, zeta_seen = np.exp(rng.normal(np.log([f, zeta]), [1e-3, 0.1]))
            targets.append(Target(mode, f_seen, 1e-3 * f_seen, zeta_seen, 0.1 * zeta_seen))
        problems.append(single(model, Residuals(tuple(targets), relative=False)))
    return problems


def test_soil_that_stays_is_known_better_after_every_day(model: SupportModel) -> None:
    days = records(model, np.full(4, 3e9), seed=1)
    walk = follow_records(days, particles=100, islands=3, seed=2)
    spread = [p.log_theta[:, 0].std() for p in walk.posteriors]
    # √4, give or take what 120 draws know of a standard deviation
    assert spread[-1] < 0.7 * spread[0]
    low, high = walk.interval()[-1, 0]
    assert low < 3e9 < high


def test_a_drift_is_noticed_and_followed(model: SupportModel) -> None:
    falling = 3e9 * np.exp(-0.25 * np.arange(3))
    days = records(model, falling, seed=3)
    assert drift_log_odds(days, {"k": 0.25}, particles=100, islands=3, seed=4) > 3.0
    walk = follow_records(days, drift={"k": 0.25}, particles=100, islands=3, seed=5)
    low, high = walk.interval()[-1, 0]
    assert low < falling[-1] < high
    assert walk.median()[-1, 0] < 0.8 * walk.median()[0, 0]


def test_soil_that_stays_shows_no_drift(model: SupportModel) -> None:
    days = records(model, np.full(3, 3e9), seed=6)
    assert drift_log_odds(days, {"k": 0.25}, particles=100, islands=3, seed=7) < 0.0


def test_the_mixture_is_a_density(rng: np.random.Generator) -> None:
    z = rng.multivariate_normal([0.0, 1.0], [[0.04, 0.01], [0.01, 0.09]], 400)
    low, high = np.full(2, -10.0), np.full(2, 10.0)
    prior = DrawnPrior.after(z, np.zeros(2), low, high)
    # shrunk and widened again: mean and spread of the draws stay
    np.testing.assert_allclose(prior.std, z.std(axis=0), rtol=0.1)
    x = prior.draw(4000, rng)
    np.testing.assert_allclose(x.mean(axis=0), z.mean(axis=0), atol=0.03)
    point = np.array([[0.1, 1.1]])
    normal = multivariate_normal(z.mean(axis=0), np.cov(z, rowvar=False)).logpdf(point[0])
    # a mixture of 200 kernels against the normal its centres came from
    assert prior.log_density(point)[0] == pytest.approx(normal, abs=0.3)
    assert prior.log_density(np.array([[11.0, 0.0]]))[0] == -np.inf


def test_records_that_cannot_be_followed(model: SupportModel) -> None:
    with pytest.raises(InputError, match="no record"):
        follow_records([])
    with pytest.raises(InputError, match="no such parameter"):
        follow_records(records(model, np.array([3e9]), seed=0), drift={"c": 0.1})
