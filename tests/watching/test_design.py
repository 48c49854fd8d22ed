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

    def slow(days: np.ndarray, **more: np.ndarray) -> list[tuple[str, str, float]]:
        h = rows(days, hs_m=1.0 + np.sin(days) ** 8, **more)
        usual = design_of(h)
        added = with_slow_processes(usual, h).columns[len(usual.columns) :]
        return [(c.name, c.shape, c.lag_days) for c in added]

    air = [10.0 + np.cos(days / 58.0) for days in (part, half, whole)]
    storm, ground = ("hs_m", "storm", HEALING_DAYS), ("air_temperature_c", "line", GROUND_DAYS)
    growth = ("time", "trend", 0.0)
    started = [(name, "settling", 0.0) for name in ("hs_m", "air_temperature_c")]
    assert slow(part, air_temperature_c=air[0]) == []
    assert slow(half, air_temperature_c=air[1]) == [storm, ground, *started, growth]
    assert slow(whole, air_temperature_c=air[2]) == [storm, ground, growth]
    year = [("time of year", shape, 0.0) for shape in ("sine", "cosine")]
    assert slow(half) == [storm, started[0], *year, growth]
    assert slow(whole) == [storm, growth]  # the time of year is there already


def test_ground_of_unknown_start_is_explained_exactly(rng: np.random.Generator) -> None:
    """What follows the air since long before a baseline is the column from no start, and what settles.

    The recursion is linear in its state: x(t) = x₀(t) + x(0) exp(−t/τ) for any times of records.
    """
    days = np.sort(rng.uniform(0.0, 600.0, 900))
    h = rows(days, air_temperature_c=10.0 - 7.0 * np.cos(2.0 * np.pi * days / 365.0))
    part, ever = h.between(400.0, 600.0), h.between(0.0, 600.0)
    design = with_slow_processes(design_of(part), part)
    columns = design.columns
    ground = [c.lag_days for c in columns].index(GROUND_DAYS)
    settling = next(k for k, c in enumerate(columns) if c.shape == "settling")
    assert columns[settling].scale == GROUND_DAYS
    long_before = regressors(design, ever, fresh(design))[0][days >= 400.0, 1 + ground]
    x = regressors(design, part, fresh(design, part))[0][:, [1 + ground, 1 + settling]]
    np.testing.assert_allclose(x @ [1.0, long_before[0]], long_before, atol=1e-12)
    assert np.abs(long_before[0]) > 0.5  # the start matters


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
