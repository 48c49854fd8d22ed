"""Central intervals against the distributions they are named after."""

import numpy as np
import pytest
import scipy.stats

from jackettwin.intervals import NORMAL_90, NORMAL_95, interval_90, log_interval_95


def test_the_two_quantiles_are_those_of_the_normal_distribution() -> None:
    assert scipy.stats.norm.ppf(0.95) == pytest.approx(NORMAL_90, rel=1e-14)
    assert scipy.stats.norm.ppf(0.975) == pytest.approx(NORMAL_95, rel=1e-14)


def test_a_95_percent_interval_of_a_logarithm_is_that_of_a_lognormal() -> None:
    expected = scipy.stats.lognorm(s=0.3, scale=0.02).interval(0.95)
    assert log_interval_95(0.02, 0.3) == pytest.approx(expected, rel=1e-12)


def test_draws_leave_one_in_twenty_on_either_side() -> None:
    low, middle, high = interval_90(np.append(np.arange(1.0, 1002.0), np.nan)) or (0.0, 0.0, 0.0)
    assert (low, middle, high) == (51.0, 501.0, 951.0)  # of 1001 draws, 50 lie below and 50 above
    assert interval_90(np.full(3, np.nan)) is None
