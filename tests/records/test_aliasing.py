"""Records sampled without a filter are told from filtered ones, whatever the rate."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import signal

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.identification.record_steps import moving_channels
from jackettwin.records import Record, assess, read_record
from jackettwin.records.quality.aliasing import not_filtered

RECORD = Path(str(files("jackettwin"))) / "data/records/pile_U12_s301.parquet"


def flagged(record: Record) -> str:
    """Return the channels that are said to be unfiltered."""
    return ", ".join(f.params["channels"] for f in assess(record).findings if f.code == "not_filtered")


@pytest.mark.parametrize("times", [20, 40])
def test_every_twentieth_sample_of_a_turbine_is_flagged_unless_filtered(times: int) -> None:
    """OpenFAST at 100 Hz moves up to 5 Hz: at 5 and 2.5 Hz that is folded."""
    record = moving_channels(read_record(RECORD))
    assert flagged(record) == ""
    rate = record.sample_rate_hz / times
    raw = replace(record, data=record.data[:, ::times], sample_rate_hz=rate)
    assert "acc_g77_x" in flagged(raw)
    # Chebyshev of order 8 up to 0.8 of the new half rate, forwards and backwards
    low = signal.decimate(signal.decimate(record.data, 10, axis=1), times // 10, axis=1)
    assert flagged(replace(record, data=low, sample_rate_hz=rate)) == ""


def test_a_mode_that_is_folded_is_flagged(tower: SimpleNamespace) -> None:
    """A mode of 7 Hz shows at 3 Hz in every second sample of 20 Hz; in all of them it stands where it is."""
    record = tower.record(3)
    far = tower.oscillator(np.random.default_rng(1).normal(size=24_000), 7.0, 0.01, 20.0)[12_000:]
    moved = replace(record, data=record.data + 0.3 * record.data.std() / far.std() * far)
    assert "acc_144_x" in flagged(replace(moved, data=moved.data[:, ::2], sample_rate_hz=10.0))
    low = signal.decimate(moved.data, 2, axis=1)
    assert flagged(replace(moved, data=low, sample_rate_hz=10.0)) == ""


def test_a_filter_that_ends_at_half_the_rate_is_a_filter(tower: SimpleNamespace) -> None:
    """``resample_poly`` passes half the power at the new Nyquist frequency, where the rest is folded.

    A mode at 3 Hz is not doubted then; in every second sample of the same record it may be one at 7 Hz.
    """
    record = tower.record(3)
    rng = np.random.default_rng(1)
    far = tower.oscillator(rng.normal(size=24_000), 3.0, 0.01, 20.0)[12_000:]
    white = record.data.std() * rng.standard_normal(record.data.shape)
    moved = record.data + record.data.std() / far.std() * far + white
    low = signal.resample_poly(moved, 1, 2, axis=1)
    assert flagged(replace(record, data=low, sample_rate_hz=10.0)) == ""
    assert flagged(replace(record, data=moved[:, ::2], sample_rate_hz=10.0)) != ""


def test_noise_and_motion_under_white_forces_are_not_flagged(tower: SimpleNamespace) -> None:
    for seed in range(20):
        y = tower.record(seed, noise=0.1).data
        assert not not_filtered(y)[0].any()
        assert not not_filtered(y[:, ::2])[0].any()


def test_gaps_spikes_and_repeats_are_not_taken_for_folding(tower: SimpleNamespace) -> None:
    record, rng = tower.record(5), np.random.default_rng(2)
    lost = np.where(rng.random(record.data.shape) < 0.1, np.nan, record.data)
    assert flagged(replace(record, data=lost)) == ""
    struck = np.where(rng.random(record.data.shape) < 0.002, 30.0 * record.data.std(), record.data)
    assert flagged(replace(record, data=struck)) == ""


def test_a_folded_peak_is_said_where_it_is(tower: SimpleNamespace) -> None:
    """A mode of 7.8 Hz at 10 Hz shows at 2.2 Hz, which is not near 5 Hz."""
    record = tower.record(3)
    far = tower.oscillator(np.random.default_rng(1).normal(size=24_000), 7.8, 0.01, 20.0)[12_000:]
    moved = replace(record, data=record.data + 0.3 * record.data.std() / far.std() * far)
    findings = assess(replace(moved, data=moved.data[:, ::2], sample_rate_hz=10.0)).findings
    (found,) = (f for f in findings if f.code == "not_filtered")
    assert abs(found.params["peak_hz"] - 2.2) < 0.1 and found.params["half_hz"] == 5.0
    assert "has a peak at 2.2" in found.text and "near" not in found.text


def test_a_folded_mode_is_doubted_and_what_lies_lower_is_not(tower: SimpleNamespace) -> None:
    """The same mode of 7.8 Hz; filtered before every second sample is taken, nothing is doubted for it."""
    record = tower.record(3)
    far = tower.oscillator(np.random.default_rng(1).normal(size=24_000), 7.8, 0.01, 20.0)[12_000:]
    moved = replace(record, data=record.data + 0.3 * record.data.std() / far.std() * far)

    def doubts(y: np.ndarray) -> list[float]:
        found = examine(replace(moved, data=y, sample_rate_hz=10.0), IdentificationSettings()).identification
        said = [m for m in found.modes if "may_be_folded" in [r.code for r in m.reasons]]
        assert any(m.status == "ok" and m.frequency_hz < 2.0 for m in found.modes)
        return [m.frequency_hz for m in said]

    folded = doubts(moved.data[:, ::2])
    assert any(abs(f - 2.2) < 0.05 for f in folded) and min(folded) > 2.0
    assert doubts(signal.decimate(moved.data, 2, axis=1)) == []
