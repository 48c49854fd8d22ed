"""Tones along a measured azimuth: taken out however they drift, modes left alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, examine, examine_file
from jackettwin.identification.synthetic import ModalSystem, simulate
from jackettwin.records import Channel, Record, write_record
from jackettwin.records.processing.tones import rotor_speed, without_orders

F = np.array([0.3, 0.7, 1.3])
SHAPES = np.array([[1.0, 0.4, 0.2], [-0.4, 1.0, 0.6], [0.3, -0.7, 1.0]])


def operating(drift: float) -> tuple[Record, np.ndarray]:
    """Three modes and a 3P as strong as the channel, from 0.45 Hz on, with the speed it came from."""
    system = ModalSystem(F, np.full(3, 0.015), SHAPES, np.diag(F**-2.0))
    record = simulate(system, np.random.default_rng(3), sample_rate_hz=10.0)
    t = np.arange(record.data.shape[1]) / 10.0
    speed = 2 * np.pi * (0.15 + drift * np.sin(2 * np.pi * t / 500.0) ** 2)
    tone = np.sqrt(2.0) * np.cos(3.0 * np.cumsum(speed) / 10.0 + 0.4)
    data = record.data + record.data.std(axis=1, keepdims=True) * tone
    channels = (*(replace(c, name=f"acc_{i}") for i, c in enumerate(record.channels)),)
    speed_channel = Channel("rotor_speed", "rotor speed", "rad/s")
    return replace(record, data=np.vstack([data, speed]), channels=(*channels, speed_channel)), record.data


@pytest.mark.parametrize("drift", [0.0, 0.05])
def test_what_is_left_is_the_record_without_the_tone(drift: float) -> None:
    record, clean = operating(drift)
    speed = rotor_speed(record)
    assert speed is not None
    left, orders = without_orders(record, speed)
    # two parameters of 6000 samples for each of three orders, which the noise around them fills
    assert np.abs(left.data[:3] - clean).max() < 0.3 * clean.std()
    assert [o.order for o in orders] == [1, 3, 6]
    assert orders[1].share == pytest.approx(0.5, abs=0.05)
    assert orders[1].low_hz == pytest.approx(0.45, abs=0.001)
    assert orders[1].high_hz == pytest.approx(0.45 + 3.0 * drift, abs=0.001)
    assert orders[0].share < 0.01
    np.testing.assert_array_equal(left.data[3], record.data[3])


@pytest.mark.parametrize(("rpm", "flagged"), [(None, []), (0.0, []), (14.0, [0.7, 1.3]), (6.0, [0.3])])
def test_modes_at_the_orders_of_a_stated_speed_are_flagged(rpm: float | None, flagged: list[float]) -> None:
    """3P and 6P of 14 turns a minute are 0.7 and 1.4 Hz, 3P of 6 turns 0.3 Hz; a rotor at rest has none."""
    system = ModalSystem(F, np.full(3, 0.015), SHAPES, np.diag(F**-2.0))
    record = simulate(system, np.random.default_rng(3), sample_rate_hz=10.0)
    stated = replace(record, conditions={"rotor_speed_rpm": rpm})
    found = examine(stated, IdentificationSettings(refine=False)).identification
    passed = [m for m in found.modes if any(f.code == "rotor_order_passes" for f in m.reasons)]
    assert [round(m.frequency_hz, 1) for m in passed] == flagged
    assert len(found.modes) == 3


def test_a_drifting_tone_is_no_mode_and_what_it_passes_is_flagged(tmp_path: Path) -> None:
    record, _ = operating(0.1)
    write_record(record, tmp_path / "r.parquet")
    found = examine_file(tmp_path / "r.parquet", IdentificationSettings(refine=False)).identification
    assert [round(m.frequency_hz, 1) for m in found.modes] == [0.3, 0.7, 1.3]
    assert "3P: 0.45 to 0.75 Hz by the measured rotor speed: removed" in found.warnings[0]
    # 3P passes 0.7 Hz, 6P goes from 0.9 to 1.5 Hz
    passed = ["P of the rotor crosses this frequency" in (m.status_reason or "") for m in found.modes]
    assert passed == [False, True, True]


def test_a_parked_rotor_has_no_orders() -> None:
    record, _ = operating(0.0)
    still = replace(record, data=np.vstack([record.data[:3], np.zeros(6000)]))
    assert rotor_speed(still) is None
    assert rotor_speed(record.select(record.channel_names[:3])) is None
    missing = replace(record, data=np.vstack([record.data[:3], np.full(6000, np.nan)]))
    assert rotor_speed(missing) is None


@pytest.mark.parametrize(("turns", "has_orders"), [(15.0, False), (25.0, True)])
def test_a_rotor_has_orders_from_twenty_turns_in_a_record(turns: float, has_orders: bool) -> None:
    record, _ = operating(0.0)
    speed = np.full(6000, 2.0 * np.pi * turns / 600.0)
    slow = replace(record, data=np.vstack([record.data[:3], speed]))
    assert (rotor_speed(slow) is not None) == has_orders


def test_a_ninth_order_of_a_measured_speed_is_no_mode_that_is_ok() -> None:
    record, _ = operating(0.0)
    t = np.arange(record.data.shape[1]) / record.sample_rate_hz
    ninth = 0.3 * record.data[:3].std(axis=1, keepdims=True) * np.cos(2 * np.pi * 9 * 0.15 * t)
    swell = 1.0 + 0.5 * np.sin(2 * np.pi * t / 45.0)
    turned = replace(record, data=record.data + np.vstack([ninth * swell, np.zeros_like(t)]))
    for measured, seen in ((record, []), (turned, [9])):
        examined = examine(measured, IdentificationSettings(refine=False))
        informative = [
            f.params["order"] for f in examined.identification.findings if f.code == "rotor_order_seen"
        ]
        assert informative == seen
    passed = [m for m in examined.identification.modes if abs(m.frequency_hz - 1.35) < 0.02]
    assert all("rotor_order_passes" in [f.code for f in m.reasons] for m in passed)
