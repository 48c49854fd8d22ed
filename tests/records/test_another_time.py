"""Channels that were not taken together are named or brought together; those of another direction are not."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.records import Record, assess, repair

UPPER = [0, 1, 4, 5]


def alarms(record: Record) -> list[tuple[str, str]]:
    quality = assess(record)
    codes = ("another_time", "stored_backwards", "clock_jump", "clocks_wander", "time_lost")
    return [(f.code, f.text.split(":")[0]) for f in quality.findings if f.code in codes]


def without_directions(record: Record) -> Record:
    return replace(record, channels=tuple(replace(c, direction=(0.0, 0.0, 0.0)) for c in record.channels))


def test_channels_that_hardly_stand_out_of_their_noise_are_not_accused(tower: SimpleNamespace) -> None:
    """In a calm only the upper sensors see more than one mode; 18 channels were named here once."""
    for seed in range(12):
        record, rng = tower.record(seed), np.random.default_rng(seed)
        share = 2.0 * np.linspace(0.1, 1.0, len(record.data))[:, None]
        noise = share * record.data.std(axis=1, keepdims=True) * rng.standard_normal(record.data.shape)
        assert alarms(replace(record, data=record.data + noise)) == []


def test_a_nacelle_stands_at_any_angle_and_its_two_axes_see_all(tower: SimpleNamespace) -> None:
    """Its y is not the tower's: weak crosswise motion of a symmetric tower is accused of nothing."""
    record, other = tower.record(1), tower.record(2)
    data = record.data.copy()
    data[4:] *= 0.1
    data += 0.02 * data[:4].std() * np.random.default_rng(3).standard_normal(data.shape)
    c, s = np.cos(np.radians(40.0)), np.sin(np.radians(40.0))
    data[[0, 4]] = np.array([[c, s], [-s, c]]) @ data[[0, 4]]
    channels = list(record.channels)
    for i in (0, 4):
        channels[i] = replace(channels[i], frame="nacelle")
    turned = replace(record, data=data, channels=tuple(channels))
    assert alarms(turned) == []
    data = data.copy()
    data[[0, 4]] = other.data[[0, 4]]
    found = alarms(replace(turned, data=data))
    assert found == [("another_time", "acc_144_x, acc_144_y")]


@pytest.mark.parametrize("rows", [[2], [0, 4], UPPER])
def test_channels_of_another_day_are_named(rows: list[int], tower: SimpleNamespace) -> None:
    record, other = tower.record(1), tower.record(2)
    data = record.data.copy()
    data[rows] = other.data[rows]
    found = alarms(replace(record, data=data))
    assert {code for code, _ in found} == {"another_time"}
    named = {name for _, names in found for name in names.split(", ")}
    own = {record.channel_names[i] for i in rows}
    # of two halves nobody knows which is of the other day
    assert named == own or (len(rows) == 4 and named == set(record.channel_names) - own)


@pytest.mark.parametrize("row", [0, 3, 6])
def test_a_channel_stored_backwards_is_named(row: int, tower: SimpleNamespace) -> None:
    record = tower.record(3)
    data = record.data.copy()
    data[row] = data[row, ::-1]
    assert alarms(replace(record, data=data)) == [("stored_backwards", record.channel_names[row])]


def test_directions_are_asked_for_before_a_clock_is_blamed(tower: SimpleNamespace) -> None:
    """Crosswise channels of which nobody states the direction are named once, used, and not doubted."""
    for seed in range(4):
        record = without_directions(tower.record(seed))
        quality = assess(record)
        assert alarms(record) == []
        (asked,) = [f for f in quality.findings if f.code == "direction_unknown"]
        assert asked.severity == "warning"
        assert sorted(str(asked.params["channels"]).split(", ")) in (
            sorted(record.channel_names[:4]),
            sorted(record.channel_names[4:]),
        )
        assert repair(record, quality).channel_names == record.channel_names


def test_more_groups_than_directions_are_of_other_days(tower: SimpleNamespace) -> None:
    """Three levels in four days: three directions explain three of them at most."""
    days = [tower.record(seed) for seed in range(4)]
    levels = [replace(c, direction=(0.0, 0.0, 0.0)) for c in days[0].channels[:3]]
    channels = tuple(replace(c, name=f"{c.name}_{day}") for day in range(4) for c in levels)
    mixed = replace(days[0], data=np.vstack([day.data[:3] for day in days]), channels=channels)
    assert [code for code, _ in alarms(mixed)] == ["another_time"]
    of_three = replace(mixed, data=mixed.data[:9], channels=channels[:9])
    assert alarms(of_three) == []


def test_of_channels_without_places_halves_are_asked_about_and_one_is_blamed(tower: SimpleNamespace) -> None:
    """Half of the sensors of a tower point across; one that is like no other does not."""
    record, other = without_directions(tower.record(1)), tower.record(2)
    nowhere = replace(record, channels=tuple(replace(c, height_m=None) for c in record.channels))
    assert alarms(nowhere) == []
    assert [f.code for f in assess(nowhere).findings if f.severity == "warning"] == ["direction_unknown"]
    odd = replace(nowhere, data=np.vstack([record.data[:2], other.data[2:3], record.data[3:]]))
    (blamed,) = [f for f in assess(odd).findings if f.code == "another_time"]
    assert blamed.params["channels"] == odd.channel_names[2] and "state their directions" in blamed.text


def test_a_channel_of_noise_is_no_stranger(tower: SimpleNamespace) -> None:
    """It has nothing in common with the others, nor their peaks."""
    rng = np.random.default_rng(5)
    record = without_directions(tower.record(4))
    data = record.data[:4].copy()
    data[3] = data[3].std() * rng.standard_normal(data.shape[1])
    assert alarms(replace(record, data=data, channels=record.channels[:4])) == []


@pytest.mark.parametrize("row", [0, 3, 6])
def test_a_channel_stored_backwards_is_turned(row: int, tower: SimpleNamespace) -> None:
    record = tower.record(3)
    data = record.data.copy()
    data[row] = data[row, ::-1]
    broken = replace(record, data=data)
    np.testing.assert_allclose(repair(broken, assess(broken)).data, record.data)


def test_fewer_channels_of_another_day_are_left_out(tower: SimpleNamespace) -> None:
    record, other = tower.record(1), tower.record(2)
    broken = replace(record, data=np.vstack([other.data[:1], record.data[1:]]))
    assert repair(broken, assess(broken)).channel_names == record.channel_names[1:]


@pytest.mark.parametrize(("start", "lost_s"), [(3_500, 17.0), (6_000, 40.0), (9_000, 8.0)])
def test_seconds_that_a_logger_lost_are_given_back(start: int, lost_s: float, tower: SimpleNamespace) -> None:
    record, lost = tower.record(6), int(20 * lost_s)
    short = np.delete(record.data, np.s_[start : start + lost], axis=1)
    data = record.data[:, :-lost].copy()
    data[UPPER] = short[UPPER]
    broken = replace(record, data=data)
    quality = assess(broken)
    assert quality.clocks.judged
    (one,) = quality.clocks.lost
    # of two halves either is out of step; phases tell to half a sample
    upper = set(one.rows) == set(UPPER)
    assert one.samples == (lost if upper else -lost)
    assert one.start <= start <= one.stop
    ready, sound = repair(broken, quality).data, record.data[:, :-lost]
    far = np.ones(sound.shape[1], dtype=bool)
    far[start - 1500 : start + lost + 1500] = False
    there = np.isfinite(ready).all(axis=0) & far
    assert there.mean() > 0.5
    reference = sound if upper else np.roll(sound, -lost, axis=1)
    after = np.arange(len(there)) > start
    np.testing.assert_allclose(ready[:, there & ~after], sound[:, there & ~after])
    np.testing.assert_allclose(ready[UPPER][:, there & after], reference[UPPER][:, there & after])


def test_a_channel_that_falls_silent_loses_no_time(tower: SimpleNamespace) -> None:
    record = tower.record(7)
    data = record.data.copy()
    data[2, 5_000:] = 1e-6 * np.random.default_rng(1).standard_normal(data.shape[1] - 5_000)
    clocks = assess(replace(record, data=data)).clocks
    assert not clocks.lost
    assert clocks.judged
