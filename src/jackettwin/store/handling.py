"""What people do with findings: acknowledge, assign, comment, mute, close, open again. Nothing is forgotten.

A finding is known by its content, so that it keeps what people did with it when its day is advanced anew.
How it stands is what its last lines say; no clock is asked: a mute whose time is over is ended by a line.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from sqlalchemy import Connection, insert, select

from jackettwin.store.tables import handling

_KEY = 240
"""Characters of a key: the tables have room for 255, and something is put before some."""
_OF_TOPIC = ("mute", "unmute")
SYSTEM = "jackettwin"
"""Who ends a mute whose time is over."""


def finding_key(row: Mapping[str, Any]) -> str:
    """Return what a finding is known by: where, which day, what, of what."""
    return shortened(f"{row['asset']}/{row['day']}/{row['code']}/{row['subject'] or ''}")


def topic_key(row: Mapping[str, Any]) -> str:
    """Return what a finding has in common with those of other days; what is muted is all of them."""
    return finding_key({**row, "day": ""})


def shortened(key: str) -> str:
    """Return a key that fits into its column: the end of a long one is told by a hash."""
    return key if len(key) <= _KEY else f"{key[: _KEY - 65]} {hashlib.sha256(key.encode()).hexdigest()}"


@dataclass(frozen=True)
class Act:
    """What somebody did with a finding."""

    asset: str
    alarm_key: str
    action: str
    by: str
    time_utc: datetime
    comment: str = ""
    to: str | None = None
    until_utc: datetime | None = None


@dataclass(frozen=True)
class HandlingStatus:
    """How a finding stands after all that was done with it."""

    acknowledged: Act | None = None
    closed: Act | None = None
    assigned_to: str | None = None
    muted_until_utc: datetime | None = None

    @property
    def answered(self) -> bool:
        """Whether somebody took note of it: nobody else need be woken."""
        return self.acknowledged is not None or self.closed is not None

    @property
    def open(self) -> bool:
        """Whether it waits for somebody to take note of it."""
        return not self.answered and self.muted_until_utc is None

    def after(self, act: Act) -> HandlingStatus:
        """Return how it stands after one more act."""
        match act.action:
            case "acknowledge":
                return replace(self, acknowledged=act)
            case "assign":
                return replace(self, assigned_to=act.to)
            case "mute":
                return replace(self, muted_until_utc=act.until_utc)
            case "unmute":
                return replace(self, muted_until_utc=None)
            case "close":
                return replace(self, closed=act)
            case "reopen":
                return replace(self, closed=None, acknowledged=None)
            case _:
                return self


class Handled:
    """All that was done with the findings of one asset, or of all, in its order."""

    def __init__(self, acts: Iterable[Act]) -> None:
        self._acts: dict[str, list[tuple[int, Act]]] = {}
        for number, act in enumerate(acts):
            self._acts.setdefault(act.alarm_key, []).append((number, act))

    def history(self, row: Mapping[str, Any]) -> list[Act]:
        """Return what was done with a finding, oldest first."""
        mine = self._acts.get(finding_key(row), []) + self._acts.get(topic_key(row), [])
        return [act for _, act in sorted(mine, key=lambda numbered: numbered[0])]

    def standing(self, row: Mapping[str, Any]) -> HandlingStatus:
        """Return how a finding stands."""
        found = HandlingStatus()
        for act in self.history(row):
            found = found.after(act)
        return found

    def over(self, now: datetime) -> list[Act]:
        """Return the mutes whose time is over and that nobody ended yet."""
        last = [[act for _, act in acts if act.action in _OF_TOPIC][-1:] for acts in self._acts.values()]
        mutes = [act for acts in last for act in acts if act.action == "mute"]
        return [act for act in mutes if act.until_utc is not None and act.until_utc <= now]


_ACT = select(*(handling.c[name] for name in Act.__dataclass_fields__)).order_by(handling.c.id)


def handled(connection: Connection, asset: str | None = None) -> Handled:
    """Return what was done with the findings of an asset, or of all."""
    query = _ACT if asset is None else _ACT.where(handling.c.asset == asset)
    return Handled(Act(**row._mapping) for row in connection.execute(query))


def note(connection: Connection, act: Act) -> None:
    """Keep what somebody did."""
    connection.execute(insert(handling).values(**vars(act)))


def act_on(
    connection: Connection,
    row: Mapping[str, Any],
    action: str,
    by: str,
    now: datetime,
    *,
    comment: str = "",
    to: str | None = None,
    until: datetime | None = None,
) -> None:
    """Keep what somebody did with a finding; a mute is of its topic, so of later days as well."""
    key = topic_key(row) if action in _OF_TOPIC else finding_key(row)
    note(connection, Act(row["asset"], key, action, by, now, comment, to, until))


def mutes_over(connection: Connection, now: datetime) -> list[Act]:
    """Return the mutes whose time is over and that nobody ended yet."""
    muted = _ACT.where(handling.c.action.in_(_OF_TOPIC))
    return Handled(Act(**row._mapping) for row in connection.execute(muted)).over(now)


def end_mute(connection: Connection, mute: Act, now: datetime) -> None:
    """End a mute whose time is over."""
    note(connection, Act(mute.asset, mute.alarm_key, "unmute", SYSTEM, now))
