from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Channel, Record
from jackettwin.records.processing.merge import merge, shared_channels

START = datetime(2025, 1, 1, tzinfo=UTC)


def logger(name: str, rate: float, late_s: float, n: int, *names: str) -> Record:
    """Sample sin(2π 0.18 t) on a common clock, a logger that starts ``late_s`` late."""
    t = late_s + np.arange(n) / rate
    data = np.tile(np.sin(2 * np.pi * 0.18 * t), (len(names), 1))
    return Record(data, rate, tuple(Channel(c) for c in names), START + timedelta(seconds=late_s), name=name)


@pytest.mark.parametrize(
    ("rate", "late_s"), [(20.0, 0.0), (20.0, 5.0), (20.0, 0.013), (100.0, 3.0), (100.0, 7.77), (20.011, 1.0)]
)
def test_loggers_of_any_rate_and_start_show_the_same_wave(rate: float, late_s: float) -> None:
    one = logger("one", 20.0, 0.0, 6000, "a", "b")
    other = logger("other", rate, late_s, int(300 * rate), "c")
    merged = merge([one, other])
    assert merged.channel_names == ("a", "b", "c")
    assert merged.sample_rate_hz == 20.0 and merged.start_utc is not None
    begin = (merged.start_utc - START).total_seconds()
    wave = np.sin(2 * np.pi * 0.18 * (begin + np.arange(merged.data.shape[1]) / 20.0))
    inner = slice(200, -200)  # decimated ends rest on reflected samples
    # pass-band ripple 1e-4 where decimated; cubic interpolation of 111 samples a period 1e-7;
    # start times carry microseconds
    np.testing.assert_allclose(merged.data[:, inner], np.tile(wave, (3, 1))[:, inner], atol=2e-4)


def test_gaps_survive_and_only_the_overlap_is_kept() -> None:
    one, other = logger("one", 20.0, 0.0, 1000, "a"), logger("other", 20.0, 10.025, 1000, "b")
    holed = other.data.copy()
    holed[0, 100:120] = np.nan
    merged = merge([one, replace(other, data=holed)])
    assert merged.data.shape == (2, 799)
    assert 20 <= np.isnan(merged.data[1]).sum() <= 22
    assert merged.metadata["merged"] == ["one", "other"]


def test_without_starts_records_start_together() -> None:
    records = [replace(logger(name, 20.0, 0.0, 100, name), start_utc=None) for name in "ab"]
    merged = merge(records)
    assert merged.start_utc is None and merged.data.shape == (2, 100)


def test_what_cannot_be_merged_is_refused() -> None:
    one = logger("one", 20.0, 0.0, 100, "a")
    with pytest.raises(InputError, match="channel is in two records.*'a'"):
        merge([one, one])
    with pytest.raises(InputError, match="do not overlap"):
        merge([one, logger("late", 20.0, 3600.0, 100, "b")])
    with pytest.raises(InputError, match="late: start_utc: only some records have a start"):
        merge([one, replace(logger("late", 20.0, 1.0, 100, "b"), start_utc=None)])
    with pytest.raises(InputError, match="nothing to merge"):
        merge([])


def test_reference_sensors_are_those_in_every_setup() -> None:
    setups = [logger("1", 20.0, 0.0, 10, "ref", "a"), logger("2", 20.0, 900.0, 10, "b", "ref")]
    assert shared_channels(setups) == ("ref",)
    with pytest.raises(InputError, match="share no channel"):
        shared_channels([setups[0], setups[1].select(["b"])])
    moved = replace(setups[1], channels=(setups[1].channels[0], Channel("ref", height_m=3.0)))
    with pytest.raises(InputError, match=r"2: channels.ref: one name is used for different sensors"):
        shared_channels([setups[0], moved])
