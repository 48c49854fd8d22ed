from __future__ import annotations

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record, assess, repair
from jackettwin.records.quality.record_quality import Quality


def faults_of(quality: Quality) -> set[tuple[str | None, str]]:
    return {(finding.subject, finding.code) for finding in quality.findings}


def with_row(record: Record, i: int, row: np.ndarray) -> Record:
    data = record.data.copy()
    data[i] = row
    return replace(record, data=data)


def test_clean_records_have_no_findings(tower: SimpleNamespace) -> None:
    """40 ten-minute records of 8 channels: a false alarm in one of them would be 3 in 1000 channels."""
    for seed in range(40):
        quality = assess(tower.record(seed))
        assert not quality.findings, quality.findings
        assert quality.score == 1.0


def test_gaps_are_measured_and_kept(tower: SimpleNamespace) -> None:
    record = tower.record(1)
    row = record.data[2].copy()
    row[100:220] = np.nan
    row[5000:5600:10] = np.nan
    holed = with_row(record, 2, row)
    quality = assess(holed)
    assert faults_of(quality) == {("acc_41_x", "gaps")}
    assert quality.channels[2].gap_share == pytest.approx(180 / 12_000)
    assert quality.channels[2].longest_gap_s == pytest.approx(6.0)
    assert np.array_equal(repair(holed, quality).data, holed.data, equal_nan=True)


def test_spikes_become_missing_samples(tower: SimpleNamespace) -> None:
    record = tower.record(2)
    row = record.data[0].copy()
    at = np.arange(50, 12_000, 400)
    row[at] += 15.0 * row.std()
    spiked = with_row(record, 0, row)
    quality = assess(spiked)
    assert faults_of(quality) == {("acc_144_x", "spikes")}
    clean = repair(spiked, quality)
    assert np.array_equal(np.flatnonzero(np.isnan(clean.data[0])), at)
    assert clean.metadata["repair"] == ["acc_144_x: 0.250% of the samples are spikes; declared missing"]


def test_a_signal_full_of_outliers_is_kept(rng: np.random.Generator, tower: SimpleNamespace) -> None:
    record = tower.record(3)
    row = record.data[0] + 20 * record.data[0].std() * (rng.random(12_000) < 0.05)
    quality = assess(with_row(record, 0, row))
    assert ("acc_144_x", "outliers") in faults_of(quality)
    assert not quality.suspect.any()


def test_frozen_stretches_become_missing_and_clipped_ones_are_kept(tower: SimpleNamespace) -> None:
    record = tower.record(4)
    level = 1.5 * record.data[1].std()
    row = np.clip(record.data[1], -level, level)
    row[3000:3500] = row[3000]
    quality = assess(with_row(record, 1, row))
    assert faults_of(quality) == {("acc_77_x", "clipped"), ("acc_77_x", "stuck")}
    repaired = repair(with_row(record, 1, row), quality).data[1]
    assert np.flatnonzero(np.isnan(repaired)).tolist() == list(range(3000, 3500))
    assert np.nanmax(np.abs(repaired)) == level


@pytest.mark.parametrize("value", [0.0, 9.81, np.nan])
def test_dead_channels_are_dropped(value: float, tower: SimpleNamespace) -> None:
    record = with_row(tower.record(5), 3, np.full(12_000, value))
    quality = assess(record)
    assert faults_of(quality) == {("acc_28_x", "empty" if np.isnan(value) else "dead")}
    assert quality.channels[3].score == 0.0
    assert "acc_28_x" not in repair(record, quality).channel_names


def test_drift_is_removed_and_the_vibration_left(tower: SimpleNamespace) -> None:
    record = tower.record(6)
    slope = np.linspace(0.0, 20.0 * record.data[4].std(), 12_000)
    drifting = with_row(record, 4, record.data[4] + slope)
    quality = assess(drifting)
    assert faults_of(quality) == {("acc_144_y", "drift")}
    left = repair(drifting, quality).data[4] - record.data[4]
    # the middle half: ends of a moving mean are one-sided
    assert np.abs(left[3000:9000]).max() < 0.1 * record.data[4].std()


@pytest.mark.parametrize("i", range(8))
def test_a_swapped_sign_is_found_and_turned_back(i: int, tower: SimpleNamespace) -> None:
    """In every one of 8 channels of 5 records, second bending mode included."""
    for seed in range(5):
        record = tower.record(seed)
        reversed_channels = with_row(record, i, -record.data[i])
        quality = assess(reversed_channels)
        assert faults_of(quality) == {(record.channels[i].name, "sign_turned")}
        assert np.array_equal(repair(reversed_channels, quality).data, record.data)


def test_a_sensor_mounted_backwards_and_described_so_is_sound(tower: SimpleNamespace) -> None:
    record = tower.record(7)
    backwards = replace(record.channels[0], direction=(-1.0, 0.0, 0.0))
    turned = replace(with_row(record, 0, -record.data[0]), channels=(backwards, *record.channels[1:]))
    assert not assess(turned).findings


def test_with_two_sensors_nobody_knows_which_is_wrong(tower: SimpleNamespace) -> None:
    record = tower.record(8).select(["acc_144_x", "acc_77_x"])
    reversed_channels = with_row(record, 0, -record.data[0])
    quality = assess(reversed_channels)
    assert len(quality.findings) == 1 and quality.findings[0].code == "sign_unclear"
    assert not quality.findings[0].repaired
    assert np.array_equal(repair(reversed_channels, quality).data, reversed_channels.data)


def test_strong_second_bending_is_no_swapped_sign(tower: SimpleNamespace) -> None:
    """Top and middle move against each other by nature; the first mode is there to tell."""
    record = tower.record(9)
    rng = np.random.default_rng(9)
    second = tower.oscillator(rng.normal(size=24_000), 0.76, 0.02, 20.0)[12_000:]
    strong = record.data[:4] + 5.0 * np.outer(tower.shapes[1], second)
    data = np.vstack([strong, record.data[4:]])
    assert not assess(replace(record, data=data)).findings


def test_a_slower_sensor_is_recognised(tower: SimpleNamespace) -> None:
    record = tower.record(10)
    quality = assess(with_row(record, 5, np.repeat(record.data[5][::4], 4)))
    # a reading is half of three steps old on the average
    assert faults_of(quality) == {("acc_77_y", "held"), (None, "clock_late")}
    assert quality.clocks.late[0].delay_s == pytest.approx(1.5 / 20.0, rel=0.1)
    assert quality.channels[5].hold_length == 4


def test_a_wrong_unit_shows_as_a_weak_sensor(tower: SimpleNamespace) -> None:
    record = tower.record(11)
    quality = assess(with_row(record, 6, 1e-6 * record.data[6]))
    assert ("acc_41_y", "weak") in faults_of(quality)


def test_the_clock_of_the_file_is_reported(tower: SimpleNamespace) -> None:
    clock = {"jitter_s": 0.02, "missing": 7, "disordered": 2}
    record = replace(tower.record(12), metadata={"clock": clock})
    texts = [finding.text for finding in assess(record).findings]
    assert [text.split()[0] for text in texts] == ["time", "7", "2"]


def test_steady_wind_and_yaw_are_not_dead(tower: SimpleNamespace) -> None:
    record = tower.record(13)
    channels = (*record.channels[:7], replace(record.channels[7], quantity="yaw", unit="rad"))
    assert not assess(replace(with_row(record, 7, np.zeros(12_000)), channels=channels)).findings


def test_a_record_that_is_not_stationary_is_flagged(tower: SimpleNamespace) -> None:
    record = tower.record(16)
    grown = replace(record, data=record.data * np.exp(np.linspace(0.0, 8.0, record.data.shape[1])))
    assert {f.code for f in assess(grown).findings} >= {"unsteady"}
    assert "unsteady" not in {f.code for f in assess(record).findings}


def test_a_blow_that_rings_down_is_not_stationary(tower: SimpleNamespace) -> None:
    """A ship's impact of twenty times the rms, in a mode that forgets it in ninety seconds."""
    record = tower.record(15)
    t = np.arange(12_000) / 20.0 - 200.0
    ringing = np.where(t > 0.0, np.exp(-t / 90.0) * np.sin(2.0 * np.pi * 0.178 * t), 0.0)
    struck = replace(record, data=record.data + 20.0 * record.data.std(axis=1, keepdims=True) * ringing)
    assert {f.code for f in assess(struck).findings} == {"unsteady"}


def test_faults_lower_the_score(tower: SimpleNamespace) -> None:
    record = tower.record(14)
    row = record.data[0].copy()
    row[:1200] = np.nan
    assert assess(with_row(record, 0, row)).score == pytest.approx(1.0 - 0.1 / 8)


def test_a_record_without_any_live_channel_is_refused(tower: SimpleNamespace) -> None:
    record = tower.record(15)
    dead = replace(record, data=np.zeros_like(record.data))
    with pytest.raises(InputError, match=r"channels: no channel carries a signal.*acc_144_x"):
        repair(dead, assess(dead))


def test_quality_of_another_record_is_refused(tower: SimpleNamespace) -> None:
    quality = assess(tower.record(1, duration_s=60.0))
    with pytest.raises(InputError, match="quality is of another record"):
        repair(tower.record(1), quality)


def test_summary_is_plain_json_data(tower: SimpleNamespace) -> None:
    text = json.dumps(assess(tower.record(16)).summary(), allow_nan=False)
    assert json.loads(text)["score"] == 1.0


def test_a_step_of_the_rms_is_coarse_and_one_of_a_tenth_is_not(tower: SimpleNamespace) -> None:
    record = tower.record(13)
    y = record.data[3]
    for step, coarse in ((1.0, True), (0.1, False)):
        size = step * y.std()
        found = assess(with_row(record, 3, size * np.round(y / size)))
        assert ("acc_28_x", "coarse_quantiser") in faults_of(found) if coarse else not found.findings


@pytest.mark.parametrize("noise_alone", [False, True])
def test_a_channel_of_a_thousandth_is_flagged_on_either_axis(
    noise_alone: bool, tower: SimpleNamespace
) -> None:
    """One axis moves four times as strongly as the other, as across and along the wind."""
    record = tower.record(2)
    data = record.data * np.repeat([1.0, 4.0], 4)[:, None]
    assert not any(code in ("weak", "strong") for _, code in faults_of(assess(replace(record, data=data))))
    rng = np.random.default_rng(1)
    for i in (0, 3, 4, 7):
        row = data[i]
        small = 1e-3 * (row.std() * rng.normal(size=len(row)) if noise_alone else row)
        found = faults_of(assess(with_row(replace(record, data=data), i, small)))
        assert {name for name, code in found if code == "weak"} == {record.channels[i].name}
