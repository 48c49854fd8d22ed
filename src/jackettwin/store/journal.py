"""Events in order of their commits, for all servers of one database."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import Connection, delete, func, insert, select, text

from jackettwin.store.tables import events

KINDS = ("record", "observation", "state", "finding", "job", "asset")
KEPT = timedelta(days=2)
"""Time for which a disconnected client can still receive all events."""


@dataclass(frozen=True)
class Event:
    """An event of an asset."""

    id: int
    time_utc: datetime
    kind: str
    asset: str
    payload: dict[str, Any]


def tell(connection: Connection, kind: str, asset: str, payload: Mapping[str, Any], now: datetime) -> None:
    """Add an event in the transaction of its cause.

    PostgreSQL assigns numbers before commits; a lock makes events visible in order, so that a client that
    continues from the last number misses none.
    """
    if connection.dialect.name == "postgresql":
        connection.execute(text("select pg_advisory_xact_lock(740114)"))
    connection.execute(insert(events).values(time_utc=now, kind=kind, asset=asset, payload=dict(payload)))


def events_after(connection: Connection, last: int, limit: int = 500) -> list[Event]:
    """Return the events after a number, oldest first."""
    rows = connection.execute(select(events).where(events.c.id > last).order_by(events.c.id).limit(limit))
    return [Event(**row._mapping) for row in rows]


def assets_after(connection: Connection, last: int) -> set[str]:
    """Return the assets with events after a number."""
    return set(connection.scalars(select(events.c.asset).where(events.c.id > last).distinct()))


def last_event(connection: Connection, asset: str | None = None) -> int:
    """Return the number of the newest event, of all assets or of one, 0 before the first."""
    query = select(func.max(events.c.id))
    return connection.scalar(query if asset is None else query.where(events.c.asset == asset)) or 0


def forget_events(connection: Connection, now: datetime) -> None:
    """Delete old events except the newest of each asset, which is the version of its responses."""
    newest = select(func.max(events.c.id)).group_by(events.c.asset)
    old = (events.c.time_utc < now - KEPT, events.c.id.not_in(newest))
    connection.execute(delete(events).where(*old))
