"""Queue of jobs, one for each (record, model, settings, code), leased and done once.

Leases have no expiry. Each server increments a heartbeat; a server that sees another's unchanged for long, by
its own monotonic clock, releases the leases of the dead server. A result is accepted only from the server
that still has the lease.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import zip_longest
from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, Update, delete, func, insert, select, update

from jackettwin.store.assets import Version
from jackettwin.store.database import insert_new
from jackettwin.store.rights import Assets, among
from jackettwin.store.tables import posts, servers, work
from jackettwin.version import __version__

OBSERVE, KNOW = "observe", "know"
"""Kinds of jobs: observe a record; estimate the supports from a state."""
GONE = -20
"""Priority of records of an archived asset, after all others and without alarm."""
MOST_TRIES = 3
"""Number of tries after which a record is set aside if its workers died or exceeded the time limit."""


@dataclass(frozen=True)
class Job:
    """One row of the queue."""

    id: int
    kind: str
    asset: str
    record_id: str
    version: int
    model_hash: str
    settings_hash: str
    code_version: str
    state: str
    priority: int
    tries: int
    owner: str | None
    created_utc: datetime
    started_utc: datetime | None
    ended_utc: datetime | None
    reason: dict[str, Any] | None


def enqueue(
    connection: Connection,
    version: Version,
    record_id: str,
    now: datetime,
    *,
    kind: str = OBSERVE,
    priority: int = 0,
) -> int:
    """Add a job of observing a record by a version of a twin, or of another kind; return its number.

    An existing job keeps its number.
    """
    key = {
        "kind": kind,
        "asset": version.asset,
        "record_id": record_id,
        "model_hash": version.model_hash,
        "settings_hash": version.settings_hash,
        "code_version": __version__,
    }
    new = {"version": version.version, "state": "queued", "tries": 0, "created_utc": now}
    insert_new(connection, work, {**key, **new, "priority": priority})
    return int(connection.execute(select(work.c.id).filter_by(**key)).scalar_one())


def lease(
    connection: Connection,
    owner: str,
    most: int,
    now: datetime,
    *,
    kind: str = OBSERVE,
    served: Mapping[str, int] | None = None,
) -> list[Job]:
    """Lease up to ``most`` queued jobs of a kind.

    Jobs are ordered by priority, then in turns by the asset served least recently, then by waiting time, so
    that thousands of records of one turbine do not delay those of others.
    """
    jobs: list[Job] = []
    for priority in _priorities(connection):
        same = (work.c.state == "queued", work.c.kind == kind, work.c.priority == priority)
        if kind == OBSERVE:
            jobs += _by_turns(connection, same, most - len(jobs), served or {})
        else:
            jobs += _queued(connection, same, most - len(jobs), work.c.started_utc.nulls_first())
        if len(jobs) == most:
            break
    if jobs:
        taken = {"state": "leased", "owner": owner, "started_utc": now, "tries": work.c.tries + 1}
        connection.execute(update(work).where(work.c.id.in_([job.id for job in jobs])).values(**taken))
    return jobs


def _by_turns(
    connection: Connection, same: tuple[ColumnElement[bool], ...], most: int, served: Mapping[str, int]
) -> list[Job]:
    """Return jobs in turns of assets, beginning with those served least."""
    if most <= 0:
        return []
    heads = connection.execute(_first_of_each(same)).all()
    waiting = sorted(heads, key=lambda head: (served.get(head[0], 0), head[1]))[:most]
    each = -(-most // max(len(waiting), 1))
    found = [_queued(connection, (*same, work.c.asset == asset), each) for asset, _ in waiting]
    return [job for turn in zip_longest(*found) for job in turn if job is not None][:most]


def _first_of_each(same: tuple[ColumnElement[bool], ...]) -> Select[str, int]:
    """Select the assets that have such jobs, each with its oldest: one search of the index for each asset.

    Grouping would read the whole queue.
    """
    first = select(func.min(work.c.asset).label("asset")).where(*same).cte("waiting", recursive=True)
    following = select(func.min(work.c.asset)).where(*same, work.c.asset > first.c.asset).scalar_subquery()
    waiting = first.union_all(select(following).where(first.c.asset.is_not(None)))
    oldest = select(func.min(work.c.id)).where(*same, work.c.asset == waiting.c.asset).scalar_subquery()
    return select(waiting.c.asset, oldest).where(waiting.c.asset.is_not(None))


def _queued(
    connection: Connection, same: tuple[ColumnElement[bool], ...], most: int, *order: ColumnElement[Any]
) -> list[Job]:
    query = select(work).where(*same).order_by(*order, work.c.id).limit(most)
    rows = connection.execute(query.with_for_update(skip_locked=True))
    return [Job(**row._mapping) for row in rows]


def _priorities(connection: Connection) -> Iterator[int]:
    """Yield the priorities of queued jobs, highest first, each by one search of the index."""
    highest = select(func.max(work.c.priority)).where(work.c.state == "queued")
    found = connection.scalar(highest)
    while found is not None:
        yield found
        found = connection.scalar(highest.where(work.c.priority < found))


def finish(
    connection: Connection,
    job: Job,
    owner: str,
    state: str,
    now: datetime,
    reason: dict[str, Any] | None = None,
) -> bool:
    """Finish a job; return False if it is no longer leased by this server, and then discard its result."""
    ended = {"state": state, "ended_utc": now, "reason": reason, "owner": None}
    return connection.execute(_mine(job, owner).values(**ended)).rowcount == 1


def put_back(connection: Connection, job: Job, owner: str, reason: dict[str, Any]) -> str | None:
    """Return a failed job to the queue, or set it aside after the last try; return its new state."""
    state = "queued" if job.tries + 1 < MOST_TRIES else "set_aside"
    ended = connection.execute(_mine(job, owner).values(state=state, owner=None, reason=reason))
    return state if ended.rowcount == 1 else None


def release(connection: Connection, job: Job, owner: str) -> None:
    """Return a job that was not started to the queue, without counting a try."""
    connection.execute(_mine(job, owner).values(**_UNTRIED))


def _mine(job: Job, owner: str) -> Update:
    """Return the update of a job that a server still leases."""
    return update(work).where(work.c.id == job.id, work.c.state == "leased", work.c.owner == owner)


_UNTRIED = {"state": "queued", "owner": None, "tries": work.c.tries - 1}
"""Change of a leased job that is returned without counting a try, as after the death of a server."""


def try_again(connection: Connection, job_id: int, now: datetime) -> bool:
    """Queue a job again that is done, set aside, failed or cancelled."""
    ended = work.c.state.in_(("set_aside", "failed", "cancelled", "done"))
    return (
        connection.execute(update(work).where(work.c.id == job_id, ended).values(**_anew(now))).rowcount == 1
    )


def renew(connection: Connection, job_id: int, now: datetime) -> bool:
    """Queue a job again after a change of its inputs; a pending result is not accepted."""
    mine = (work.c.id == job_id, work.c.state.not_in(("queued", "cancelled")))
    return connection.execute(update(work).where(*mine).values(**_anew(now))).rowcount == 1


def _anew(now: datetime) -> dict[str, Any]:
    nothing = dict.fromkeys(("owner", "reason", "ended_utc"))
    return {"state": "queued", "tries": 0, "created_utc": now, **nothing}


def reorder(connection: Connection, asset: str, priority: int) -> None:
    """Change the priority of an asset's queued records."""
    waiting = (work.c.asset == asset, work.c.kind == OBSERVE, work.c.state == "queued")
    connection.execute(update(work).where(*waiting).values(priority=priority))


def cancel(connection: Connection, job_id: int, now: datetime) -> bool:
    """Cancel a queued or leased job; a later result is not accepted."""
    open_states = work.c.state.in_(("queued", "leased"))
    cancelled = {"state": "cancelled", "ended_utc": now, "owner": None}
    return (
        connection.execute(update(work).where(work.c.id == job_id, open_states).values(**cancelled)).rowcount
        == 1
    )


def find_job(connection: Connection, job_id: int) -> Job | None:
    """Return a job, or None."""
    row = connection.execute(select(work).where(work.c.id == job_id)).one_or_none()
    return None if row is None else Job(**row._mapping)


def list_jobs(
    connection: Connection,
    *,
    state: str | None = None,
    before: int | None = None,
    limit: int = 100,
    seen: Assets = None,
) -> list[Job]:
    """Return jobs of visible assets, newest first."""
    query = select(work).where(among(work.c.asset, seen)).order_by(work.c.id.desc()).limit(limit)
    if state is not None:
        query = query.where(work.c.state == state)
    if before is not None:
        query = query.where(work.c.id < before)
    return [Job(**row._mapping) for row in connection.execute(query)]


def jobs_of(connection: Connection, asset: str, record_id: str) -> list[Job]:
    """Return all jobs of a record, oldest first."""
    query = select(work).filter_by(asset=asset, record_id=record_id).order_by(work.c.id)
    return [Job(**row._mapping) for row in connection.execute(query)]


def any_queued(connection: Connection, kind: str, *, gone: bool = False, first: bool = False) -> bool:
    """Return whether jobs of a kind are queued.

    Parameters
    ----------
    gone : only those of archived assets, which are left out otherwise
    first : only those that were never begun
    """
    urgency = work.c.priority == GONE if gone else work.c.priority > GONE
    query = select(work.c.id).where(work.c.state == "queued", urgency, work.c.kind == kind).limit(1)
    query = query.where(work.c.started_utc.is_(None)) if first else query
    return connection.scalar(query) is not None


def forget_jobs(connection: Connection, before: datetime) -> int:
    """Delete jobs on records that finished before a time, except those set aside."""
    over = work.c.state.in_(("done", "failed", "cancelled"))
    old = (work.c.kind == OBSERVE, over, work.c.ended_utc < before)
    return connection.execute(delete(work).where(*old)).rowcount


def queue_sizes(connection: Connection, seen: Assets = None) -> dict[str, int]:
    """Return the number of jobs of visible assets by state."""
    query = select(work.c.state, func.count()).where(among(work.c.asset, seen)).group_by(work.c.state)
    return {state: n for state, n in connection.execute(query)}


def oldest_queued(connection: Connection) -> datetime | None:
    """Return the time at which the oldest queued record was added, without archived assets."""
    waiting = (work.c.state == "queued", work.c.kind == OBSERVE, work.c.priority > GONE)
    found: datetime | None = connection.scalar(
        select(func.min(work.c.created_utc, type_=work.c.created_utc.type)).where(*waiting)
    )
    return found


def join(connection: Connection, server: str, about: dict[str, Any], now: datetime) -> None:
    """Add a server to the list of those that may lease jobs."""
    connection.execute(insert(servers).values(id=server, beat=0, started_utc=now, about=about))


def beat(connection: Connection, server: str) -> bool:
    """Increment a server's heartbeat; return False if it was declared dead meanwhile."""
    counted = update(servers).where(servers.c.id == server).values(beat=servers.c.beat + 1)
    return connection.execute(counted).rowcount == 1


def beats(connection: Connection) -> dict[str, tuple[int, dict[str, Any]]]:
    """Return the heartbeat of every server, and its data."""
    rows = connection.execute(select(servers.c.id, servers.c.beat, servers.c.about))
    return {server: (count, about) for server, count, about in rows}


def remove_server(connection: Connection, server: str, at_beat: int | None = None) -> Sequence[int]:
    """Remove a dead server and release its leases, unless its heartbeat has changed meanwhile."""
    where = [servers.c.id == server]
    if at_beat is not None:
        where.append(servers.c.beat == at_beat)
    if connection.execute(delete(servers).where(*where)).rowcount != 1:
        return []
    held = list(connection.scalars(select(work.c.id).where(work.c.state == "leased", work.c.owner == server)))
    connection.execute(update(work).where(work.c.id.in_(held)).values(**_UNTRIED))
    return held


def hold_duty(connection: Connection, name: str, server: str) -> bool:
    """Take or keep a duty of one server for all; return False while another living server has it."""
    free = (posts.c.server == server) | posts.c.server.not_in(select(servers.c.id))
    taken = update(posts).where(posts.c.name == name, free).values(server=server)
    if connection.execute(taken).rowcount == 1:
        return True
    return insert_new(connection, posts, {"name": name, "server": server})


def take_back_orphans(connection: Connection, me: str, mine: Collection[int]) -> int:
    """Return orphaned leases to the queue.

    These are leases of servers that are not on the list, as after a restore, and leases of this server that
    it does not know, as after a loss of the database.
    """
    alive = select(servers.c.id)
    forgotten = (work.c.owner == me) & work.c.id.not_in(mine)
    orphan = (work.c.state == "leased", work.c.owner.not_in(alive) | forgotten)
    return connection.execute(update(work).where(*orphan).values(**_UNTRIED)).rowcount
