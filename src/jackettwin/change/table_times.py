"""Times of the rows of a table, in common notations and in one column or several."""

from __future__ import annotations

import re
from datetime import UTC, datetime, tzinfo
from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, require
from jackettwin.records import day_zero, parse_time

Stamps = npt.NDArray[np.datetime64]
Stored = dict[str, npt.NDArray[Any]]

_TIMES = ("timeutc", "time", "timestamp", "datetime", "datetimeutc", "utc", "date", "datum", "zeit")
"""Names of columns of times, in letters only, the likeliest first; others are recognised by content."""
_UTC_NAMES = ("timeutc", "datetimeutc", "utc")
_NUMBERED = ("t", "days", "day")
_PARTS = ("year", "month", "day", "hour", "minute", "second")
_DATES = ("%d.%m.%Y", "%Y/%m/%d", "%d/%m/%Y", "%m/%d/%Y", "%d-%m-%Y", "%d-%b-%Y", "%d %b %Y", "%Y%m%d")
_CLOCKS = ("", " %H:%M", " %H:%M:%S", " %H:%M:%S.%f", " %I:%M %p", " %I:%M:%S %p", "T%H:%M:%S", "T%H%M%S")
_CLOCK = re.compile(r"\d\d?:\d\d(:\d\d([.,]\d+)?)?( ?[AP]M)?", re.IGNORECASE)
_ZONED = re.compile(r":\d\d.*(Z|[+-]\d\d:?\d\d)$")
_UNIX = ((1e8, 1e11, 1e3), (1e11, 1e14, 1.0), (1e14, 1e17, 1e-3), (1e17, 1e20, 1e-6))
"""Unix seconds, milli-, micro- and nanoseconds: range, and milliseconds in one."""
_ALLOWED = "ISO 8601: 2025-01-01T13:00:00Z"
_HOUR = np.timedelta64(1, "h")
_UNSAID = 'the times do not say their zone: taken as UTC (another by --timezone, or a column "time_utc")'


def table_times(
    stored: Stored, zone: tzinfo | None = None
) -> tuple[tuple[str, ...], Stamps, tuple[str, ...]]:
    """Return the columns that hold the times, the times in UTC to the millisecond, ascending, and remarks.

    Parameters
    ----------
    zone : of the clock, if the times do not say it; None for UTC

    Raises
    ------
    InputError
        If there are none, one is missing or no time, they are not sorted, or their clock is put back and its
        zone is not known; names the column.
    """
    names, cells = _column(stored)
    said: tuple[str, ...] = ()
    with located(field=names[0]):
        stamps = _stamps(names[0], cells)
        if np.isnat(stamps).any():
            row = int(np.flatnonzero(np.isnat(stamps))[0]) + 2
            raise InputError("a row without a time", value=f"line {row}", remedy="leave the row out")
        if not _says_its_zone(names[0], cells):
            stamps, said = (stamps, (_UNSAID,)) if zone is None else _of_clock(stamps, zone)
        elif zone is not None:
            raise InputError("the times say their zone", field="--timezone", remedy="leave the option out")
        backwards = np.flatnonzero(np.diff(stamps) < np.timedelta64(0))
        if backwards.size:
            before, after = stamps[backwards[0]], stamps[backwards[0] + 1]
            by_an_hour = zone is None and bool(said) and before - after <= _HOUR
            raise InputError(
                "times are not sorted", value=f"{after} after {before}", allowed="ascending",
                remedy="if a clock was put back, state its zone: --timezone Europe/Berlin; else sort the rows"
                if by_an_hour else "sort the rows by time",
            )  # fmt: skip
    return names, stamps, said


def _says_its_zone(name: str, cells: npt.NDArray[Any]) -> bool:
    """Tell whether times are instants: by their column's name, each by itself, as Unix times or days."""
    if cells.dtype.kind == "f":
        typical = float(np.nanmedian(cells))
        return day_zero(typical) is None
    zoned = cells.dtype.kind == "U" and bool(_ZONED.search(cells[0]))
    return zoned or re.sub(r"[^a-z]", "", name.lower()) in _UTC_NAMES


def _of_clock(shown: Stamps, zone: tzinfo) -> tuple[Stamps, tuple[str, ...]]:
    """Return what a clock shows in UTC, and a remark on an hour that its zone has twice.

    In that hour the second begins where the clock is put back between two rows; without such rows all are
    taken as summer time.
    """
    clocks, place = np.unique(shown, return_inverse=True)
    local = clocks.tolist()
    moments = ([t.replace(tzinfo=zone, fold=fold).astimezone(UTC) for t in local] for fold in (0, 1))
    first, second = (np.array([t.replace(tzinfo=None) for t in one], "datetime64[ms]") for one in moments)
    never = np.flatnonzero(second < first)  # clocks are put forward over it
    require(
        not never.size, "its zone never has this time, over which clocks are put forward: the clock was not",
        value=str(clocks[never[0]]) if never.size else "", allowed=f"what clocks in {zone} show",
        remedy="state the offset of the clock: --timezone +01:00",
    )  # fmt: skip
    stamps, again = first[place], second[place]
    twice, back = stamps != again, np.append(False, np.diff(shown) < np.timedelta64(0))
    unsure = 0
    for night in np.unique(shown[twice].astype("datetime64[D]")):
        rows = np.flatnonzero(twice & (shown.astype("datetime64[D]") == night))
        later = np.cumsum(back[rows]) > 0
        stamps[rows[later]] = again[rows[later]]
        unsure += 0 if later.any() else rows.size
    said = f"{unsure} rows lie in an hour that the clock's zone has twice: taken as the first (summer time)"
    return stamps, (said,) if unsure else ()


def _column(stored: Stored) -> tuple[tuple[str, ...], npt.NDArray[Any]]:
    """Return the names of the columns of times, and their cells as one column."""
    letters = {re.sub(r"[^a-z]", "", name.lower()): name for name in reversed(stored)}
    if all(part in letters and stored[letters[part]].dtype.kind == "f" for part in _PARTS[:3]):
        return _of_parts(stored, tuple(letters[part] for part in _PARTS if part in letters))
    named = [letters[name] for name in _TIMES if name in letters]
    words = [n for n in (*named, *stored) if stored[n].dtype.kind == "U"]
    clock = next((n for n in words if _CLOCK.fullmatch(stored[n][0])), None)
    dated = next((n for n in words if n != clock and _is_time(str(stored[n][0]))), None)
    if clock is not None and dated is not None and ":" not in stored[dated][0]:
        return (dated, clock), np.char.add(np.char.add(stored[dated], " "), stored[clock])
    stamped = (n for n, x in stored.items() if x.dtype.kind == "M")
    numbered = (letters[n] for n in _NUMBERED if n in letters)
    name = next(iter((*named, *stamped, *([] if dated is None else [dated]), *numbered)), None)
    if name is None:
        raise InputError(
            "no column of times", field="time_utc", value=", ".join(stored), allowed="ISO 8601 in UTC",
            remedy="name the column of times time_utc",
        )  # fmt: skip
    return (name,), stored[name]


def _of_parts(stored: Stored, names: tuple[str, ...]) -> tuple[tuple[str, ...], npt.NDArray[Any]]:
    """Return times from columns of years, months, days and perhaps hours, minutes and seconds."""
    year, month, day, *clock = (stored[name] for name in names)
    whole = np.array([f"{y:.0f}-{m:02.0f}-{d:02.0f}" for y, m, d in zip(year, month, day, strict=True)])
    with located(field=", ".join(names)):
        try:
            stamps = whole.astype("datetime64[ms]")
        except ValueError as error:
            raise InputError("is no time", value=str(error), allowed="a year, month and day") from None
    for part, milliseconds in zip(clock, (3.6e6, 6e4, 1e3), strict=False):
        stamps = stamps + np.round(part * milliseconds).astype("timedelta64[ms]")
    return names, stamps


def _stamps(name: str, x: npt.NDArray[Any]) -> Stamps:
    if x.dtype.kind == "M":
        return x.astype("datetime64[ms]")
    if x.dtype.kind == "f":
        return _numbered(name, x)
    zoned = np.array([bool(_ZONED.search(w)) for w in x])
    if zoned.any() and not zoned.all():
        raise InputError(
            "some times have a zone and some have none", value=str(x[np.argmin(zoned)]), allowed="one way",
            remedy="write all times in UTC, or all with their zone",
        )  # fmt: skip
    if _iso(str(x[0])) is not None:
        return np.array([_parsed(str(w)) for w in x], "datetime64[ms]")
    return _formatted([str(w).replace(",", ".") for w in x])


def _iso(text: str) -> datetime | None:
    try:
        return parse_time(text).replace(tzinfo=None)
    except InputError:
        return None


def _is_time(text: str) -> bool:
    return _iso(text) is not None or bool(_ways(text))


def _ways(text: str) -> list[str]:
    """Return the formats that a description of a time may mean."""
    ways = ("".join(parts) for parts in product(_DATES, _CLOCKS))
    return [way for way in ways if _under(way, [text]) is not None]


def _under(way: str, texts: list[str]) -> Stamps | None:
    """Return texts as times in one format; None if one does not fit."""
    try:
        return np.array([datetime.strptime(text, way) for text in texts], "datetime64[ms]")
    except ValueError:
        return None


def _formatted(texts: list[str]) -> Stamps:
    """Return times that all have one format and ascend in it; None if two such formats fit."""
    ways = _ways(texts[0])
    found = [stamps for way in ways if (stamps := _under(way, texts)) is not None]
    if not found:
        bad = next((t for t in texts if not any(_under(way, [t]) is not None for way in ways)), texts[0])
        raise InputError("is no time", value=bad, allowed=_ALLOWED, remedy="write all times so")
    ascending = [stamps for stamps in found if (np.diff(stamps) >= np.timedelta64(0)).all()] or found[:1]
    if len(ascending) > 1:
        raise InputError(
            "days and months may be meant either way", value=texts[0], allowed=_ALLOWED,
            remedy="write the year first",
        )  # fmt: skip
    return ascending[0]


def _parsed(text: str) -> datetime:
    time = _iso(text)
    if time is None:
        raise InputError("is no time", value=text, allowed=_ALLOWED, remedy="write all times so")
    return time


def _numbered(name: str, x: FloatArray) -> Stamps:
    """Return times from numbers: Unix times, Excel's or MATLAB's days, or days of a column called so."""
    typical = float(np.nanmedian(x))
    start, milliseconds = day_zero(typical), x * 86400e3
    for low, high, unit in _UNIX:
        if low < typical < high:
            start, milliseconds = np.datetime64(0, "ms"), unit * x
    if start is None and "day" in name.lower():
        start = np.datetime64("2000-01-01")
    if start is None:
        raise InputError(
            "numbers whose origin is not known", value=typical,
            allowed="ISO 8601, Unix, Excel or MATLAB times, or days",
            remedy="write the times as 2025-01-01T13:00:00Z",
        )  # fmt: skip
    whole = np.where(np.isfinite(milliseconds), np.round(milliseconds), 0).astype(np.int64)
    stamps: Stamps = start.astype("datetime64[ms]") + whole.astype("timedelta64[ms]")
    stamps[~np.isfinite(milliseconds)] = np.datetime64("NaT")
    return stamps
