"""Exchanged channels of one place are put right; sound records and skew modes are left alone."""

from __future__ import annotations

from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from jackettwin.identification import IdentificationSettings, examine
from jackettwin.identification.record_steps import moving_channels
from jackettwin.records import Record, read_record
from jackettwin.records.quality.crossed_axes import axes_in_line

RECORD = Path(str(files("jackettwin"))) / "data/records/pile_U12_s301.parquet"


def exchanged(record: Record, *pairs: tuple[int, int]) -> Record:
    """Return the record with rows exchanged."""
    data = record.data.copy()
    for x, y in pairs:
        data[[x, y]] = record.data[[y, x]]
    return replace(record, data=data)


@pytest.mark.parametrize("level", range(4))
def test_the_exchanged_level_is_put_right(level: int, tower: SimpleNamespace) -> None:
    for record, pair in (
        (tower.record(level), (level, level + 4)),
        (moving_channels(read_record(RECORD)), (2 * level, 2 * level + 1)),
    ):
        ready, (found,) = axes_in_line(exchanged(record, pair))
        assert (found.code, found.repaired) == ("axes_crossed", True)
        assert found.params["channels"] == ", ".join(record.channels[i].name for i in pair)
        np.testing.assert_array_equal(ready.data, record.data)


def test_sound_records_and_all_levels_alike_are_left_alone(tower: SimpleNamespace) -> None:
    for seed in range(20):
        record = tower.record(seed)
        assert axes_in_line(record)[1] == ()
        assert axes_in_line(exchanged(record, *((k, k + 4) for k in range(4))))[1] == ()


def test_modes_across_the_axes_decide_nothing(tower: SimpleNamespace) -> None:
    """Axes turned by 45° against the modes: x of one height is as coherent with y of the others."""
    record = tower.record(1)
    x, y = record.data[:4], record.data[4:]
    turned = replace(record, data=np.vstack([x + 0.1 * y, y + 10.0 * x]))
    for one in (turned, exchanged(turned, (1, 5))):
        assert [f.code for f in axes_in_line(one)[1] if f.repaired] == []


def test_of_two_against_two_nobody_can_say(tower: SimpleNamespace) -> None:
    broken = exchanged(tower.record(2), (0, 4), (1, 5))
    ready, (found,) = axes_in_line(broken)
    assert found.code == "axes_crossed_unclear" and not found.repaired
    assert ready is broken


def test_a_nacelle_across_is_no_exchange(tower: SimpleNamespace) -> None:
    """At a yaw of 90° a sensor in the rotor's axes moves with the tower's other axis."""
    record = exchanged(tower.record(3), (0, 4))
    channels = tuple(replace(c, frame="nacelle") if i in (0, 4) else c for i, c in enumerate(record.channels))
    assert axes_in_line(replace(record, channels=channels))[1] == ()


def test_an_examination_says_so_and_blames_no_clock(tower: SimpleNamespace) -> None:
    seen = examine(exchanged(tower.record(1), (2, 6)), IdentificationSettings(blocks=0, refine=False))
    assert [f.code for f in seen.identification.findings if f.code.startswith("axes")] == ["axes_crossed"]
    assert [f.code for f in seen.quality.findings if f.code in ("another_time", "direction_unknown")] == []
