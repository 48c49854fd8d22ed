"""Reading of site conditions from tables of ten-minute statistics of SCADA systems."""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import UTC, date, datetime, timedelta
from math import isfinite
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import csv

from jackettwin.errors import InputError, located
from jackettwin.records import read_zone
from jackettwin.records.readers.stamps import start_in_utc
from jackettwin.service.workers.event_tables import BEGINS, ENDS, KINDS, by_ten_minutes, is_of_events

Value = float | str | None
_WHOSE = "asset_id"
"""Column with the turbine of each row, named as in OpenOA's schema."""
_TIMES = ("time_utc", "time", "timestamp", "datetime", "date_time", "date", "zeit", "pctimestamp")
"""Possible names of the column of times, in lower case with underscores."""
_STAMPS = ["%Y-%m-%d %H:%M:%S", "%Y-%m-%d %H:%M", "%d.%m.%Y %H:%M:%S", "%d.%m.%Y %H:%M", csv.ISO8601]
_MOST_ROWS = 2_000_000
"""Largest number of rows, about forty years of ten-minute statistics."""


def read_table(
    path: Path,
    *,
    zone: str = "UTC",
    names: Mapping[str, str] | None = None,
    end_stamped: bool = False,
    asset: str | None = None,
) -> Mapping[str, Mapping[datetime, Value]]:
    """Return the conditions of a CSV file, {name: {start of the interval: value}}.

    A table of events, which have a begin, an end and a kind, is one of states of operation.

    Parameters
    ----------
    zone : str
        Time zone of times without one.
    names : {column: name}, optional
        Columns to read under another name; others have their own in lower case with underscores.
    end_stamped : bool
        Whether times are the ends of the intervals.
    asset : str, optional
        Turbine whose rows are read if there is a column ``asset_id``.

    Raises
    ------
    InputError
        If it is not a table, has no column of times, or tells times that its zone never has.
    """
    table = _read(path)
    given = names or {}
    called = {column: given.get(column, plain_name(column)) for column in table.column_names}
    table = _of_asset(table, called, asset, path)
    if is_of_events(called.values()):
        return {"state": _events(table, called, zone, path)}
    times = next((column for column in called if called[column] in _TIMES), None)
    kind = None if times is None else table.schema.field(times).type
    if times is None or not (pa.types.is_timestamp(kind) or pa.types.is_date(kind)):
        raise InputError(
            "there is no column of times",
            file=path,
            field="time",
            value=", ".join(table.column_names)[:200],
            allowed="2025-03-01T12:00:00Z, 2025-03-01 12:00 or 01.03.2025 12:00 under " + ", ".join(_TIMES),
            remedy="name the column time_utc",
        )
    clock, back = read_zone(zone), timedelta(minutes=10 if end_stamped else 0)
    with located(file=path):
        starts = [None if t is None else _utc(t, clock, back) for t in table[times].to_pylist()]
    return {
        name: {t: _value(v) for t, v in zip(starts, table[column].to_pylist(), strict=True) if t is not None}
        for column, name in called.items()
        if column != times and name != _WHOSE
    }


def _of_asset(table: Any, called: Mapping[str, str], asset: str | None, path: Path) -> Any:
    """Return the rows of an asset; all rows of a table without ``asset_id``, or of one asset only."""
    column = next((column for column, name in called.items() if name == _WHOSE), None)
    if column is None or asset is None:
        return table
    whose = [str(value) for value in table[column].to_pylist()]
    if asset not in whose and len(set(whose)) > 1:
        raise InputError(
            "the table has several turbines, but not this one",
            file=path,
            field=_WHOSE,
            value=asset,
            allowed=", ".join(sorted(set(whose))[:20]),
            remedy="use the name of the turbine in the table",
        )
    return table.filter([w == asset for w in whose]) if asset in whose else table


def _events(table: Any, called: Mapping[str, str], zone: str, path: Path) -> Mapping[datetime, str]:
    """Return the states of operation of a table of events."""
    column = {name: column for column, name in called.items()}
    chosen = [next(column[n] for n in names if n in column) for names in (BEGINS, ENDS, KINDS)]
    begins, ends, kinds = (table[name].to_pylist() for name in chosen)
    wrong = next((t for t in (*begins, *ends) if t is not None and not isinstance(t, date)), None)
    if wrong is not None:
        raise InputError(
            "not a time",
            file=path,
            field=chosen[0],
            value=wrong,
            allowed="2025-03-01 12:00:00 or with a zone",
        )
    clock = read_zone(zone)
    with located(file=path):
        rows = [
            (_utc(begin, clock), None if end is None else _utc(end, clock), str(kind))
            for begin, end, kind in zip(begins, ends, kinds, strict=True)
            if begin is not None and kind is not None
        ]
        return by_ten_minutes(rows)


IEC_61400_25 = {
    "wtur_w": "power_kw",
    "wtur_turst": "state",
    "wmet_horwdspd": "mean_wind_speed_m_s",
    "wmet_horwddir": "wind_direction_deg",
    "wmet_horwddirrel": "yaw_deg",
    "wmet_envtmp": "air_temperature_c",
    "wrot_rotspd": "rotor_speed_rpm",
    "wrot_blpthangval": "pitch_deg",
    "wnac_wdspd": "nacelle_wind_speed_m_s",
    "wnac_dir": "nacelle_direction_deg",
}
"""Names of IEC 61400-25-2 in the units of OpenOA (kW, m/s, deg, °C, rpm), and their equivalents here."""


def plain_name(column: str) -> str:
    """Return a column's name in lower case with underscores, or the equivalent of one of IEC 61400-25.

    >>> plain_name("Wind Speed (m/s)"), plain_name("WMET.HorWdSpd"), plain_name("WROT_RotSpd")
    ('wind_speed_m_s', 'mean_wind_speed_m_s', 'rotor_speed_rpm')
    """
    plain = _plain(column)
    return IEC_61400_25.get(plain, plain)


def _plain(column: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", column.strip().lower()).strip("_")[:64]


def _read(path: Path) -> Any:
    """Return the table of a delimited file; delimiter and decimal sign are detected from its first lines."""
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


def _utc(time: Any, clock: Any, back: timedelta = timedelta(0)) -> datetime:
    whole = time if isinstance(time, datetime) else datetime(time.year, time.month, time.day)
    return start_in_utc(whole, clock, back) if whole.tzinfo is None else whole.astimezone(UTC) - back


def _value(value: Any) -> Value:
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, bool):
        return str(value)
    return float(value) if isfinite(value) else None
