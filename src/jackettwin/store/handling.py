"""Handling of findings by people: acknowledge, assign, comment, mute, close, reopen, with full history.

A finding is identified by its content, so that its handling remains when its day is advanced anew. Its status
follows from its last entries and not from the clock: an expired mute is ended by an entry.
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
"""Largest length of a key; the columns allow 255, and some keys get a prefix."""
_OF_TOPIC = ("mute", "unmute")
SYSTEM = "jackettwin"
"""Name under which expired mutes are ended."""


def finding_key(row: Mapping[str, Any]) -> str:
    """Return the identity of a finding: asset, day, code and subject."""
    return shortened(f"{row['asset']}/{row['day']}/{row['code']}/{row['subject'] or ''}")


def topic_key(row: Mapping[str, Any]) -> str:
    """Return the key of similar findings of all days, to which a mute applies."""
    return finding_key({**row, "day": ""})


def shortened(key: str) -> str:
    """Return a key that fits into its column; the end of a long one is replaced by a hash."""
    return key if len(key) <= _KEY else f"{key[: _KEY - 65]} {hashlib.sha256(key.encode()).hexdigest()}"


@dataclass(frozen=True)
class Act:
    """A user's action on a finding."""

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
    """Status of a finding after all actions."""

    acknowledged: Act | None = None
    closed: Act | None = None
    assigned_to: str | None = None
    muted_until_utc: datetime | None = None

    @property
    def answered(self) -> bool:
        """Whether somebody has responded, so that it need not be escalated."""
        return self.acknowledged is not None or self.closed is not None

    @property
    def open(self) -> bool:
        """Whether it still needs a response."""
        return not self.answered and self.muted_until_utc is None

    def after(self, act: Act) -> HandlingStatus:
        """Return the status after one more action."""
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
    """All actions on the findings of one asset, or of all, in order."""

    def __init__(self, acts: Iterable[Act]) -> None:
        self._acts: dict[str, list[tuple[int, Act]]] = {}
        for number, act in enumerate(acts):
            self._acts.setdefault(act.alarm_key, []).append((number, act))

    def history(self, row: Mapping[str, Any]) -> list[Act]:
        """Return the actions on a finding, oldest first."""
        mine = self._acts.get(finding_key(row), []) + self._acts.get(topic_key(row), [])
        return [act for _, act in sorted(mine, key=lambda numbered: numbered[0])]

    def standing(self, row: Mapping[str, Any]) -> HandlingStatus:
        """Return the status of a finding."""
        found = HandlingStatus()
        for act in self.history(row):
            found = found.after(act)
        return found

    def over(self, now: datetime) -> list[Act]:
        """Return the expired mutes that were not ended yet."""
        last = [[act for _, act in acts if act.action in _OF_TOPIC][-1:] for acts in self._acts.values()]
        mutes = [act for acts in last for act in acts if act.action == "mute"]
        return [act for act in mutes if act.until_utc is not None and act.until_utc <= now]


_ACT = select(*(handling.c[name] for name in Act.__dataclass_fields__)).order_by(handling.c.id)


def handled(connection: Connection, asset: str | None = None) -> Handled:
    """Return the actions on the findings of an asset, or of all."""
    query = _ACT if asset is None else _ACT.where(handling.c.asset == asset)
    return Handled(Act(**row._mapping) for row in connection.execute(query))


def note(connection: Connection, act: Act) -> None:
    """Store an action."""
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
    """Store an action on a finding; a mute also applies to similar findings of later days."""
    key = topic_key(row) if action in _OF_TOPIC else finding_key(row)
    note(connection, Act(row["asset"], key, action, by, now, comment, to, until))


def mutes_over(connection: Connection, now: datetime) -> list[Act]:
    """Return the expired mutes that were not ended yet."""
    muted = _ACT.where(handling.c.action.in_(_OF_TOPIC))
    return Handled(Act(**row._mapping) for row in connection.execute(muted)).over(now)


def end_mute(connection: Connection, mute: Act, now: datetime) -> None:
    """End an expired mute."""
    note(connection, Act(mute.asset, mute.alarm_key, "unmute", SYSTEM, now))
