"""Records by content, with their time and status."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import Column, ColumnElement, Connection, Select, Update, func, select, tuple_, update

from jackettwin.errors import InputError
from jackettwin.store.database import insert_new
from jackettwin.store.tables import records

STATUSES = ("received", "observing", "observed", "refused", "mismatched", "set_aside")


@dataclass(frozen=True)
class StoredRecord:
    """A row of the table of records."""

    asset: str
    record_id: str
    status: str
    start_utc: datetime
    duration_s: float
    sample_rate_hz: float
    channels: list[dict[str, Any]]
    conditions: dict[str, Any]
    source_name: str
    received_utc: datetime
    waveform: str | None
    size_bytes: int
    problem: dict[str, Any] | None = None
    picks: dict[str, Any] | None = None


def add_record(connection: Connection, record: StoredRecord) -> bool:
    """Store a record unless its content is stored already; return whether it is new."""
    return insert_new(connection, records, vars(record))


def find_record(connection: Connection, asset: str, record_id: str) -> StoredRecord | None:
    """Return a record of an asset, or None."""
    query = select(records).filter_by(asset=asset, record_id=record_id)
    row = connection.execute(query).one_or_none()
    return None if row is None else StoredRecord(**row._mapping)


def records_with_id(connection: Connection, record_id: str) -> list[StoredRecord]:
    """Return the records of all assets with this content."""
    rows = connection.execute(select(records).where(records.c.record_id == record_id))
    return [StoredRecord(**row._mapping) for row in rows]


def set_status(
    connection: Connection, asset: str, record_id: str, status: str, problem: Mapping[str, Any] | None = None
) -> None:
    """Set the status of a record, with any problem."""
    if status not in STATUSES:
        raise ValueError(f"no record has the status {status!r}")
    connection.execute(_change(asset, record_id).values(status=status, problem=problem))


def _change(asset: str, record_id: str) -> Update:
    return update(records).where(records.c.asset == asset, records.c.record_id == record_id)


def set_picks(connection: Connection, asset: str, record_id: str, picks: Mapping[str, Any] | None) -> None:
    """Store manually selected poles, with user and time."""
    connection.execute(_change(asset, record_id).values(picks=picks))


def list_records(
    connection: Connection,
    asset: str,
    *,
    since: datetime | None = None,
    until: datetime | None = None,
    status: str | None = None,
    cursor: str | None = None,
    limit: int = 100,
) -> tuple[list[StoredRecord], str | None]:
    """Return a page of records, latest first, and the cursor of the next page."""
    query = between(select(records).filter_by(asset=asset), records.c.start_utc, since, until)
    if status is not None:
        query = query.where(records.c.status == status)
    if cursor is not None:
        start, record_id = read_cursor(cursor)
        at = (datetime.fromisoformat(str(start)), str(record_id))
        query = query.where(tuple_(records.c.start_utc, records.c.record_id) < at)
    order = (records.c.start_utc.desc(), records.c.record_id.desc())
    rows = connection.execute(query.order_by(*order).limit(limit + 1)).all()
    found = [StoredRecord(**row._mapping) for row in rows[:limit]]
    more = len(rows) > limit
    return found, write_cursor(found[-1].start_utc.isoformat(), found[-1].record_id) if more else None


def all_with_samples(
    connection: Connection, asset: str, since: datetime | None = None, until: datetime | None = None
) -> list[StoredRecord]:
    """Return the valid records of an asset with stored samples, oldest first."""
    query = between(select(records).filter_by(asset=asset), records.c.start_utc, since, until)
    query = query.where(records.c.waveform.is_not(None), records.c.status != "set_aside")
    rows = connection.execute(query.order_by(records.c.start_utc, records.c.record_id))
    return [StoredRecord(**row._mapping) for row in rows]


def of_state(query: Select[Any], column: ColumnElement[str], asset: str, state: str | None) -> Select[Any]:
    """Return a query restricted to records whose state of operation begins with a word, if there is one."""
    if state is None:
        return query
    said = records.c.conditions["state"].as_string()
    own = select(records.c.record_id).where(records.c.asset == asset, said.startswith(state, autoescape=True))
    return query.where(column.in_(own))


def between(
    query: Select[Any], time: Column[datetime], since: datetime | None, until: datetime | None
) -> Select[Any]:
    """Return a query restricted to rows from one time until before another."""
    query = query if since is None else query.where(time >= since)
    return query if until is None else query.where(time < until)


def with_samples_before(connection: Connection, time: datetime) -> list[StoredRecord]:
    """Return the observed records with stored samples that began before a time."""
    where = (records.c.start_utc < time, records.c.waveform.is_not(None), records.c.status == "observed")
    return [StoredRecord(**row._mapping) for row in connection.execute(select(records).where(*where))]


def forget_samples(connection: Connection, record: StoredRecord) -> None:
    """Mark the samples of a record as deleted."""
    connection.execute(_change(record.asset, record.record_id).values(waveform=None))


def count_by_status(connection: Connection, asset: str | None = None) -> dict[str, dict[str, int]]:
    """Return the number of records by status, of each asset or of one."""
    query = select(records.c.asset, records.c.status, func.count())
    query = query.group_by(records.c.asset, records.c.status)
    if asset is not None:
        query = query.where(records.c.asset == asset)
    counts: dict[str, dict[str, int]] = {}
    for asset, status, n in connection.execute(query):
        counts.setdefault(asset, {})[status] = n
    return counts


def write_cursor(*place: str | int) -> str:
    """Return a position in a list as an opaque cursor."""
    return base64.urlsafe_b64encode(json.dumps(place).encode()).decode()


def read_cursor(cursor: str) -> list[str | int]:
    """Return the position of a cursor.

    Raises
    ------
    InputError
        If it is not a valid cursor.
    """
    try:
        place = json.loads(base64.urlsafe_b64decode(cursor.encode()))
        if not isinstance(place, list) or not all(isinstance(p, str | int) for p in place) or not place:
            raise ValueError
        if len(place) == 2:
            datetime.fromisoformat(str(place[0]))
    except ValueError:
        raise InputError(
            "not a cursor",
            field="cursor",
            value=cursor[:40],
            allowed="the next_cursor of the page before",
            remedy="omit it to begin at the first page",
        ) from None
    return place
