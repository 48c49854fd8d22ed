"""Conditions of the site, read from tables of ten-minute statistics as SCADA systems export them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from math import isfinite
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import csv

from jackettwin.errors import InputError
from jackettwin.records import read_zone
from jackettwin.records.readers.stamps import in_utc

Value = float | str | None
_TIMES = ("time_utc", "time", "timestamp", "datetime", "date_time", "date", "zeit", "pctimestamp")
"""What the column of times may be called, once its name is written in small letters and underscores."""
_STAMPS = ["%Y-%m-%d %H:%M:%S", "%Y-%m-%d %H:%M", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M", csv.ISO8601]
_MOST_ROWS = 2_000_000
"""Forty years of ten-minute statistics."""


def read_table(
    path: Path, *, zone: str = "UTC", names: Mapping[str, str] | None = None, end_stamped: bool = False
) -> dict[str, dict[datetime, Value]]:
    """Return the conditions of a CSV file, {name: {start of the interval: value}}.

    Parameters
    ----------
    zone : str
        Of clocks that do not say theirs.
    names : {column: name}, optional
        Of columns to take under another name; the others keep theirs in small letters and underscores.
    end_stamped : bool
        Whether a row bears the end of its ten minutes.

    Raises
    ------
    InputError
        If it is no table, or no column is one of times.
    """
    table = _read(path)
    given = names or {}
    called = {column: given.get(column, plain_name(column)) for column in table.column_names}
    times = next((column for column in called if called[column] in _TIMES), None)
    kind = None if times is None else table.schema.field(times).type
    if times is None or not (pa.types.is_timestamp(kind) or pa.types.is_date(kind)):
        raise InputError(
            "no column of times",
            file=path,
            field="time",
            value=", ".join(table.column_names)[:200],
            allowed="2025-03-01T12:00:00Z, 2025-03-01 12:00 or 01.03.2025 12:00 under " + ", ".join(_TIMES),
            remedy="name the column time_utc",
        )
    clock, back = read_zone(zone), timedelta(minutes=10 if end_stamped else 0)
    starts = [None if t is None else _utc(t, clock) - back for t in table[times].to_pylist()]
    return {
        name: {t: _value(v) for t, v in zip(starts, table[column].to_pylist(), strict=True) if t is not None}
        for column, name in called.items()
        if column != times
    }


def plain_name(column: str) -> str:
    """Return a column's name in small letters and underscores.

    >>> plain_name("Wind Speed (m/s)")
    'wind_speed_m_s'
    """
    return re.sub(r"[^a-z0-9]+", "_", column.strip().lower()).strip("_")[:64]


def _read(path: Path) -> Any:
    """Return a table of a delimited file, its delimiter and decimal sign as its first lines show them."""
    try:
        head = path.read_bytes()[:65536].decode("utf-8-sig", errors="replace")
        first = head.partition("\n")[0]
        delimiter = max(";\t,", key=first.count)
        comma = delimiter != "," and re.search(r"\d,\d", head) is not None
        table = csv.read_csv(
            path,
            parse_options=csv.ParseOptions(delimiter=delimiter),
            convert_options=csv.ConvertOptions(
                decimal_point="," if comma else ".", timestamp_parsers=_STAMPS
            ),
        )
    except (pa.ArrowInvalid, pa.ArrowException, OSError) as error:
        raise InputError(
            "not a table of conditions",
            file=path,
            value=str(error)[:120],
            allowed="CSV: a line of names, then one line for each interval",
            remedy="export it with a header, one delimiter and one decimal sign",
        ) from None
    if table.num_rows > _MOST_ROWS:
        raise InputError("too many rows", file=path, value=table.num_rows, allowed=f"up to {_MOST_ROWS}")
    return table


def _utc(time: Any, clock: Any) -> datetime:
    whole = time if isinstance(time, datetime) else datetime(time.year, time.month, time.day)
    return in_utc(whole, clock) if whole.tzinfo is None else whole.astimezone(UTC)


def _value(value: Any) -> Value:
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value)
    return float(value) if isfinite(value) else None
