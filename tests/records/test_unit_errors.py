from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.constants import GRAVITY_M_S2 as G0
from jackettwin.records import Channel, Record, assess


def unit_findings(record: Record) -> dict[str | None, str]:
    return {f.subject: f.text for f in assess(record).findings if f.code == "unit"}


def times(record: Record, i: int, factor: float) -> Record:
    data = record.data.copy()
    data[i] *= factor
    return replace(record, data=data)


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (G0, "9.81 times too large compared with similar channels: m/s^2 taken for g"),
        (1.0 / G0, "9.81 times too small compared with similar channels: g taken for m/s^2"),
        (
            1e3 / G0,
            "102 times too large compared with similar channels: mg or cm/s^2 taken for m/s^2",
        ),
        (1e-3, "1e+03 times too small compared with similar channels: g taken for mg"),
    ],
)
@pytest.mark.parametrize("i", [0, 1, 3])
def test_a_channel_in_another_unit_is_named_with_the_factor(
    i: int, factor: float, words: str, tower: SimpleNamespace
) -> None:
    """Top, middle and foot of a tower whose amplitudes span a factor of eight by nature."""
    record = tower.record(1)
    found = unit_findings(times(record, i, factor))
    assert words in found[record.channels[i].name]


def test_a_factor_that_is_no_ratio_of_units_is_a_matter_of_the_structure(tower: SimpleNamespace) -> None:
    """A top that moves three times as much may be a slender tower on a stiff jacket."""
    assert not unit_findings(times(tower.record(2), 0, 3.0))


def test_no_unit_of_another_is_blamed_for_a_nearly_dead_sensor() -> None:
    """A power law through 30 and 65 m fits 100 m in mm/s² as well, but then the tower moves less above.

    The middle of three, at 1/330 of its size, made the sound top "9,810 times too large".
    """
    t, rng = np.arange(12_000) / 20.0, np.random.default_rng(4)
    mode = np.convolve(rng.standard_normal(t.size), np.exp(-0.02 * t) * np.sin(2.0 * np.pi * 0.3 * t))[
        : t.size
    ]
    heights = (30.0, 65.0, 100.0)
    y = np.array([(h / 100.0) ** 1.7 * mode for h in heights])
    y += 0.02 * y.std(axis=1, keepdims=True) * rng.standard_normal(y.shape)
    y[1] *= 3e-3
    channels = tuple(Channel(f"a{h:.0f}_y", height_m=h, direction=(0.0, 1.0, 0.0)) for h in heights)
    assert not unit_findings(Record(y, 20.0, channels))


def test_of_two_sensors_at_one_node_either_may_be_wrong(tower: SimpleNamespace) -> None:
    row = tower.record(3).data[0]
    noise = 0.02 * row.std() * np.random.default_rng(3).normal(size=(2, len(row)))
    channels = tuple(Channel(f"leg_{i}_x", node="leg", direction=(1.0, 0.0, 0.0)) for i in range(2))
    found = unit_findings(Record(np.array([row, G0 * row]) + noise, 20.0, channels))
    assert list(found) == ["leg_1_x"]
    assert found["leg_1_x"].startswith("it or leg_0_x is 9.81 times too large")


@pytest.mark.parametrize(("mean", "wrong"), [(1.0, True), (1000.0, True), (G0, False), (0.0, False)])
def test_gravity_shows_the_unit_of_a_vertical_sensor(mean: float, wrong: bool) -> None:
    y = mean + 0.01 * np.random.default_rng(5).normal(size=(1, 2000))
    record = Record(y, 20.0, (Channel("deck_z", direction=(0.0, 0.0, 1.0)),))
    assert bool(unit_findings(record)) == wrong
