from __future__ import annotations

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records.clocks.grid import between_ticks, regularise, without_hours


def test_perfect_stamps_change_nothing(rng: np.random.Generator) -> None:
    y = rng.normal(size=(2, 500))
    out, clock = regularise(3.0 + np.arange(500) / 64.0, y)
    assert np.array_equal(out, y)
    assert (clock.sample_rate_hz, clock.missing, clock.disordered) == (64.0, 0, 0)
    assert clock.jitter_s < 1e-12  # rounding of 10 s in float64


def test_rounded_stamps_give_the_true_rate(rng: np.random.Generator) -> None:
    t = np.round(np.arange(5000) / 62.5, 3)  # steps of 16 ms, written to the millisecond
    _, clock = regularise(t, np.zeros((1, 5000)))
    assert clock.sample_rate_hz == 62.5


def test_lost_samples_become_gaps_at_their_place(rng: np.random.Generator) -> None:
    t, y = np.arange(1000) / 20.0, rng.normal(size=(1, 1000))
    kept = np.sort(rng.choice(np.arange(1, 999), 900, replace=False))
    out, clock = regularise(t[kept], y[:, kept])
    first, last = kept[0], kept[-1]
    assert out.shape[1] == last - first + 1
    np.testing.assert_array_equal(out[0, kept - first], y[0, kept])
    assert clock.missing == np.isnan(out).sum() == out.shape[1] - 900


def test_jitter_is_interpolated_away(rng: np.random.Generator) -> None:
    n, rate, f = 12_000, 20.0, 0.18
    t = np.arange(n) / rate + rng.normal(scale=0.2 / rate, size=n)
    t = np.sort(t)
    y = np.sin(2 * np.pi * f * t)[None, :]
    out, clock = regularise(t, y, sample_rate_hz=rate)
    assert clock.jitter_s == pytest.approx(0.2 / rate, rel=0.1)
    grid = np.arange(out.shape[1]) / rate
    # linear interpolation over a step: (2πf·Δt)²/8 = 4e-4, a few times that over stretched steps;
    # the start of the grid is known to a jitter divided by √n
    error = out[0] - np.sin(2 * np.pi * f * grid)
    assert np.nanmax(np.abs(error)) < 5e-3
    assert np.isnan(out).mean() < 0.1


def test_jitter_of_half_a_step_leaves_no_gaps_where_no_stamp_is_lost(rng: np.random.Generator) -> None:
    """One of seven samples was lost at steps longer than one and a half."""
    t = (np.arange(6000) + rng.uniform(-0.4, 0.4, 6000)) / 20.0
    out, clock = regularise(t, np.sin(t)[None, :])
    assert np.isfinite(out).all() and clock.missing == 0
    kept = np.delete(np.arange(6000), [50, 51, 52, 2000, 2001, 2002])
    assert np.isnan(regularise(t[kept], np.sin(t[kept])[None, :])[0]).sum() >= 6


@pytest.mark.parametrize(
    ("gap_s", "closed"), [(3600.0, True), (7200.0, True), (3599.0, False), (2400.0, False)]
)
def test_a_clock_put_on_by_full_hours_loses_no_samples(gap_s: float, closed: bool) -> None:
    t = np.arange(600) / 20.0
    shown, put_on = without_hours(np.where(t < 20.0, t, t + gap_s))
    assert (put_on is not None) == closed
    if closed:
        np.testing.assert_allclose(shown, t, atol=1e-9)
        assert put_on == (pytest.approx(19.95), gap_s)
    # a logger that is on for ten seconds of every hour
    assert without_hours(np.concatenate([t[:200], t[:200] + 3610.0, t[:200] + 7220.0]))[1] is None


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([0.0, 0.1, 0.1, 0.1, 0.2], "do not increase"),
        ([0.3, 0.2, 0.1, 0.0], "do not increase"),
        ([np.nan, np.nan, 0.0], "do not increase"),
        ([0.0, 0.1, 0.2, 1e9, 1e9 + 0.1], "stamps jump"),
    ],
)
def test_bad_stamps_are_refused(times: list[float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        regularise(np.array(times), np.zeros((1, len(times))))


@pytest.mark.parametrize("shared", [20, 2])
def test_stamps_of_full_seconds_are_spread_over_the_samples_that_share_them(
    shared: int, rng: np.random.Generator
) -> None:
    """A stamp is that of the second in which a sample was stored, now and then a sample late."""
    late = rng.integers(0, 2, 600 * shared) if shared > 2 else 0
    stamps = np.floor((np.arange(600 * shared) + 0.7 + 0.9 * late) / shared)
    spread = between_ticks(np.maximum.accumulate(stamps))
    assert spread is not None
    assert np.ptp(spread - np.arange(600 * shared) / shared) < 1e-9


def test_stamps_that_stand_still_for_a_while_are_no_ticks() -> None:
    stamps = np.arange(600.0)
    stamps[100:140] = 100.0
    assert between_ticks(stamps) is None
    assert between_ticks(np.repeat(np.arange(5.0), 20)) is None


def test_a_stated_rate_must_agree_with_the_stamps() -> None:
    with pytest.raises(InputError, match=r"contradicts.*got 25.*allowed: 20"):
        regularise(np.arange(100) / 20.0, np.zeros((1, 100)), sample_rate_hz=25.0)


def test_loggers_of_two_rates_in_one_table_are_each_interpolated_by_their_own_samples() -> None:
    """20 and 25 Hz, the second from 60 s on: where it has no samples there are none."""
    a, b = np.arange(4000) / 20.0, 60.0 + np.arange(3000) / 25.0
    t = np.unique(np.round(np.concatenate([a, b]), 4))
    y = np.full((2, t.size), np.nan)
    for row, own in zip(y, (a, b), strict=True):
        row[np.searchsorted(t, np.round(own, 4))] = np.sin(2.0 * np.pi * 0.3 * own)
    out, clock = regularise(t, y)
    grid = np.arange(out.shape[1]) / clock.sample_rate_hz
    # (ωΔt)²/8 of a straight line between samples, and the last step of the rate; 1.5 steps beyond the ends
    inside = np.isfinite(out)
    assert np.abs(out - np.sin(2.0 * np.pi * 0.3 * grid))[inside].max() < 0.1
    assert np.std((out - np.sin(2.0 * np.pi * 0.3 * grid))[inside]) < 0.01
    assert not inside[1, grid < 59.9].any()
    assert inside[1, (grid > 60.0) & (grid < 179.9)].all()
    assert inside[0, grid < 199.9].all()
