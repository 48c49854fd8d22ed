"""Alarms through time: each day raises one, or is another look at the last."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from jackettwin.change.reversals import EarlierAlarm, past_of
from jackettwin.change.watch_document import with_later_look
from jackettwin.watching import (
    Change,
    History,
    Look,
    PendingChange,
    Watch,
    continues,
    look_again,
    step,
)

Tell = Callable[[Watch, Change, Sequence[EarlierAlarm]], Mapping[str, Any]]
"""Returns the document of a change as it looks on a day, after earlier alarms."""


@dataclass(frozen=True)
class Alarms:
    """Alarms so far.

    Attributes
    ----------
    documents : of each, in the order of time
    pending : the last one's change, while it is looked at again
    looked : how it looked each time, as documents
    """

    documents: tuple[Mapping[str, Any], ...] = ()
    pending: PendingChange | None = None
    looked: tuple[Mapping[str, Any], ...] = ()


def followed(
    watch: Watch, alarms: Alarms, day: History, tell: Tell, time: Callable[[float], datetime]
) -> tuple[Watch, Alarms, Look]:
    """Return the state and the alarms after one more day, and the day's result.

    Parameters
    ----------
    time : returns the time of a day number
    """
    watch, look = step(watch, day)
    told, pending, looked = alarms.documents, alarms.pending, alarms.looked
    if pending is not None:
        pending, change = look_again(pending, day)
        if change is not None:
            looked = (*looked, tell(watch, change, [past_of(one) for one in told[:-1]]))
            told = (*told[:-1], with_later_look(told[-1], looked[-1]))
    if look.change is not None and alarms.pending is not None and continues(alarms.pending, look.change):
        # more of the pending change appeared: its looks begin anew
        pending = replace(pending or alarms.pending, alarmed=look.change.day, looked=look.change.day)
    elif look.change is not None:
        if told:
            told = (*told[:-1], _before(told[-1], looked, look.change, time))
        looked, pending = (tell(watch, look.change, [past_of(one) for one in told]),), look.pending
        told = (*told, *looked)
    return watch, Alarms(told, pending, looked), look


def _before(
    alarm: Mapping[str, Any],
    looked: Sequence[Mapping[str, Any]],
    later: Change,
    time: Callable[[float], datetime],
) -> Mapping[str, Any]:
    """Return the document of an alarm as it last looked before another change began.

    Looks after that take both for one step: of ice that fell off after a week a month leaves a quarter.
    """
    began = time(later.began).isoformat()
    sound = [one for one in looked if one["looked_utc"] <= began] or looked[:1]
    if later.kind == "scatter" or not sound or sound[-1] is looked[-1]:
        return alarm
    (verdict,) = sound[-1]["verdicts"]
    verdict = {**verdict, "time_utc": time(later.day).isoformat()}
    return with_later_look(alarm, {**sound[-1], "verdicts": [verdict]})
