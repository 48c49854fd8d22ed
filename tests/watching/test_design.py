"""Regressors: what stands for a temperature that nobody told, and what a model knows of a condition."""

import numpy as np
import pytest

from jackettwin.watching import History, Slope
from jackettwin.watching.design import design_of, fresh, regressors


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
