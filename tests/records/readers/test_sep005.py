from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from jackettwin.errors import InputError
from jackettwin.records import Record
from jackettwin.records.readers import from_sep005, to_sep005


def signal(**changes: Any) -> dict[str, Any]:
    return {"name": "acc_x", "data": np.arange(5.0), "unit_str": "g", "fs": 20} | changes


def test_round_trip_keeps_data_channels_rate_and_start(record: Record) -> None:
    back = from_sep005(to_sep005(record), name="r")
    assert np.array_equal(back.data, record.data, equal_nan=True)
    assert back.channels == record.channels
    assert (back.sample_rate_hz, back.start_utc, back.name) == (12.5, record.start_utc, "r")
    assert back.metadata == {"channel_metadata": {"acc_top_x": {"sensor": "MEMS 7"}}}


def test_signals_meet_the_rules_of_the_standard(record: Record) -> None:
    """Required keys, vector data and ISO 8601 start: SDyPy enhancement proposal 5."""
    for one in to_sep005(record):
        assert {"name", "data", "unit_str", "fs"} <= one.keys() and "timestamp" not in one
        assert isinstance(one["data"], np.ndarray) and one["data"].ndim == 1


def test_units_and_stamps_are_understood() -> None:
    start = "2025-01-01 13:00:00+00:00"
    plain = signal(time=np.arange(5) / 20.0, start_timestamp=start)
    del plain["fs"]
    record = from_sep005([plain])
    assert (record.sample_rate_hz, record.channels[0].unit) == (20.0, "m/s^2")
    assert record.start_utc is not None and record.start_utc.hour == 13
    np.testing.assert_allclose(record.data[0], np.arange(5) * 9.80665, rtol=1e-15)


@pytest.mark.parametrize(
    ("signals", "message"),
    [
        ([], "holds no channels"),
        ([{"name": "a", "data": np.zeros(3), "fs": 1}], r"signals\.0\.unit_str: required key is missing"),
        ([signal(), signal(name="b", fs=10)], "fs: channels differ"),
        ([signal(), signal(name="b", data=np.zeros(4))], "data: channels differ"),
        ([signal(), signal()], "given twice"),
        ([signal(data=np.zeros((2, 2)))], "is not a vector"),
        ([signal(data=["x"])], "does not hold numbers"),
        ([signal(unit_str="m/s^3")], "wrong unit"),
        ([signal(direction=[1])], r"signals\.0\.direction"),
        ([signal(fs=-1)], "sample rate"),
        ([signal(fs="quick")], "fs"),
        ([signal(start_timestamp="noon")], "ISO 8601"),
    ],
)
def test_wrong_signals_are_refused(signals: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(InputError, match=message):
        from_sep005(signals)
