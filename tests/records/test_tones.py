"""A tone of known phase goes; a constant, gaps and everything else stay."""

import numpy as np
import pytest

from jackettwin.records.processing.tones import less_phase


def test_a_drifting_tone_goes_and_the_rest_stays(rng: np.random.Generator) -> None:
    t = np.arange(6000) / 10.0
    phase = 2.0 * np.pi * (0.5 * t + 1e-4 * t**2)
    rest = 3.0 + rng.standard_normal((2, len(t)))
    y = rest + np.array([[2.0], [0.5]]) * np.cos(phase + 0.7)
    y[0, 1000:1500] = np.nan
    left = less_phase(y, phase)
    assert np.array_equal(np.isnan(left), np.isnan(y))
    # what white noise of unit variance lends to three unknowns: 3 / 5500 of its power, four times that
    assert np.nanmean((left - rest) ** 2) < 12.0 / 5500.0
    assert np.nanmean(left[0]) == pytest.approx(3.0, abs=0.06)


def test_a_channel_with_hardly_a_sample_stays() -> None:
    y = np.full((1, 100), np.nan)
    y[0, :5] = 1.0
    np.testing.assert_array_equal(less_phase(y, np.arange(100.0)), y)
