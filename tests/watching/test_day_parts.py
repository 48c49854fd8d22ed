"""Days within which something changed, and days within which nothing did."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.watching import History, start, step
from jackettwin.watching.day_parts import divided

from .conftest import made

STD = 0.004


def day(rng: np.random.Generator, n: int = 24, step: float = 0.0, at: int = 12) -> np.ndarray:
    rest = STD * rng.standard_normal((n, 4))
    rest[at:] += step
    return rest


def variance(n: int = 24) -> np.ndarray:
    return np.full((n, 4), STD**2)


@pytest.mark.parametrize("at", [3, 10, 21])
def test_a_day_is_divided_where_it_changed(rng: np.random.Generator, at: int) -> None:
    rest = day(rng, step=-0.03, at=at)
    rest[1, 2] = np.nan
    assert divided(rest, variance()) == (at, 19)


def test_quiet_days_and_single_outliers_are_whole(rng: np.random.Generator) -> None:
    """Chance divides fewer than one of a thousand days, two outliers none; binomial limits at 0.001."""
    assert sum(divided(day(rng), variance()) is not None for _ in range(1000)) <= 5
    for _ in range(50):
        rest = day(rng)
        rest[[20, 23], 1] += 0.06
        assert divided(rest, variance()) is None


@pytest.mark.parametrize("rows", [[-3, -2], [-2, -1], [0, 1]])
def test_two_outliers_of_a_mode_are_no_part_of_a_day(rng: np.random.Generator, rows: list[int]) -> None:
    """Two of the last three records made a part of their own, and a step of 31 standard deviations in it."""
    rest = day(rng)
    rest[rows, 1] -= [0.02, 0.06]
    assert divided(rest, variance()) is None


def test_too_few_records_and_none_at_all_are_whole(rng: np.random.Generator) -> None:
    assert divided(day(rng, 5, -0.05, 2), variance(5)) is None
    assert divided(np.full((24, 4), np.nan), variance()) is None
    assert divided(np.zeros((24, 4)), np.zeros((24, 4))) is None


def spells(seed: int, size: float) -> History:
    """Return two modes, a spell of 24 records on each fourth day; both change within that of day 120."""
    base = made(seed=seed, days=160)
    rng = np.random.default_rng((8, seed))
    at = (np.arange(0.0, 160.0, 4.0)[:, None] + 0.3 + np.arange(24) / 144.0).ravel()
    near = np.searchsorted(base.days, at) - 1
    rows = replace(
        base,
        **{
            name: getattr(base, name)[near]
            for name in ("frequency_std", "damping_std", "conditions", "states")
        },
    )
    noise = 0.002 * rng.standard_normal((at.size, 2)) + size * (at >= 120.38)[:, None]
    zeta = 0.01 * np.exp(0.2 * rng.standard_normal((at.size, 2)))
    return replace(rows, days=at, frequency=np.array([0.3, 0.31]) * np.exp(noise), damping=zeta)


@pytest.mark.parametrize("seed", range(3))
def test_a_large_change_within_a_spell_is_found_at_once_with_its_size_and_hour(seed: int) -> None:
    history = spells(seed, -0.03)
    watch = start(history.between(0.0, 100.0))
    for one in history.between(100.0, np.inf).by_day():
        watch, look = step(watch, one)
        if look.change is not None:
            break
    change = look.change
    assert change is not None and np.floor(change.day) == 120.0 and change.kind == "frequency"
    low, high = change.began_interval_90
    assert 120.3 < low <= 120.38 <= high < 120.5
    assert np.all(np.abs(change.size[:2] + 0.03) < 4.0 * change.size_std[:2])
    assert np.all(change.log_scatter[-1, :2].max(axis=1) < 5.0)
