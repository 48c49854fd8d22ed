"""Evidence from draws: closed forms, separate hills, a bound through the posterior, and an honest spread."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.special import ndtr

from jackettwin.updating.posterior.evidence import bridge, bridged_evidence
from jackettwin.updating.prior import BoxPrior

FloatArray = np.ndarray

HALF = 12.0
"""Half the prior's width, in standard deviations of the likelihood."""
# the spread of four runs of 200 draws is 0.02 to 0.04 in these cases: 0.05 is three standard deviations or
# more of their mean, and half of what the evidence is promised to
WITHIN = 0.05


def box(d: int, low: float = -HALF) -> BoxPrior:
    return BoxPrior(np.full(d, low), np.full(d, HALF), np.zeros(d), np.full(d, np.inf))


def normal(z: FloatArray) -> FloatArray:
    """Return ln L of a normal likelihood."""
    return np.asarray(-0.5 * (z * z).sum(axis=1) - 0.5 * z.shape[1] * np.log(2.0 * np.pi))


def evidence(
    log_likelihood: Callable[[FloatArray], FloatArray],
    prior: BoxPrior,
    z: FloatArray,
    rng: np.random.Generator,
) -> tuple[float, float]:
    """Return ln Z of draws (n_runs, n_draws, d), and the standard deviation of its mean."""
    log_l = np.array([log_likelihood(run) for run in z])
    log_z = bridged_evidence(log_likelihood, prior, z, log_l, rng)
    return float(log_z.mean()), float(log_z.std(ddof=1) / np.sqrt(log_z.size))


@pytest.mark.parametrize("d", [1, 2, 3, 6])
def test_a_normal_posterior(d: int, rng: np.random.Generator) -> None:
    """The prior's density times 1."""
    found, std = evidence(normal, box(d), rng.standard_normal((4, 200, d)), rng)
    assert found == pytest.approx(-d * np.log(2.0 * HALF), abs=WITHIN)
    assert std < WITHIN


def test_two_hills_of_different_width(rng: np.random.Generator) -> None:
    """A tenth of the mass lies in a hill a third as wide."""
    shift, width = 5.0, 1.0 / 3.0

    def two(z: FloatArray) -> FloatArray:
        narrow = normal((z + shift) / width) - z.shape[1] * np.log(width)
        return np.logaddexp(np.log(0.1) + narrow, np.log(0.9) + normal(z - shift))

    z, first = rng.standard_normal((4, 300, 2)), rng.random((4, 300, 1)) < 0.1
    found, _ = evidence(two, box(2), np.where(first, width * z - shift, z + shift), rng)
    assert found == pytest.approx(-2.0 * np.log(2.0 * HALF), abs=WITHIN)


def test_bounds_through_the_hill(rng: np.random.Generator) -> None:
    """Nothing beyond them is evaluated: the model may not exist there."""

    def above(z: FloatArray) -> FloatArray:
        assert (z >= 0.5).all()
        return normal(z)

    prior = box(2, low=0.5)
    z = rng.standard_normal((40000, 2))
    z = z[(z > 0.5).all(axis=1)][:1200].reshape(4, 300, 2)
    found, _ = evidence(above, prior, z, rng)
    mass = 2.0 * np.log(ndtr(-0.5)) - 2.0 * np.log(HALF - 0.5)
    assert found == pytest.approx(mass, abs=WITHIN)


def test_a_bent_valley(rng: np.random.Generator) -> None:
    """It is 30 times as long as wide, and bends through a right angle."""

    def straight(z: FloatArray) -> FloatArray:
        return np.stack([z[:, 0] / 2.0, (z[:, 1] - 0.5 * z[:, 0] ** 2 + 5.0) / 0.1], axis=1)

    def valley(z: FloatArray) -> FloatArray:
        return normal(straight(z)) - np.log(0.2)

    x = rng.standard_normal((20000, 2))
    z = np.stack([2.0 * x[:, 0], 0.5 * (2.0 * x[:, 0]) ** 2 - 5.0 + 0.1 * x[:, 1]], axis=1)
    inside = (np.abs(z) < HALF).all(axis=1)
    found, _ = evidence(valley, box(2), z[inside][:1200].reshape(4, 300, 2), rng)
    # what the box cuts off is known to 1 % from 20,000 draws
    assert found == pytest.approx(np.log(inside.mean()) - 2.0 * np.log(2.0 * HALF), abs=WITHIN + 0.01)


def test_where_the_likelihood_vanishes(rng: np.random.Generator) -> None:
    """Half of the hill is a place where a mode does not exist."""

    def half(z: FloatArray) -> FloatArray:
        return np.where(z[:, 0] > 0.0, normal(z), -1e30)

    z = rng.standard_normal((4, 200, 2))
    z[..., 0] = np.abs(z[..., 0])
    found, _ = evidence(half, box(2), z, rng)
    assert found == pytest.approx(np.log(0.5) - 2.0 * np.log(2.0 * HALF), abs=WITHIN)


def test_the_spread_of_runs_is_the_error_of_their_mean() -> None:
    """Errors over their stated standard deviation are Student's of three degrees of freedom."""
    exact, apart = -2.0 * np.log(2.0 * HALF), []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        found, std = evidence(normal, box(2), rng.standard_normal((4, 80, 2)), rng)
        apart.append(abs(found - exact) / std)
    # 30 of probability 0.9 within 2.353: 20 or fewer once in a thousand times
    assert np.sum(np.array(apart) < 2.353) > 20


def test_data_precise_to_a_millionth(rng: np.random.Generator) -> None:
    """Widths that differ by orders of magnitude between the parameters."""
    scale = np.array([1e-6, 1.0])

    def sharp(z: FloatArray) -> FloatArray:
        return normal((z - 1.0) / scale)

    z = 1.0 + scale * rng.standard_normal((4, 200, 2))
    found, _ = evidence(sharp, box(2), z, rng)
    exact = np.log(scale).sum() - 2.0 * np.log(2.0 * HALF)
    assert found == pytest.approx(exact, abs=WITHIN)


def test_a_bridge_to_few_independent_draws_is_importance_sampling() -> None:
    """With s₁ → 0 the bridge rests on the trial draws alone, with s₂ → 0 on the reciprocals of the others."""
    rng = np.random.default_rng(8)
    at_draws, at_trial = rng.normal(-2.0, 0.5, 300), rng.normal(-2.3, 0.7, 200)
    by_trial = np.log(np.exp(at_trial).mean())
    by_draws = -np.log(np.exp(-at_draws).mean())
    assert bridge(at_draws, at_trial, independent=1e-9) == pytest.approx(by_trial, abs=1e-6)
    assert bridge(at_draws, at_trial, independent=1e12) == pytest.approx(by_draws, abs=1e-6)
    assert abs(by_trial - by_draws) > 0.01
