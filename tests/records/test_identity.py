"""The identity of a record is a hash of its samples, rate, start and channels, and of nothing else."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone

import numpy as np

from jackettwin.records import Channel, Record, record_id

NOON = datetime(2025, 3, 1, 12, tzinfo=UTC)
RECORD = Record(
    np.arange(20.0).reshape(2, 10),
    10.0,
    (Channel("a", direction=(1.0, 0.0, 0.0)), Channel("b")),
    start_utc=NOON,
    name="monday",
)


def test_name_metadata_and_conditions_are_labels() -> None:
    labelled = replace(RECORD, name="renamed", metadata={"by": "us"}, conditions={"wind": 3.0})
    assert record_id(labelled) == record_id(RECORD)


def test_whatever_was_measured_otherwise_is_another_record() -> None:
    turned = replace(RECORD.channels[0], direction=(-1.0, 0.0, 0.0))
    changed = [
        replace(RECORD, sample_rate_hz=20.0),
        replace(RECORD, start_utc=NOON + timedelta(seconds=1)),
        replace(RECORD, start_utc=None),
        replace(RECORD, channels=(turned, RECORD.channels[1])),
        replace(RECORD, data=np.where(RECORD.data == 7.0, 7.1, RECORD.data)),
    ]
    assert len({record_id(r) for r in (RECORD, *changed)}) == len(changed) + 1


def test_the_same_instant_and_a_negative_zero_are_the_same() -> None:
    elsewhere = replace(RECORD, start_utc=NOON.astimezone(timezone(timedelta(hours=2))))
    assert record_id(elsewhere) == record_id(RECORD)
    zero = replace(RECORD, data=np.zeros_like(RECORD.data))
    assert record_id(replace(zero, data=-zero.data)) == record_id(zero)
