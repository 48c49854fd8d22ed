"""Channels of other rates than their record: held values and blanks are undone, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.records import Channel, Record
from jackettwin.records.quality.repeats import each_sample_once

CHANNELS = tuple(Channel(name, unit="m/s^2") for name in "ab")


def motion(t: np.ndarray) -> np.ndarray:
    """Two sinusoids, the faster one at a quarter of the slow channel's rate."""
    return np.sin(2.0 * np.pi * 0.3 * t) + 0.5 * np.cos(2.0 * np.pi * 2.5 * t) + 3.0


def test_blanks_between_the_samples_of_a_slower_logger_are_filled_with_its_motion() -> None:
    """Every fifth sample from the third on, one of them lost: what is filled in is the motion, not a line."""
    t = np.arange(3000) / 50.0
    slow = np.full(t.size, np.nan)
    slow[2::5] = motion(t)[2::5]
    slow[1002] = np.nan
    found, findings = each_sample_once(Record(np.array([motion(t), slow]), 50.0, CHANNELS))
    assert [(f.code, f.subject) for f in findings] == [("blanks_filled", "b")]
    np.testing.assert_array_equal(found.data[0], motion(t))
    # the filter's ripple and its transition; a straight line between samples would be off by 0.15
    inside = slice(100, -100)
    error = found.data[1, inside] - motion(t)[inside]
    assert np.nanstd(error) < 0.02
    assert np.isnan(found.data[1, :2]).all()
    assert np.isnan(found.data[1, 998:1007]).all()
    assert np.isnan(error).sum() == 9


def test_a_channel_with_gaps_is_no_slower_one(rng: np.random.Generator) -> None:
    y = rng.standard_normal((2, 3000))
    y[1, rng.random(3000) < 0.8] = np.nan
    record = Record(y, 50.0, CHANNELS)
    assert each_sample_once(record) == (record, ())


def test_a_record_held_to_another_rate_has_no_images() -> None:
    """Two modes of ten minutes; images of a 4 Hz record were modes at 0.69, 2.69 and 2.76 Hz."""
    rng, rate_hz = np.random.default_rng(5), 4.0
    n = int(620 * rate_hz)
    t = np.arange(n) / rate_hz
    decay = [
        np.exp(-0.01 * 2.0 * np.pi * f * t[:400]) * np.sin(2.0 * np.pi * f * t[:400]) for f in (0.3, 1.25)
    ]
    x, y = (np.convolve(rng.standard_normal(n), h)[:n] for h in decay)
    slow = np.array([x + 0.5 * y, 0.6 * x - y])
    slow += 0.02 * rng.standard_normal(slow.shape)
    held = slow[:, (np.arange(30_000) * rate_hz / 50.0).astype(int)]
    seen = examine(Record(held, 50.0, CHANNELS), IdentificationSettings())
    assert seen.record.sample_rate_hz == pytest.approx(rate_hz, rel=1e-4)
    assert "resampled_by_holding" in [f.code for f in seen.identification.findings]
    found = [m.frequency_hz for m in seen.identification.modes]
    # two standard deviations of a mode of 1 % in ten minutes
    assert found == pytest.approx([0.3, 1.25], rel=0.006)
