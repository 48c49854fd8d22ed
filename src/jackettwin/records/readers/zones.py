"""Time zones of clocks that do not say theirs."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from jackettwin.errors import InputError

_OFFSET = re.compile(
    r"^(?:UTC|GMT)?(?P<sign>[+\-−])(?P<hours>\d{1,2})(?::?(?P<minutes>\d{2}))?$", re.IGNORECASE
)
_UTC = ("utc", "gmt", "z")

UNSAID = (
    "the clock does not say its zone: taken as UTC "
    '("clock" in the JSON beside the file, logger.clock of a twin, or --timezone, says another)'
)
"""Remark on a record whose stamps have no zone."""

TWICE = "the clock's zone has this hour twice, or never: taken as the first (summer time); state start_utc"
"""Remark on a record that begins in an hour in which clocks are put back or forward."""


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
