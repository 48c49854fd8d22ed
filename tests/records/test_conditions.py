"""Conditions from channels, where the description has none."""

from dataclasses import replace

import numpy as np
import pytest

from jackettwin.records import Channel, Record
from jackettwin.records.conditions import with_conditions


@pytest.fixture
def record() -> Record:
    n = 6000
    t = np.arange(n) / 10.0
    data = np.array([np.sin(t), np.full(n, 11.0), np.full(n, np.radians(30.0)), np.full(n, 0.8)])
    data[1, :100] = np.nan
    channels = (
        Channel("a"),
        Channel("u", "wind speed", "m/s"),
        Channel("yaw", "yaw", "rad"),
        Channel("speed", "rotor speed", "rad/s"),
    )
    return Record(data, 10.0, channels)


def test_channels_tell_what_the_description_leaves_out(record: Record) -> None:
    found = with_conditions(record).conditions
    assert found["mean_wind_speed_m_s"] == pytest.approx(11.0)
    assert found["yaw_deg"] == pytest.approx(30.0)
    assert found["state"] == "rotor turning"
    still = record.data.copy()
    still[3] = 1e-4
    assert with_conditions(replace(record, data=still)).conditions["state"] == "rotor standing"


def test_temperatures_and_levels_are_conditions(record: Record) -> None:
    """Each of its quantity, in the units that the names say; a motion is none."""
    n = record.data.shape[1]
    rows = [np.full(n, 9.3), np.full(n, 4.0), np.radians(np.full(n, 88.0)), np.full(n, np.nan)]
    kinds = (("air", "temperature"), ("sea", "temperature"), ("b1", "pitch"), ("tide", "water level"))
    channels = (Channel("a"), *(Channel(name, kind) for name, kind in kinds))
    found = with_conditions(Record(np.array([record.data[0], *rows]), 10.0, channels)).conditions
    assert found == pytest.approx({"temperature_c": 9.3, "temperature_c sea": 4.0, "pitch_deg": 88.0})
    stated = replace(record, data=np.array([record.data[0], rows[0]]), channels=channels[:2])
    stated = with_conditions(replace(stated, conditions={"temperature_c": 1.0}))
    assert stated.conditions == {"temperature_c": 1.0}


def test_what_is_stated_stays(record: Record) -> None:
    stated = {"wind_speed_m_s": 9.0, "yaw_deg": 0.0, "state": "parked"}
    assert with_conditions(replace(record, conditions=stated)).conditions == stated


def test_nothing_is_made_up(record: Record) -> None:
    assert with_conditions(record.select(["a"])).conditions == {}
    empty = record.data.copy()
    empty[1:] = np.nan
    assert with_conditions(replace(record, data=empty)).conditions == {}
