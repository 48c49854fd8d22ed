"""Times as loggers write them, and the zones of clocks that do not say theirs.

A stamp is a date with a time, in one column or two, or a time of day alone.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from contextlib import suppress
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np

from jackettwin.constants import DAY_S
from jackettwin.errors import InputError, require

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from jackettwin.arrays import FloatArray

# Day and month with strokes between them stand in either order: 31/01/2025 shows which, 01/02/2025 does not.
_NO_MONTH = r"(?:1[3-9]|2\d|3[01])"
_DAY = (
    r"(?:\d{4}[-/]\d\d[-/]\d\d|\d\d\.\d\d\.\d{4}|"
    rf"{_NO_MONTH}/\d\d?/\d{{4}}|\d\d?/{_NO_MONTH}/\d{{4}})"
)
_CLOCK = r"\d\d?:\d\d:\d\d(?:[.,]\d{1,9})?(?:\s*[AaPp][Mm])?"
_DATE = re.compile(rf"\s*{_DAY}")
_DATE_ALONE = re.compile(rf"\s*{_DAY}\s*")
_CLOCK_ALONE = re.compile(rf"\s*{_CLOCK}\s*")
_CLOCK_OF_A_DATE = re.compile(rf"\s*{_CLOCK}\s*(?:Z|[+-]\d\d:?\d\d)?\s*", re.IGNORECASE)
_ZONED = re.compile(r"(?:Z|[+-]\d\d:?\d\d)\s*$", re.IGNORECASE)
_HALF_DAY = re.compile(r"(?P<hour>\d\d?)(?P<rest>:\d\d:\d\d(?:[.,]\d+)?)\s*(?P<half>[AP])M$", re.IGNORECASE)
_YEAR_LAST = re.compile(r"^(\d\d?)[./](\d\d?)[./](\d{4})")
_MONTH_FIRST = re.compile(rf"\d\d?/{_NO_MONTH}/")
_AMBIGUOUS = re.compile(r"\s*(?P<first>\d\d?)/(?P<second>\d\d?)/(?P<year>\d{4})(?!\d)")
_PLAIN_STAMP = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:[.,]\d{1,9})?)?[Zz]?")


def is_stamp(cell: str) -> bool:
    """Tell whether a cell begins with a date, or is a time of day.

    >>> [is_stamp(text) for text in ("2025-03-17T01:00:00Z", "17.03.2025", "1:00:00,04", "1:2", "0.5")]
    [True, True, True, False, False]
    >>> is_stamp("10/20/2025 1:58:00 PM"), is_stamp("11:58:00 AM")
    (True, True)
    """
    return bool(_DATE.match(cell) or _CLOCK_ALONE.fullmatch(cell))


def has_zone(cell: str) -> bool:
    """Tell whether a cell is a time that says its zone."""
    return bool(_DATE.match(cell) and _ZONED.search(cell) and not _DATE_ALONE.fullmatch(cell))


def ambiguous_date(cell: str) -> tuple[str, str] | None:
    """Return both dates (ISO 8601) a cell may begin with, day first and month first; None if it has one.

    >>> ambiguous_date("02/03/2026 10:00:00")
    ('2026-03-02', '2026-02-03')
    >>> ambiguous_date("31/01/2026"), ambiguous_date("02.03.2026")
    (None, None)
    """
    match = _AMBIGUOUS.match(cell)
    first, second = (int(match["first"]), int(match["second"])) if match else (0, 0)
    if match is None or not (1 <= first <= 12 and 1 <= second <= 12):
        return None
    return f"{match['year']}-{second:02}-{first:02}", f"{match['year']}-{first:02}-{second:02}"


def refuse_ambiguous(cell: str, field: str) -> None:
    """Refuse a date whose day and month may be either way round.

    Raises
    ------
    InputError
        Names the two dates that it may be.
    """
    dates = ambiguous_date(cell)
    require(
        dates is None,
        "date is ambiguous: either its day or its month comes first",
        field=field,
        value=cell.strip(),
        allowed=" or ".join(dict.fromkeys(dates or ())),
        remedy="write the year first in the whole column, or state sample_rate_hz and start_utc",
    )


def with_one_stamp(names: list[str], rows: list[list[str]]) -> tuple[list[str], list[list[str]]]:
    """Return a table in which a date and the time of day in the column behind it are one column."""
    first = rows[0] if rows else []
    for i in range(min(len(first), len(names)) - 1):
        if _DATE_ALONE.fullmatch(first[i]) and _CLOCK_OF_A_DATE.fullmatch(first[i + 1]):
            joined = [[*row[:i], _joined(*row[i : i + 2]), *row[i + 2 :]] for row in rows]
            return [*names[: i + 1], *names[i + 2 :]], joined
    return names, rows


def _joined(day: str = "", clock: str = "") -> str:
    clock = clock.strip()
    return f"{day.strip()} {'0' if clock[1:2] == ':' else ''}{clock}"


def stamps(cells: Sequence[str], line: int) -> npt.NDArray[Any]:
    """Return times, or seconds since midnight where there is no date; ``line`` is that of the first cell.

    Raises
    ------
    InputError
        Names the line of a cell that is no time.
    """
    if _CLOCK_ALONE.fullmatch(cells[0]):
        return _of_day(cells, line)
    month, day = (1, 2) if _MONTH_FIRST.match(cells[0].strip()) else (2, 1)

    def year_first(date: re.Match[str]) -> str:
        return f"{date[3]}-{date[month]:0>2}-{date[day]:0>2}"

    texts = [_YEAR_LAST.sub(year_first, cell.strip()).replace("/", "-") for cell in cells]
    if _HALF_DAY.search(texts[0]):
        texts = [_of_whole_day(text) for text in texts]
    if all(map(_PLAIN_STAMP.fullmatch, texts)):
        with suppress(ValueError):  # a 31st of June: the slow way names its line
            return np.array([text.rstrip("Zz").replace(",", ".") for text in texts], "datetime64[ns]")
    return np.array([_stamp(*pair, line + k) for k, pair in enumerate(zip(texts, cells, strict=True))])


def _of_whole_day(text: str) -> str:
    """Return a text whose time of day ends in AM or PM with hours from 0 to 23 instead, others as given."""

    def hours(match: re.Match[str]) -> str:
        hour = int(match["hour"])
        if not 1 <= hour <= 12:
            return match[0]
        return f"{hour % 12 + (12 if match['half'] in 'Pp' else 0):02}{match['rest']}"

    return _HALF_DAY.sub(hours, text)


def _of_day(cells: Sequence[str], line: int) -> npt.NDArray[np.timedelta64]:
    """Return times of day, which go on after midnight."""
    for k, cell in enumerate(cells):
        if not _CLOCK_ALONE.fullmatch(cell):
            raise InputError(
                "is not a time of day",
                field=f"line {line + k}",
                value=cell,
                allowed="13:00:00.00",
                remedy="mend the cell",
            )
    if _HALF_DAY.search(cells[0].strip()):
        cells = [_of_whole_day(cell.strip()) for cell in cells]
    parts = np.array([cell.replace(",", ".").split(":") for cell in cells], np.float64)
    seconds = parts @ [3600.0, 60.0, 1.0]
    nights = np.cumsum(np.diff(seconds, prepend=seconds[0]) < -0.5 * DAY_S)
    return np.round(1e9 * (seconds + DAY_S * nights)).astype("timedelta64[ns]")


def _stamp(text: str, cell: str, line: int) -> np.datetime64:
    """Return the time of a text with the year first; ``cell`` is what stands in the file."""
    try:
        return np.datetime64(parse_time(text).replace(tzinfo=None), "ns")
    except InputError:
        raise InputError(
            "is no time",
            field=f"line {line}",
            value=cell,
            allowed="2025-01-31T13:00:00Z, 31.01.2025 13:00:00 or 01/31/2025 1:00:00 PM",
            remedy="mend the cell",
        ) from None


_DAYS = ((2e4, 8e4, np.datetime64("1899-12-30")), (6.9e5, 8e5, np.datetime64("0000-01-01") - 1))
"""Days of spreadsheets from 1954 to 2119 and of MATLAB from 1889 to 2190: range, and the date of day zero."""
_LONGEST_STEP = 1e-4
"""Longest step in days; in seconds it is 10,000 samples a second, more than a structure needs."""
COUNTED_DAYS = "counts days as spreadsheets or MATLAB do: read as dates"
"""Remark on a column of such days."""


def day_zero(day: float) -> np.datetime64 | None:
    """Return the date of day zero of days as spreadsheets or MATLAB count them; None of another number.

    >>> [str(day_zero(day) + int(day)) for day in (45300.0, 739260.0)]
    ['2024-01-09', '2024-01-09']
    """
    return next((zero for low, high, zero in _DAYS if low < day < high), None)


def dates_of_days(numbers: FloatArray) -> npt.NDArray[np.datetime64] | None:
    """Return the dates of days as spreadsheets or MATLAB count them, (n_samples,); None of other numbers.

    >>> dates_of_days(45950.5 + np.arange(9) / 25.0 / 86400.0)[5].astype("datetime64[ms]")
    np.datetime64('2025-10-20T12:00:00.200')
    >>> dates_of_days(45950.5 + np.arange(9) / 25.0)  # seconds
    """
    if numbers.size < 2 or not np.isfinite(numbers).all():
        return None
    low, high = numbers.min(), numbers.max()
    zero, last = day_zero(low), day_zero(high)
    if zero is None or zero != last or not 0.0 < high - low < _LONGEST_STEP * (numbers.size - 1):
        return None
    days = np.floor(numbers)
    nanoseconds = np.round((numbers - days) * DAY_S * 1e9).astype("timedelta64[ns]")
    return np.asarray((zero + days.astype("timedelta64[D]")).astype("datetime64[ns]") + nanoseconds)


def parse_time(text: str, *, file: Path | str | None = None) -> datetime:
    """Return an ISO 8601 time in UTC; a time without zone is UTC.

    Raises
    ------
    InputError
        If it is not ISO 8601.
    """
    try:
        time = datetime.fromisoformat(text.strip())
        return time.replace(tzinfo=UTC) if time.tzinfo is None else time.astimezone(UTC)
    except (ValueError, OverflowError):
        raise InputError(
            "is not an ISO 8601 time",
            file=file,
            field="start_utc",
            value=text,
            allowed="2025-01-01T13:00:00Z",
            remedy="write the start in UTC",
        ) from None


_OFFSET = re.compile(
    r"^(?:UTC|GMT)?(?P<sign>[+\-−])(?P<hours>\d{1,2})(?::?(?P<minutes>\d{2}))?$", re.IGNORECASE
)
_UTC = ("utc", "gmt", "z")

UNSAID = (
    "the clock does not say its zone: taken as UTC "
    '("clock" in the JSON beside the file, logger.clock of a twin, or --timezone, says another)'
)
"""Remark on a record whose stamps have no zone."""

_RESTART_S = 60.0
"""Longest time without samples while a clock is put back, as a logger may restart."""
_HOUR_S = 3600.0


TWICE = "the clock's zone has this hour twice: taken as the first (summer time); state start_utc"
"""Remark on a record that begins in an hour in which clocks are put back."""

NEVER = (
    "the clock's zone never has this hour, over which clocks are put forward: the logger's clock was not, "
    "and its time is taken as winter time; state the offset of its clock (--timezone +01:00) or start_utc"
)
"""Remark on a record with stamps in an hour over which clocks are put forward."""

PASSED = (
    "the logger's clock was not put back in the hour that its zone has twice: its time is taken as summer "
    "time; state the offset of its clock (--timezone +01:00) or start_utc"
)
"""Remark on a record with stamps that go on after an hour in which clocks are put back."""


def read_zone(text: str, *, field: str = "clock") -> tzinfo:
    """Return a zone: ``UTC``, an offset (``+02:00``, ``UTC+2``), or a name (``Europe/Berlin``).

    Raises
    ------
    InputError
        If it is none.

    Examples
    --------
    >>> from datetime import datetime
    >>> in_utc(datetime(2025, 6, 1, 14), read_zone("UTC+2")).hour
    12
    """
    text = text.strip()
    if text.lower() in _UTC:
        return UTC
    match = _OFFSET.match(text.replace(" ", ""))
    if match is not None and int(match["hours"]) <= 14:
        offset = timedelta(hours=int(match["hours"]), minutes=int(match["minutes"] or 0))
        return timezone(offset if match["sign"] == "+" else -offset)
    try:
        return ZoneInfo(text)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise InputError(
            "is not a time zone",
            field=field,
            value=text,
            allowed="UTC, an offset like +02:00, or a name like Europe/Berlin",
            remedy="state the zone of the logger's clock",
        ) from None


def in_utc(time: datetime, zone: tzinfo) -> datetime:
    """Return what a clock in a zone shows as UTC; an hour that is there twice is the first."""
    return time.replace(tzinfo=zone).astimezone(UTC)


def steady(
    begin: datetime, times_s: FloatArray | None, zone: tzinfo
) -> tuple[datetime, FloatArray | None, tuple[str, ...]]:
    """Return the start in UTC and the times since then of a local clock, and remarks on its summer time.

    Parameters
    ----------
    begin : datetime
        What the clock shows at the start; its own zone is ignored.
    times_s : (n_samples,) array, optional
        Times since then as the clock shows them [s], from 0 on. An hour over which the clock is put forward
        is taken out.
    """
    local, start = begin.replace(tzinfo=None), in_utc(begin, zone)
    if _skipped(local, zone):
        return start, times_s, (NEVER,)
    if start != in_utc(local.replace(fold=1), zone):
        return start, times_s, (TWICE,)
    if times_s is None or not len(times_s):
        return start, times_s, ()
    shown = np.fmax.accumulate(times_s)  # missing and disordered stamps are for the clock to judge

    def at(k: int) -> datetime:
        return local + timedelta(seconds=float(shown[k]))

    def put_forward_s(k: int) -> float:
        return float(shown[k]) - (in_utc(at(k), zone) - start).total_seconds()

    last, never = len(shown) - 1, (start, times_s, (NEVER,))
    forward_s = put_forward_s(last)
    if _skipped(at(last), zone):
        return never
    if forward_s < -1.0:
        return start, times_s, (PASSED,)
    if forward_s < 1.0:
        return start, times_s, ()
    after = bisect_left(range(len(shown)), 1.0, key=put_forward_s)
    if _skipped(at(after - 1), zone):
        return never
    return start, np.where(np.arange(len(shown)) < after, times_s, times_s - forward_s), ()


def refuse_put_back(times_s: FloatArray | None) -> None:
    """Refuse stamps of a clock that is put back by an hour and does not say its zone.

    Raises
    ------
    InputError
        Asks for the zone.
    """
    require(
        put_back_at(times_s) is None,
        "the clock is put back by an hour, and does not say its zone",
        field="time",
        allowed="a clock of a known zone where it is put back",
        remedy="state the zone: --timezone Europe/Berlin (identify, init), logger.clock of a twin, "
        'or "clock" in the JSON beside the file',
    )


def put_back_at(times_s: FloatArray | None) -> int | None:
    """Return the first sample after the only step back of stamps, if it is by an hour; else None.

    Parameters
    ----------
    times_s : (n_samples,) array, optional
        What the clock shows [s].
    """
    if times_s is None:
        return None
    back = np.flatnonzero(np.diff(times_s) < 0.0)
    if len(back) != 1:
        return None
    after = int(back[0]) + 1
    return after if 0.0 < times_s[after] + _HOUR_S - times_s[after - 1] < _RESTART_S else None


def unfolded(begin: datetime, times_s: FloatArray | None, zone: tzinfo) -> FloatArray | None:
    """Return the times since the start of a clock that is put back in the hour that its zone has twice.

    None if it is not; arguments are those of :func:`steady`.
    """
    after = put_back_at(times_s)
    if times_s is None or after is None:
        return None
    for k in (after - 1, after):
        shown = begin.replace(tzinfo=None) + timedelta(seconds=float(times_s[k]))
        if (in_utc(shown.replace(fold=1), zone) - in_utc(shown, zone)).total_seconds() != _HOUR_S:
            return None
    return np.where(np.arange(len(times_s)) < after, times_s, times_s + _HOUR_S)


def start_in_utc(end: datetime, zone: tzinfo, lasted: timedelta) -> datetime:
    """Return the start in UTC of an interval whose end a clock in a zone shows.

    Raises
    ------
    InputError
        If clocks in the zone show neither its end nor its start, as they are put forward over both.

    >>> from datetime import datetime, timedelta
    >>> start_in_utc(datetime(2025, 3, 30, 3), read_zone("Europe/Berlin"), timedelta(minutes=10)).minute
    50
    """
    require(
        not (_skipped(end, zone) and _skipped(end - lasted, zone)),
        "its zone never has this time, over which clocks are put forward: the clock was not",
        field="time",
        value=end.isoformat(" "),
        allowed=f"what clocks in {zone} show",
        remedy="state the offset of the clock as its zone, e.g. +01:00",
    )
    return in_utc(end, zone) - lasted


def _skipped(time: datetime, zone: tzinfo) -> bool:
    """Tell whether clocks in a zone never show a time because they are put forward over it."""
    return in_utc(time, zone).astimezone(zone).replace(tzinfo=None) != time.replace(tzinfo=None)
