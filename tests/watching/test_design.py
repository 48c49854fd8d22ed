"""Regressors: what stands for a temperature that nobody told, and what a model knows of a condition."""

import numpy as np
import pytest

from jackettwin.watching import History, Slope
from jackettwin.watching.design import (
    GROUND_DAYS,
    HEALING_DAYS,
    design_of,
    fresh,
    regressors,
    with_slow_processes,
)


def rows(days: np.ndarray, **conditions: np.ndarray) -> History:
    none = np.full((days.size, 1), np.nan)
    beside = np.stack([*conditions.values()], axis=1) if conditions else np.zeros((days.size, 0))
    ones = np.ones((days.size, 1))
    return History(
        days, ("one",), ones, none, none, none, beside, tuple(conditions), np.zeros(days.size, int)
    )


def test_the_time_of_year_stands_for_a_temperature_once_a_year_was_seen() -> None:
    whole, part = np.arange(0.0, 365.0, 1.0), np.arange(0.0, 200.0, 1.0)
    design = design_of(rows(whole))
    assert [c.name for c in design.columns] == ["time of year"] * 2 and design.hidden
    assert design_of(rows(part)).columns == ()
    told = design_of(rows(whole, air_temperature_c=np.cos(whole)))
    assert "time of year" not in told.names
    x, _ = regressors(design, rows(np.array([10.0, 10.0 + 365.25, 10.0 + 365.25 / 2.0])), fresh(design))
    np.testing.assert_allclose(x[1], x[0], atol=1e-9)
    np.testing.assert_allclose(x[2, 1:], -x[0, 1:], atol=1e-9)


def test_a_models_slope_is_that_of_its_condition_in_standard_units() -> None:
    level = 0.9 * np.sin(np.arange(0.0, 200.0))
    design = design_of(rows(np.arange(0.0, 200.0), sea_level_m=level, hs_m=level**2))
    slope = Slope("sea_level_m", np.array([-7e-4]), np.array([8e-4]))
    known, unknown = design.coefficients(np.array([1e-3]), [slope]), design.coefficients(np.array([1e-3]))
    (place,) = np.flatnonzero(known.mean[0])
    assert design.names[place] == "sea_level_m"
    assert known.mean[0, place] == pytest.approx(-7e-4 * level.std())
    assert known.std[0, place] == pytest.approx(8e-4 * level.std())
    np.testing.assert_array_equal(np.delete(known.std, place, 1), np.delete(unknown.std, place, 1))


def test_a_baseline_of_a_year_knows_slow_processes_and_a_short_one_does_not() -> None:
    whole, half, part = np.arange(0.0, 365.0), np.arange(0.0, 200.0), np.arange(0.0, 90.0)

    def slow(days: np.ndarray) -> list[tuple[str, str, float]]:
        h = rows(days, air_temperature_c=10.0 + np.cos(days / 58.0), hs_m=1.0 + np.sin(days) ** 8)
        usual = design_of(h)
        added = with_slow_processes(usual, h).columns[len(usual.columns) :]
        return [(c.name, c.shape, c.lag_days) for c in added]

    assert slow(part) == []
    assert slow(half) == [("hs_m", "storm", HEALING_DAYS), ("time", "trend", 0.0)]  # growth goes on
    assert slow(whole) == [
        ("hs_m", "storm", HEALING_DAYS), ("air_temperature_c", "line", GROUND_DAYS), ("time", "trend", 0.0),
    ]  # fmt: skip


def test_storms_soften_and_what_they_softened_settles() -> None:
    """One storm of three days: the regressor jumps with it and falls by 1/e in its time constant."""
    days = np.arange(0.0, 400.0, 0.25)
    hs = np.where((days >= 200.0) & (days < 203.0), 6.0, 1.0 + 0.2 * np.sin(days))
    h = rows(days, hs_m=hs)
    design = with_slow_processes(design_of(h), h)
    place = [c.shape for c in design.columns].index("storm") + 1  # after the level
    x = regressors(design, h, fresh(design, h))[0][:, place]
    assert np.all(np.abs(x[days < 200.0]) < 0.01 * x.max())
    after = days >= 203.0
    expected = x[after][0] * np.exp(-(days[after] - days[after][0]) / HEALING_DAYS)
    np.testing.assert_allclose(x[after], expected, atol=0.002 * x.max())


def test_what_follows_for_weeks_begins_as_a_year_ends() -> None:
    """The ground in its second January is as in its first: no start-up that a baseline would learn from."""
    days = np.arange(0.0, 730.0)
    h = rows(days, air_temperature_c=10.0 - 7.0 * np.cos(2.0 * np.pi * days / 365.0))
    year = h.between(0.0, 365.0)
    design = with_slow_processes(design_of(year), year)
    place = [c.lag_days for c in design.columns].index(GROUND_DAYS) + 1
    x = regressors(design, h, fresh(design, year))[0][:, place]
    np.testing.assert_allclose(x[:365], x[365:], atol=0.01 * np.ptp(x))
    started = regressors(design, h, fresh(design))[0][:, place]
    assert np.abs(started[:30] - started[365:395]).max() > 0.1 * np.ptp(x)
