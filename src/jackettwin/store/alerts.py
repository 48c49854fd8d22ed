"""What is to be told to people, once for each channel and finding."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import Connection, func, select, update

from jackettwin.store import handling
from jackettwin.store.database import insert_new
from jackettwin.store.tables import alerts, assets, findings, versions

WAITING, SENT, GIVEN_UP, WITHDRAWN = "waiting", "sent", "given_up", "withdrawn"
LOOK_BACK = 1000
"""Findings that may become visible after later ones: PostgreSQL numbers them before transactions end."""


@dataclass(frozen=True)
class Alert:
    """One finding on its way through one channel.

    Attributes
    ----------
    key : what is told once
    message : the finding in plain values, with the ``key`` by which it is known whatever its number becomes
    due_utc : before which it is not told
    problem : why the last try failed
    """

    id: int
    channel: str
    key: str
    asset: str
    message: dict[str, Any]
    state: str
    tries: int
    created_utc: datetime
    due_utc: datetime
    ended_utc: datetime | None
    problem: str | None


def add(
    connection: Connection,
    channel: str,
    key: str,
    asset: str,
    message: Mapping[str, Any],
    now: datetime,
    due: datetime,
) -> bool:
    """Have a finding told through a channel; False if it was before, or is already on its way."""
    row = {"channel": channel, "key": key, "asset": asset, "message": dict(message)}
    return insert_new(
        connection, alerts, {**row, "state": WAITING, "tries": 0, "created_utc": now, "due_utc": due}
    )


def due(connection: Connection, now: datetime) -> list[Alert]:
    """Return what is to be told by now, oldest first."""
    query = select(alerts).where(alerts.c.state == WAITING, alerts.c.due_utc <= now).order_by(alerts.c.id)
    return [Alert(**row._mapping) for row in connection.execute(query)]


def newest(connection: Connection, limit: int) -> list[Alert]:
    """Return what was or is to be told, newest first."""
    query = select(alerts).order_by(alerts.c.id.desc()).limit(limit)
    return [Alert(**row._mapping) for row in connection.execute(query)]


def end(connection: Connection, ids: Collection[int], state: str, now: datetime) -> None:
    """Say that nothing is left to do for some."""
    connection.execute(update(alerts).where(alerts.c.id.in_(ids)).values(state=state, ended_utc=now))


def try_again(connection: Connection, ids: Collection[int], at: datetime, problem: str) -> None:
    """Count a try that failed, and say when the next one is."""
    changed = {"tries": alerts.c.tries + 1, "due_utc": at, "problem": problem[:500]}
    connection.execute(update(alerts).where(alerts.c.id.in_(ids)).values(**changed))


def count(connection: Connection) -> dict[str, int]:
    """Return how many there are of each state."""
    query = select(alerts.c.state, func.count()).group_by(alerts.c.state)
    found = {state: n for state, n in connection.execute(query)}
    return {state: found.get(state, 0) for state in (WAITING, SENT, GIVEN_UP, WITHDRAWN)}


def newest_finding(connection: Connection) -> int:
    """Return the number of the newest finding, 0 before the first."""
    return connection.scalar(select(func.max(findings.c.id))) or 0


def findings_after(connection: Connection, last: int) -> list[dict[str, Any]]:
    """Return what the adopted versions of living assets found after a number, oldest first."""
    own = (versions.c.asset == assets.c.name) & (versions.c.version == assets.c.adopted_version)
    same = (findings.c.asset == versions.c.asset) & (findings.c.model_hash == versions.c.model_hash)
    query = select(findings).select_from(assets.join(versions, own).join(findings, same))
    new = (findings.c.id > last, assets.c.archived_utc.is_(None))
    return [dict(row._mapping) for row in connection.execute(query.where(*new).order_by(findings.c.id))]


def finding_of(alert: Alert) -> dict[str, Any]:
    """Return what the finding that an alert tells is known by."""
    return {"asset": alert.asset, **{name: alert.message[name] for name in ("day", "code", "subject")}}


def still_found(connection: Connection, alert: Alert) -> bool:
    """Tell whether what an alert says is still found: a late record may have undone it."""
    query = select(findings).filter_by(asset=alert.asset, code=alert.message["code"])
    query = query.where(findings.c.day == alert.message["day"])
    key = alert.message["key"]
    return any(handling.finding_key(dict(row._mapping)) == key for row in connection.execute(query))
