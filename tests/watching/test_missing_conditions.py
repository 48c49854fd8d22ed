"""Conditions that are missing, or whose sensor stands still."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.watching import History, start, step
from jackettwin.watching.condition_effects import absent_variance, never_seen, usual_conditions, without_still
from jackettwin.watching.design import design_of, fresh, regressors

from .conftest import made


def windy(days: np.ndarray, wind: np.ndarray) -> History:
    none = np.full((days.size, 1), np.nan)
    return History(days, ("f",), none, none, none, none, wind[:, None], ("wind",), np.zeros(days.size, int))


@pytest.mark.parametrize("keep", [0.0, 0.6])
def test_what_a_missing_condition_does_has_the_variance_of_its_mean_over_weeks(keep: float) -> None:
    """The mean of n values of an AR(1) process has the variance σ² (1 + r)/(1 − r)/n."""
    rng, days = np.random.default_rng(1), np.arange(20_000.0)
    wind = rng.standard_normal(days.size)
    for i in range(1, days.size):
        wind[i] = keep * wind[i - 1] + np.sqrt(1.0 - keep**2) * wind[i]
    h = windy(days, wind)
    design = design_of(h)
    rows, _ = regressors(design, h, fresh(design))
    usual = usual_conditions(design, h, rows, np.full(1, np.inf))
    effect = 0.003 * np.array(
        [[0.0, *(float(c.name == "wind" and c.shape == "line") for c in design.columns)]]
    )
    variance = absent_variance(design, usual, np.array([[True], [False]]), rows[:2], effect)
    weeks = effect[0, 1] * wind.reshape(-1, 50).mean(axis=1)
    assert variance[0, 0] == pytest.approx(2.0 * 50.0 * weeks.var(), rel=0.12)  # of two records on a day
    assert variance[1, 0] == 0.0


def test_a_sensor_stands_still_from_as_many_equal_values_on_in_whatever_parts_they_come() -> None:
    days = np.arange(0.0, 8.0, 0.25)
    wind = np.sin(days)
    wind[7:20] = wind[7]
    h, limit = windy(days, wind), np.array([6.0])
    whole, missing, last = without_still(h, never_seen(h), limit)
    assert np.flatnonzero(np.isnan(whole.conditions[:, 0])).tolist() == [*range(7, 20)]
    assert np.flatnonzero(missing[:, 0]).tolist() == [*range(8, 20)]  # a quarter of a day later
    seen, left = never_seen(h), []
    for day in h.by_day():
        known, _, seen = without_still(day, seen, limit)
        left += np.isnan(known.conditions[:, 0]).tolist()
    assert np.flatnonzero(left).tolist() == [*range(12, 20)]  # those of a day on which it is known
    assert seen == last or (seen.value == last.value and seen.repeats == last.repeats)


def test_a_storm_that_no_sensor_saw_is_no_change() -> None:
    """Wind wanders over days and lowers both modes; a storm as strong as any before it comes unseen."""
    seasons, rng = made(seed=4, days=133), np.random.default_rng(4)
    wind = np.zeros(seasons.days.size)
    for i in range(1, wind.size):
        wind[i] = 0.9 * wind[i - 1] + np.sqrt(0.19) * rng.standard_normal()
    storm = (seasons.days >= 125.0) & (seasons.days < 128.0)
    wind[storm] = wind[seasons.days < 100.0].max()
    shown = np.where(seasons.days >= 120.0, wind[480], wind)
    history = replace(
        seasons,
        frequency=seasons.frequency * np.exp(-4e-3 * wind)[:, None],
        conditions=np.column_stack([seasons.conditions, shown]),
        condition_names=(*seasons.condition_names, "wind_speed"),
    )
    later, begun = history.between(115.0, np.inf), start(history.between(0.0, 100.0))
    for watch, expected in ((begun, False), (replace(begun, usual=None), True)):
        for day in later.by_day():
            watch, look = step(watch, day)
            if look.change is not None:
                break
        assert (look.change is not None) == expected
