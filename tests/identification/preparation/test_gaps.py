"""Gaps of single channels: predicted where the others know, left alone where they do not."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from jackettwin.identification import identify
from jackettwin.identification.preparation.gaps import fill
from jackettwin.records import read_record

RECORD = files("jackettwin") / "data" / "records" / "pile_U12_s301.parquet"


@pytest.fixture
def sources(rng):
    return rng.standard_normal((3, 4000))


def test_nothing_is_done_without_gaps(sources):
    assert fill(sources) is sources


def test_what_the_others_determine_is_recovered_exactly(sources):
    """A filtered sum of two others: five samples reach far enough, so the prediction is exact."""
    y = sources.copy()
    y[2] = 0.5 * np.roll(y[0], 2) - y[1] + 0.3 * np.roll(y[1], -4)
    whole = y.copy()
    y[2, 1000:1200] = np.nan
    y[0, 2500:2600] = np.nan
    # the ridge of 1e-9 leaves an error of its own size
    np.testing.assert_allclose(fill(y)[2], whole[2], atol=1e-6)


def test_two_silent_channels_are_predicted_from_the_third(sources):
    y = np.array([sources[0], 2.0 * sources[0], -sources[0], 3.0 * sources[0]])
    whole = y.copy()
    y[0, 900:1100] = np.nan
    y[1, 1000:1200] = np.nan
    np.testing.assert_allclose(fill(y), whole, atol=1e-6)


def test_a_channel_the_others_do_not_know_keeps_its_gap(sources):
    sources[0, 100:200] = np.nan
    assert np.array_equal(np.isnan(fill(sources)), np.isnan(sources))


def test_a_gap_in_all_channels_stays(sources):
    y = np.array([sources[0], 2.0 * sources[0]])
    y[:, 700:800] = np.nan
    y[0, 2000:2100] = np.nan
    out = fill(y)
    assert np.isnan(out[:, 700:800]).all()
    assert np.isfinite(out[:, 800:]).all()


def test_too_few_complete_instants_leave_the_gaps(rng):
    y = np.outer([1.0, 2.0], rng.standard_normal(60))
    y[0, ::3] = np.nan
    y[1, 1::3] = np.nan
    assert np.array_equal(np.isnan(fill(y)), np.isnan(y))


@pytest.mark.parametrize("seed", [0, 5])
def test_half_a_minute_lost_in_every_channel_moves_no_mode_by_its_uncertainty(seed):
    """Five per cent of every channel at its own time, in a record whose first pair is 0.6 % apart.

    By covariances of pairs alone, seed 5 loses the mode at 0.744 Hz.
    """
    record = read_record(str(RECORD))
    rng = np.random.default_rng(seed)
    y = record.data.copy()
    for row in y:
        start = rng.integers(0, y.shape[1] - 3000)
        row[start : start + 3000] = np.nan
    whole, gappy = identify(record), identify(replace(record, data=y))
    assert any("predicted from the other channels" in text for text in gappy.warnings)
    for mode in (m for m in whole.modes if m.frequency_hz < 0.8):
        f = [abs(m.frequency_hz - mode.frequency_hz) / mode.frequency_std_hz for m in gappy.modes]
        zeta = [abs(m.damping_ratio - mode.damping_ratio) / mode.damping_ratio_std for m in gappy.modes]
        assert min(np.maximum(f, zeta)) < 1.0
