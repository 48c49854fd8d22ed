"""What is left of a lognormal life."""

from math import exp, inf

import numpy as np
import pytest
from scipy.stats import lognorm, norm

from jackettwin.errors import InputError
from jackettwin.fatigue import RemainingLife


def test_quantiles_are_those_of_lives_that_outlast_the_age() -> None:
    """Against a million drawn lives, whose least quantile has a standard error of half a per cent."""
    left = RemainingLife(0.03, 0.8, 25.0)
    lives = exp(-np.log(0.03)) * np.exp(0.8 * np.random.default_rng(1).standard_normal(1_000_000))
    lives = lives[lives > 25.0] - 25.0
    for p in (0.05, 0.5, 0.95):
        assert left.quantile(p) == pytest.approx(np.quantile(lives, p), rel=0.02)
    assert left.failure_in(10.0) == pytest.approx((lives < 10.0).mean(), rel=0.01)


def test_without_age_the_life_is_lognormal() -> None:
    """The distribution of SciPy, and β of its first year."""
    left = RemainingLife(0.04, 0.6)
    life = lognorm(0.6, scale=25.0)
    assert left.quantile(0.5) == pytest.approx(25.0)
    assert left.quantile(0.05) == pytest.approx(life.ppf(0.05))
    assert left.reliability_index == pytest.approx(-norm.ppf(life.cdf(1.0)))


def test_reliability_falls_to_a_target_in_a_year() -> None:
    left = RemainingLife(0.04, 0.6)
    year = left.year_of_index(3.1)
    assert year is not None and year > 0
    before, after = (RemainingLife(0.04, 0.6, year + k).reliability_index for k in (-1.0, 0.0))
    assert before >= 3.1 > after
    assert RemainingLife(0.5, 0.6, 5.0).year_of_index(3.1) == 0.0
    assert RemainingLife(1e-9, 0.1).year_of_index(3.1, at_most=20.0) is None


def test_without_damage_nothing_fails() -> None:
    assert RemainingLife(0.0, 0.6, 3.0).quantile(0.05) == inf
    assert RemainingLife(0.0, 0.6).failure_in(100.0) == 0.0


def test_a_life_without_scatter_is_refused() -> None:
    with pytest.raises(InputError, match="log_std"):
        RemainingLife(0.1, 0.0)
