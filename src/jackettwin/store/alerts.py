"""Alerts to send, one for each channel and finding."""

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
"""Number of findings that may become visible after later ones, as PostgreSQL numbers them before commits."""


@dataclass(frozen=True)
class Alert:
    """Alert on one finding through one channel.

    Attributes
    ----------
    key : identity of the alert, which is sent once
    message : the finding as plain values, with its ``key``, which does not change with its number
    due_utc : earliest time of sending
    problem : reason why the last try failed
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
    """Add an alert on a finding through a channel; return False if there is one already."""
    row = {"channel": channel, "key": key, "asset": asset, "message": dict(message)}
    return insert_new(
        connection, alerts, {**row, "state": WAITING, "tries": 0, "created_utc": now, "due_utc": due}
    )


def due(connection: Connection, now: datetime) -> list[Alert]:
    """Return the due alerts, oldest first."""
    query = select(alerts).where(alerts.c.state == WAITING, alerts.c.due_utc <= now).order_by(alerts.c.id)
    return [Alert(**row._mapping) for row in connection.execute(query)]


def newest(connection: Connection, limit: int) -> list[Alert]:
    """Return alerts of all states, newest first."""
    query = select(alerts).order_by(alerts.c.id.desc()).limit(limit)
    return [Alert(**row._mapping) for row in connection.execute(query)]


def end(connection: Connection, ids: Collection[int], state: str, now: datetime) -> None:
    """Set the final state of some alerts."""
    connection.execute(update(alerts).where(alerts.c.id.in_(ids)).values(state=state, ended_utc=now))


def try_again(connection: Connection, ids: Collection[int], at: datetime, problem: str) -> None:
    """Count a failed try, and set the time of the next one."""
    changed = {"tries": alerts.c.tries + 1, "due_utc": at, "problem": problem[:500]}
    connection.execute(update(alerts).where(alerts.c.id.in_(ids)).values(**changed))


def count(connection: Connection) -> dict[str, int]:
    """Return the number of alerts of each state."""
    query = select(alerts.c.state, func.count()).group_by(alerts.c.state)
    found = {state: n for state, n in connection.execute(query)}
    return {state: found.get(state, 0) for state in (WAITING, SENT, GIVEN_UP, WITHDRAWN)}


def newest_finding(connection: Connection) -> int:
    """Return the number of the newest finding, 0 before the first."""
    return connection.scalar(select(func.max(findings.c.id))) or 0


def findings_after(connection: Connection, last: int) -> list[dict[str, Any]]:
    """Return findings after a number, of adopted versions of living assets, oldest first."""
    own = (versions.c.asset == assets.c.name) & (versions.c.version == assets.c.adopted_version)
    same = (findings.c.asset == versions.c.asset) & (findings.c.model_hash == versions.c.model_hash)
    query = select(findings).select_from(assets.join(versions, own).join(findings, same))
    new = (findings.c.id > last, assets.c.archived_utc.is_(None))
    return [dict(row._mapping) for row in connection.execute(query.where(*new).order_by(findings.c.id))]


def finding_of(alert: Alert) -> dict[str, Any]:
    """Return the identity of an alert's finding."""
    return {"asset": alert.asset, **{name: alert.message[name] for name in ("day", "code", "subject")}}


def still_found(connection: Connection, alert: Alert) -> bool:
    """Return whether an alert's finding still exists; a late record may have removed it."""
    query = select(findings).filter_by(asset=alert.asset, code=alert.message["code"])
    query = query.where(findings.c.day == alert.message["day"])
    key = alert.message["key"]
    return any(handling.finding_key(dict(row._mapping)) == key for row in connection.execute(query))
