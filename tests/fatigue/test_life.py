"""Damage, its interval, and where its variance comes from."""

import numpy as np
import pytest

from jackettwin.fatigue import Cycles, LifeModel, read_curve

YEAR_S = 365.25 * 86400.0


def test_a_constant_range_lasts_as_long_as_the_curve_says() -> None:
    """0.2 Hz of 100 MPa on T in air: 10^12.480/10⁶ cycles."""
    curve = read_curve("T", "air")
    cycles = Cycles(np.full(120, 100e6), np.empty(0))
    life = LifeModel(curve).life(cycles, 600.0)
    assert life.life_years == pytest.approx(10.0**6.480 / 0.2 / YEAR_S, rel=1e-12)
    assert LifeModel(curve, design_factor=3.0).life(cycles, 600.0).life_years == pytest.approx(
        life.life_years / 3.0, rel=1e-12
    )
    assert life.slope == 3.0


def test_the_interval_is_that_of_independent_logarithms(rng: np.random.Generator) -> None:
    """By sampling: log N of tests, the factor on all ranges, Miner's sum; single slope, so that m is 3."""
    curve = read_curve("D", "free-corrosion")
    cycles = Cycles(rng.uniform(20e6, 60e6, 50), np.full(3, 80e6))
    found = LifeModel(curve, scf_cov=0.15, load_cov=0.1).life(cycles, 600.0)
    n = 400_000
    factor = np.exp(0.15 * rng.standard_normal(n) + 0.1 * rng.standard_normal(n))
    log_n = 2.0 * 0.2 + 0.2 * rng.standard_normal(n)
    drawn = found.damage * factor**3 * 10.0**-log_n * np.exp(0.3 * rng.standard_normal(n))
    # quantiles of 400,000 draws of a logarithm of deviation 0.77: to 0.4 %
    low, median, high = np.quantile(drawn, [0.05, 0.5, 0.95])
    assert found.damage_interval_90 == pytest.approx((low, high), rel=0.02)
    assert found.median_damage == pytest.approx(median, rel=0.02)
    assert sum(found.variance_shares.values()) == pytest.approx(1.0)
    assert found.variance_shares["S-N scatter"] == pytest.approx(
        (0.2 * np.log(10.0)) ** 2 / np.log(drawn).var(), rel=0.02
    )


def test_the_slope_is_that_of_the_damage() -> None:
    curve = read_curve("T", "air")
    below, above = np.full(1000, 40e6), np.full(10, 120e6)
    parts = [curve.damage(S, np.ones(S.size)) for S in (above, below)]
    found = LifeModel(curve).life(Cycles(np.concatenate([above, below]), np.empty(0)), 600.0)
    assert found.slope == pytest.approx((3.0 * parts[0] + 5.0 * parts[1]) / sum(parts), rel=1e-12)


def test_what_does_not_move_lives_for_ever() -> None:
    life = LifeModel(read_curve("T", "air")).life(Cycles(np.empty(0), np.empty(0)), 600.0)
    assert (life.damage, life.life_years) == (0.0, np.inf)
