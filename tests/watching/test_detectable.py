"""What a watch is said to find is found as often as is said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from jackettwin.watching import History, Sight, Watch, sight, start, step

from .conftest import made

DAYS, TURBINES = 30.0, 12


def learnt(seed: int) -> tuple[Watch, History]:
    baseline = made(seed=seed, days=100)
    return start(baseline), baseline


def alike(size: float, watch: Watch) -> np.ndarray:
    """Return both frequencies falling by a size, and nothing else: one draw."""
    out = np.zeros((1, len(watch.quantities)))
    out[:, :2] = -size
    return out


def is_found(seed: int, watch: Watch, size: float) -> bool:
    history = made(seed=seed, days=150, step=-size, begin=120.0)
    for day in history.between(100.0, 120.0 + DAYS).by_day():
        watch, look = step(watch, day)
        if look.change is not None:
            return True
    return False


def test_changes_of_the_size_that_is_told_are_found() -> None:
    """Chance leaves, of changes that are found with 95 %, fewer than 9 of 12 once in four hundred times.

    Half as large they are found clearly less often: a size that is told too large would be found, too.
    """
    assert binom.cdf(8, TURBINES, 0.95) < 0.0025
    whole, half = 0, 0
    for seed in range(TURBINES):
        watch, baseline = learnt(seed)
        seen = sight(watch, baseline, DAYS)
        assert seen is not None
        size = seen.smallest(lambda x: alike(x, watch), 1e-4, 0.05)  # noqa: B023
        assert size is not None
        whole += is_found(seed, watch, size)
        half += seed < TURBINES // 2 and is_found(seed, watch, 0.5 * size)
    assert whole >= 9
    assert half <= 4


@pytest.fixture(scope="module")
def seen() -> tuple[Watch, History, Sight]:
    watch, baseline = learnt(3)
    found = sight(watch, baseline, DAYS)
    assert found is not None
    return watch, baseline, found


def test_longer_watching_and_a_looser_promise_see_more(seen: tuple[Watch, History, Sight]) -> None:
    watch, baseline, month = seen
    longer = sight(watch, baseline, 90.0)
    loose = sight(start(baseline, arl_years=0.1), baseline, DAYS)
    assert longer is not None and loose is not None
    each = [s.smallest(lambda x: alike(x, watch), 1e-4, 0.05) for s in (longer, loose, month)]
    assert each[0] is not None and each[1] is not None and each[2] is not None
    assert each[0] < each[2] and each[1] < each[2]


def test_the_chance_rises_with_size_and_nothing_is_no_change(seen: tuple[Watch, History, Sight]) -> None:
    watch, _, month = seen
    chance = [month.chance(alike(x, watch)) for x in (0.0, 0.001, 0.003, 0.01)]
    assert chance == sorted(chance) and chance[0] < 0.01 and chance[-1] > 0.99
    assert month.chance(-alike(0.01, watch)) > 0.99
    either = np.concatenate([alike(0.001, watch), alike(0.003, watch)])
    assert month.chance(either) == pytest.approx((chance[1] + chance[2]) / 2.0)
    assert month.smallest(lambda x: alike(x, watch), 1e-5, 1e-4) is None


def test_kinds_that_are_not_monitored_leave_their_share_to_the_others(
    seen: tuple[Watch, History, Sight],
) -> None:
    """Frequency and scatter have 0.7 and 0.1 of the weights: alone, 0.8 of the evidence raises an alarm."""
    watch, baseline, month = seen
    assert watch.staked == pytest.approx(1.0)
    alone = sight(replace(watch, blocks=watch.blocks[:1]), baseline, DAYS)
    assert alone is not None
    assert alone.log_needed - month.log_needed == pytest.approx(np.log(0.8))


def test_a_longer_horizon_is_projected_and_said_to_be(seen: tuple[Watch, History, Sight]) -> None:
    """The records of seventy days come again and again, as those of a hundred would: the size is the same."""
    watch, baseline, month = seen
    ninety, projected = (sight(watch, b, 90.0) for b in (baseline, baseline.between(30.0, 100.0)))
    assert ninety is not None and projected is not None
    assert projected.projected and not ninety.projected and not month.projected
    known, told = (s.smallest(lambda x: alike(x, watch), 1e-4, 0.05) for s in (ninety, projected))
    assert known is not None and told is not None
    np.testing.assert_allclose(told, known, rtol=0.1)
    assert sight(watch, baseline.between(50.0, 100.0), 90.0) is None
