"""Stops and curtailments of a turbine, as SCADA lists them, to states of operation by ten minutes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import UTC, datetime, timedelta

from jackettwin.errors import InputError

BEGINS = ("begin", "begin_utc", "start", "start_utc", "start_time", "time_on", "beginn", "from")
ENDS = ("end", "end_utc", "stop_utc", "end_time", "time_off", "ende", "to")
KINDS = ("category", "iec_category", "event", "state", "status", "description", "code")
"""Accepted names of columns, in small letters and underscores; the first match counts."""
INTERVAL = timedelta(minutes=10)
CHANGING = "changing"
"""The state of ten minutes that an event does not fill: no record in them is of one state."""
_STATES = {
    "curtailed": ("curtail", "derat", "partial performance", "reduced", "limited", "abgeregelt"),
    "stopped": (
        *("stop", "outage", "maintenance", "fault", "standby", "pause", "shutdown", "suspended"),
        *("emergency", "out of environmental", "out of electrical", "service", "wartung"),
    ),
}
"""States by words that their events are told with, among them the categories of IEC 61400-26-1."""
_LONGEST = timedelta(days=366)


def is_of_events(names: Iterable[str]) -> bool:
    """Tell whether a table with columns of these names lists events: when they began and ended, and what."""
    known = set(names)
    return all(known & set(wanted) for wanted in (BEGINS, ENDS, KINDS))


def state_of(event: str) -> str:
    """Return the state of operation of an event, its own words if they are none of the known ones.

    >>> state_of("Forced outage"), state_of("Curtailment by grid operator"), state_of("Ice")
    ('stopped', 'curtailed', 'ice')
    """
    said = event.strip().lower()
    fitting = (state for state, words in _STATES.items() if any(word in said for word in words))
    return next(fitting, said[:64])


def by_ten_minutes(events: Iterable[tuple[datetime, datetime | None, str]]) -> Mapping[datetime, str]:
    """Return the state of operation of every ten minutes (UTC) that an event reaches into.

    Parameters
    ----------
    events : (begin, end, what) in UTC; one without an end lasts until the last time that the table tells

    Raises
    ------
    InputError
        If an event ends before it begins, or lasts longer than a year.
    """
    given = list(events)
    last = max((time for begin, end, _ in given for time in (begin, end) if time is not None), default=None)
    found: dict[datetime, str] = {}
    for begin, end, what in given:
        until = end or last or begin
        if not timedelta(0) <= until - begin <= _LONGEST:
            raise InputError(
                "an event ends before it begins, or lasts longer than a year",
                field="end",
                value=f"{begin.isoformat()} to {until.isoformat()}",
                remedy="mend the line",
            )
        interval = begin - (begin - datetime(1970, 1, 1, tzinfo=UTC)) % INTERVAL
        while interval < until:
            whole = begin <= interval and interval + INTERVAL <= until
            state = state_of(what) if whole else CHANGING
            if found.get(interval) != "stopped":  # nothing is more than that
                found[interval] = state
            interval += INTERVAL
    return found
