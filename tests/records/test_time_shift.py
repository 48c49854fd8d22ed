"""Samples read between the samples: exact for a shift, as good as the spline for a drift."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.records.clocks.correction import PAD, shifted_earlier


def signal(t: np.ndarray) -> np.ndarray:
    """Return a sum of waves up to a quarter of the Nyquist frequency, an offset and a slope."""
    rng = np.random.default_rng(3)
    f, phase = rng.uniform(0.005, 0.12, 20), rng.uniform(0.0, 2.0 * np.pi, 20)
    return np.sin(2.0 * np.pi * np.outer(t, f) + phase).sum(axis=1) + 5.0 + 0.01 * t


@pytest.mark.parametrize("delay", [0.0, 0.37, 20.0, -3.6])
def test_a_delay_is_taken_back(delay: float) -> None:
    t = np.arange(4000.0)
    ready = shifted_earlier(signal(t - delay), delay)
    inside = slice(PAD, -PAD)
    # point reflection bends the ends, and what that does falls as one over the distance
    np.testing.assert_allclose(ready[inside], signal(t)[inside], atol=0.02)
    assert np.isnan(ready).sum() == int(np.ceil(abs(delay)))


def test_a_clock_that_is_too_fast_is_slowed_down() -> None:
    t, growth = np.arange(4000.0), 5e-4
    # what is read at t was there at t − d − g·t', with t' the time it is wanted for
    read = signal((t - 1.5) / (1.0 + growth))
    ready = shifted_earlier(read, 1.5, growth)
    np.testing.assert_allclose(ready[PAD:-PAD], signal(t)[PAD:-PAD], atol=0.02)


def test_a_clock_whose_rate_changes_is_straightened() -> None:
    t, growth, bend = np.arange(4000.0), 5e-4, -2e-7
    at = np.interp(t, t + 1.5 + growth * t + bend * t**2, t)
    ready = shifted_earlier(signal(at), 1.5, growth, bend)
    np.testing.assert_allclose(ready[PAD:-PAD], signal(t)[PAD:-PAD], atol=0.02)


def test_gaps_stay_gaps() -> None:
    t = np.arange(1000.0)
    late = signal(t - 10.5)
    late[500:520] = np.nan
    missing = np.flatnonzero(np.isnan(shifted_earlier(late, 10.5)))
    assert missing[:21].tolist() == list(range(489, 510))
    assert missing[21:].tolist() == list(range(989, 1000))
