"""Series that step are told from series that drift or scatter."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.records.clocks.jumps import lines, runs, scatter, series_jumps


def test_a_series_that_returns_after_a_run_of_windows_tells_no_jump() -> None:
    """Twice in fifteen setups of a steel frame a clock was said to jump by 0.0215 s and, later, back."""
    levels = np.repeat([[0.0, 0.0], [0.0215, 0.0], [0.0002, 0.0]], [9, 4, 7], axis=0)
    series = levels + 1e-4 * np.random.default_rng(1).standard_normal(levels.shape)
    assert series_jumps(series, runs(series, 0.005), 0.005) == []
    series[13:] += [0.02, 0.0]
    (jump,) = series_jumps(series, runs(series, 0.005), 0.005)
    assert (jump.rows, jump.before, jump.after) == ((0,), 9, 9)


def test_noise_and_drift_are_no_steps(rng: np.random.Generator) -> None:
    time = np.arange(12.0)[:, None]
    for _ in range(100):
        series = 0.01 * rng.standard_normal((12, 3)) + time * rng.normal(size=3)
        # six standard deviations of a scatter that is itself known from ten steps
        assert len(runs(series, 0.08)) == 1


def test_a_step_is_found_where_it_is(rng: np.random.Generator) -> None:
    series = 0.01 * rng.standard_normal((12, 3))
    series[7:, 1] += 0.5
    found = runs(series, 0.08)
    assert found == [(0, 7), (7, 12)]
    (step,) = series_jumps(series, found, 0.08)
    assert (step.rows, step.before, step.after) == ((1,), 7, 7)
    # a mean of five of 0.01
    assert step.by[1] == pytest.approx(0.5, abs=0.02)


def test_the_window_a_step_lies_in_belongs_to_neither_side(rng: np.random.Generator) -> None:
    series = 0.01 * rng.standard_normal((12, 1))
    series[6] += 0.25
    series[7:] += 0.5
    (step,) = series_jumps(series, runs(series, 0.08), 0.08)
    assert (step.before, step.after) == (6, 7)


def test_slope_and_scatter(rng: np.random.Generator) -> None:
    series = np.arange(400.0)[:, None] * 0.3 + rng.standard_normal((400, 1))
    # 1/√(n³/12) for the slope; 1.2/√n for a median absolute deviation
    assert lines(series)[0] == pytest.approx(0.3, abs=0.002)
    assert scatter(series) == pytest.approx(1.0, abs=0.25)


def test_a_series_that_jumps_back_for_a_window_tells_nothing():
    series = np.repeat([[0.0], [1.0]], [4, 8], axis=0)
    (step,) = series_jumps(series, runs(series, 0.1), 0.1)
    assert step.rows == (0,)
    series[8] = 0.0
    assert series_jumps(series, runs(series, 0.1), 0.1) == []
    # elsewhere is a window that was misread
    series[8] = 3.0
    assert [step.rows for step in series_jumps(series, runs(series, 0.1), 0.1)] == [(0,)]
