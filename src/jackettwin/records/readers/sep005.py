"""SEP005 dictionaries, the exchange format of the SDyPy community for measured signals.

One dictionary a channel with ``name``, ``data``, ``unit_str`` and ``fs`` or ``time``; an optional
ISO 8601 ``start_timestamp``. Our own keys (``quantity``, ``height_m``, ``node``, ``direction``) ride along,
and so does everything else a dictionary holds.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.errors import InputError
from jackettwin.files import validate
from jackettwin.records.readers.description import CHANNEL_METADATA, ChannelEntry
from jackettwin.records.readers.stamps import parse_time
from jackettwin.records.readers.table import ReadTable, seconds, to_record

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jackettwin.records.record import Record

REQUIRED = ("name", "data", "unit_str")
OWN_KEYS = ("quantity", "height_m", "node", "direction", "frame")
KNOWN = {*REQUIRED, *OWN_KEYS, "fs", "time", "start_timestamp"}


def from_sep005(signals: Sequence[Mapping[str, Any]], *, name: str = "record") -> Record:
    """Return the record that SEP005 signals describe.

    Raises
    ------
    InputError
        If a required key is missing, or channels differ in rate, length or start.
    """
    if not signals:
        raise InputError(
            "holds no channels",
            file=name,
            field="signals",
            allowed="at least one signal",
            remedy="give one dictionary a channel",
        )
    try:
        return to_record(_table(signals), None, Path(name))
    except InputError as error:
        raise error.at(file=name) from None


def to_sep005(record: Record) -> list[dict[str, Any]]:
    """Return one SEP005 dictionary a channel, in SI units.

    Examples
    --------
    >>> import numpy as np
    >>> from jackettwin.records import Channel, Record
    >>> to_sep005(Record(np.zeros((1, 3)), 10.0, (Channel("a"),)))[0]["unit_str"]
    'm/s^2'
    """
    shared: dict[str, Any] = {"fs": record.sample_rate_hz}
    if record.start_utc is not None:
        shared["start_timestamp"] = record.start_utc.isoformat()
    signals = []
    for channel, row in zip(record.channels, record.data, strict=True):
        own: dict[str, Any] = {"quantity": channel.quantity, "direction": list(channel.direction)}
        own |= {} if channel.height_m is None else {"height_m": channel.height_m}
        own |= {} if channel.node is None else {"node": channel.node}
        own |= {} if channel.frame == "global" else {"frame": channel.frame}
        further = record.metadata.get(CHANNEL_METADATA, {}).get(channel.name, {})
        signal = {"name": channel.name, "data": row.copy(), "unit_str": channel.unit, **shared, **own}
        signals.append({**further, **signal})
    return signals


def _table(signals: Sequence[Mapping[str, Any]]) -> ReadTable:
    for i, signal in enumerate(signals):
        missing = [key for key in REQUIRED if key not in signal]
        if missing or ("fs" not in signal and "time" not in signal):
            raise InputError(
                "required key is missing",
                field=f"signals.{i}.{(missing or ['fs'])[0]}",
                allowed="name, data, unit_str and fs or time",
                remedy="complete the SEP005 dictionary",
            )
    rows = [_numbers(signal["data"], f"signals.{i}.data") for i, signal in enumerate(signals)]
    _refuse_difference("data", [len(row) for row in rows])
    _refuse_difference("fs", [signal.get("fs") for signal in signals])
    _refuse_difference("start_timestamp", [signal.get("start_timestamp") for signal in signals])
    times, start = signals[0].get("time"), signals[0].get("start_timestamp")
    times_s = seconds(np.asarray(times))[0] if times is not None else None
    if times_s is not None and len(times_s) != len(rows[0]):
        raise InputError(
            "time and data differ in length",
            field="signals.0.time",
            value=len(times_s),
            allowed=str(len(rows[0])),
            remedy="give one stamp a sample, or fs instead",
        )
    entries = {str(s["name"]): _entry(s, i) for i, s in enumerate(signals)}
    further = {str(s["name"]): extra for s in signals if (extra := {k: s[k] for k in s if k not in KNOWN})}
    return ReadTable(
        names=tuple(str(signal["name"]) for signal in signals),
        data=np.vstack(rows),
        channels=entries,
        sample_rate_hz=_rate(signals[0]["fs"]) if "fs" in signals[0] else None,
        times_s=times_s,
        start_utc=parse_time(str(start)) if start else None,
        metadata={CHANNEL_METADATA: further} if further else {},
    )


def _rate(fs: Any) -> float:
    try:
        return float(fs)
    except (ValueError, TypeError):
        raise InputError(
            "is not a number",
            field="signals.0.fs",
            value=fs,
            allowed="> 0 Hz",
            remedy="state the sample rate in Hz",
        ) from None


def _entry(signal: Mapping[str, Any], i: int) -> ChannelEntry:
    own = {key: signal[key] for key in OWN_KEYS if key in signal}
    return validate(ChannelEntry, {**own, "unit": str(signal["unit_str"])}, field=f"signals.{i}")


def _numbers(data: Any, field: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    try:
        row = np.asarray(data, dtype=np.float64)
    except (ValueError, TypeError):
        raise InputError(
            "does not hold numbers", field=field, allowed="a vector of numbers", remedy="NaN marks a gap"
        ) from None
    if row.ndim != 1:
        raise InputError(
            "is not a vector",
            field=field,
            value=row.shape,
            allowed="one channel a dictionary",
            remedy="make one dictionary of every row",
        )
    return row


def _refuse_difference(key: str, values: list[Any]) -> None:
    if any(value != values[0] for value in values):
        raise InputError(
            "channels differ",
            field=key,
            value=sorted({str(value) for value in values})[:4],
            allowed="the same for every channel",
            remedy="make one record a rate, then merge(...) them",
        )
