"""What a record is, told by its content: the same samples are the same record, whatever the file's name."""

from __future__ import annotations

import hashlib
import json
from datetime import UTC
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jackettwin.records.record import Record

DIGITS = 24
"""Hexadecimal digits of an identity: among 1e9 records two agree by chance with a probability of 1e-11."""


def record_id(record: Record) -> str:
    """Return the identity of a record: a hash of its samples, rate, start and channels.

    Name, conditions and metadata do not count, so that a renamed or re-described file is the same record.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from jackettwin.records import Channel, Record
    >>> record = Record(np.zeros((1, 3)), 10.0, (Channel("a"),), name="monday")
    >>> record_id(record) == record_id(replace(record, name="tuesday"))
    True
    >>> record_id(record) == record_id(replace(record, data=record.data + 1.0))
    False
    """
    start = None if record.start_utc is None else record.start_utc.astimezone(UTC).isoformat()
    channels = [
        [c.name, c.quantity, c.unit, c.height_m, c.node, list(map(float, c.direction)), c.frame]
        for c in record.channels
    ]
    head = [float(record.sample_rate_hz), start, list(record.data.shape), channels]
    samples = np.ascontiguousarray(record.data, dtype="<f8")
    # one NaN and one zero: a reader may leave any
    samples = np.where(np.isnan(samples), np.nan, samples) + 0.0
    hashed = hashlib.sha256(json.dumps(head, ensure_ascii=False).encode())
    hashed.update(samples.tobytes())
    return hashed.hexdigest()[:DIGITS]
