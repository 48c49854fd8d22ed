"""Priors against the distributions of SciPy."""

import numpy as np
import pytest
from scipy import stats

from jackettwin.errors import InputError
from jackettwin.soil import Parameter
from jackettwin.updating.prior import BoxPrior

FLAT = Parameter("flat", 1e2, 1e5, "-")
NORMAL = Parameter("normal", 1e2, 1e5, "-", median=1e4, log_std=1.5)


@pytest.fixture
def prior() -> BoxPrior:
    return BoxPrior.of((FLAT, NORMAL))


@pytest.fixture
def marginals() -> tuple[stats.rv_continuous, stats.rv_continuous]:
    low, high, mean = np.log([1e2, 1e5, 1e4])
    return (
        stats.uniform(low, high - low),
        stats.truncnorm((low - mean) / 1.5, (high - mean) / 1.5, mean, 1.5),
    )


def test_density_and_spread(prior: BoxPrior, marginals) -> None:
    z = np.array([[5.0, 6.0], [11.0, 9.2], [4.0, 9.0], [9.0, 12.0]])
    expected = sum(m.logpdf(column) for m, column in zip(marginals, z.T, strict=True))
    np.testing.assert_allclose(prior.log_density(z), expected, rtol=1e-12)
    np.testing.assert_allclose(prior.std, [m.std() for m in marginals], rtol=1e-9)


def test_draws_have_the_density(prior: BoxPrior, marginals, rng: np.random.Generator) -> None:
    for column, m in zip(prior.draw(2000, rng).T, marginals, strict=True):
        # one in a thousand right samplers fails; the seed is fixed
        assert stats.kstest(column, m.cdf).pvalue > 1e-3


def test_normal_priors_are_residuals(prior: BoxPrior) -> None:
    r, J = prior.rows(np.log([1e3, 1e3]))
    np.testing.assert_allclose(r, [np.log(0.1) / 1.5])
    np.testing.assert_allclose(J, [[0.0, 1.0 / 1.5]])


@pytest.mark.parametrize(
    ("median", "log_std", "message"),
    [(1e6, 1.0, "outside the bounds"), (1e3, None, "a median and a positive"), (None, 1.0, "a median and")],
)
def test_priors_that_cannot_be(median: float | None, log_std: float | None, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Parameter("k", 1e2, 1e5, "-", median=median, log_std=log_std)
