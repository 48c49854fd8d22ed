"""Results of the engine: observations, modes, findings and the states of days."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Connection, Delete, Select, Table, delete, func, insert, select, update

from jackettwin.store import handling
from jackettwin.store.columns import FORGOTTEN
from jackettwin.store.mode_bins import forget_day
from jackettwin.store.records import between, of_state
from jackettwin.store.tables import (
    assets,
    findings,
    knowledge,
    modes,
    observations,
    records,
    states,
    versions,
)


@dataclass(frozen=True)
class StoredObservation:
    """An observation as a document, with its search keys."""

    asset: str
    model_hash: str
    settings_hash: str
    record_id: str
    start_utc: datetime
    code_version: str
    document: str


@dataclass(frozen=True)
class StoredState:
    """State of one UTC day."""

    asset: str
    model_hash: str
    day: str
    n_records: int
    document: str

    @property
    def document_hash(self) -> str:
        """Hash of the content; states with equal hashes are equal."""
        return hashlib.sha256(self.document.encode()).hexdigest()


def put_observation(
    connection: Connection,
    observation: StoredObservation,
    mode_rows: Iterable[Mapping[str, Any]],
    finding_rows: Iterable[Mapping[str, Any]],
) -> None:
    """Store an observation with modes and findings, replacing an earlier one of the same record."""
    drop_observation(connection, observation.asset, observation.model_hash, observation.record_id)
    forget_day(connection, observation.asset, observation.model_hash, observation.start_utc)
    connection.execute(insert(observations).values(**vars(observation)))
    if mode_rows := list(mode_rows):
        connection.execute(insert(modes), mode_rows)
    if finding_rows := list(finding_rows):
        connection.execute(insert(findings), finding_rows)


def drop_observation(connection: Connection, asset: str, model_hash: str, record_id: str) -> None:
    """Delete the observation of a record under a model."""
    same = {"asset": asset, "model_hash": model_hash, "record_id": record_id}
    time = connection.scalar(select(func.min(modes.c.time_utc)).filter_by(**same))
    if time is not None:
        forget_day(connection, asset, model_hash, time)
    for table in (observations, modes):
        connection.execute(_deleted(table, asset, model_hash, record_id=record_id))
    connection.execute(_deleted(findings, asset, model_hash, record_id=record_id, origin="observe"))


def _deleted(table: Table, asset: str, model_hash: str, **more: str) -> Delete:
    """Return the deletion of an asset's rows under a model, further restricted by values of columns."""
    same = {"asset": asset, "model_hash": model_hash, **more}
    return delete(table).where(*(table.c[name] == value for name, value in same.items()))


def observations_between(
    connection: Connection, asset: str, model_hash: str, start: datetime, end: datetime
) -> Iterator[StoredObservation]:
    """Yield the observations of records that began in an interval, by start and record."""
    query = select(observations).filter_by(asset=asset, model_hash=model_hash)
    query = between(query, observations.c.start_utc, start, end)
    for row in connection.execute(query.order_by(observations.c.start_utc, observations.c.record_id)):
        yield StoredObservation(**row._mapping)


def newest_observations(
    connection: Connection, asset: str, model_hash: str, limit: int
) -> list[StoredObservation]:
    """Return the observations of the latest records, oldest first."""
    query = select(observations).filter_by(asset=asset, model_hash=model_hash).limit(limit)
    query = query.where(observations.c.document != FORGOTTEN)
    rows = connection.execute(query.order_by(observations.c.start_utc.desc(), observations.c.record_id)).all()
    return [StoredObservation(**row._mapping) for row in reversed(rows)]


def observed_time(connection: Connection, asset: str, model_hash: str) -> tuple[int, float]:
    """Return the number of a model's valid observations, and their total duration [s]."""
    own = (observations.c.asset == records.c.asset) & (observations.c.record_id == records.c.record_id)
    query = select(func.count(), func.sum(records.c.duration_s)).select_from(observations.join(records, own))
    query = query.where(observations.c.asset == asset, observations.c.model_hash == model_hash)
    number, seconds = connection.execute(query.where(records.c.status != "mismatched")).one()
    return number, seconds or 0.0


def find_observation(
    connection: Connection, asset: str, record_id: str, model_hash: str
) -> StoredObservation | None:
    """Return the observation of a record under a model, or None."""
    query = select(observations).filter_by(asset=asset, record_id=record_id, model_hash=model_hash)
    row = connection.execute(query).first()
    return None if row is None else StoredObservation(**row._mapping)


def forget_observations(connection: Connection, before: datetime) -> list[str]:
    """Delete the contents of observations before a midnight (UTC); return their assets.

    The rows of the observations and the states of the days remain.
    """
    old = (observations.c.start_utc < before, observations.c.document != FORGOTTEN)
    forgotten = update(observations).where(*old).values(document=FORGOTTEN)
    return sorted(set(connection.scalars(forgotten.returning(observations.c.asset))))


def count_observations(connection: Connection, asset: str) -> dict[str, int]:
    """Return the number of observations of an asset by every model, {model hash: number}."""
    query = select(observations.c.model_hash, func.count()).where(observations.c.asset == asset)
    return {model: n for model, n in connection.execute(query.group_by(observations.c.model_hash))}


_STATE = select(*(states.c[name] for name in StoredState.__dataclass_fields__))


def put_state(connection: Connection, state: StoredState) -> None:
    """Store the state of a day, replacing an earlier one."""
    connection.execute(_deleted(states, state.asset, state.model_hash, day=state.day))
    connection.execute(insert(states).values(**vars(state), document_hash=state.document_hash))


def find_state(connection: Connection, asset: str, model_hash: str, day: str) -> StoredState | None:
    """Return the state of a day, or None."""
    query = _STATE.filter_by(asset=asset, model_hash=model_hash, day=day)
    row = connection.execute(query).one_or_none()
    return None if row is None else StoredState(*row)


def states_until(
    connection: Connection, asset: str, model_hash: str, day: str | None = None, *, after: str | None = None
) -> list[StoredState]:
    """Return the states of all days, or of those up to a day or after one, in order."""
    query = _STATE.filter_by(asset=asset, model_hash=model_hash).order_by(states.c.day)
    if day is not None:
        query = query.where(states.c.day <= day)
    if after is not None:
        query = query.where(states.c.day > after)
    return [StoredState(*row) for row in connection.execute(query)]


def state_hashes(
    connection: Connection, asset: str, model_hash: str, day: str | None = None
) -> dict[str, str]:
    """Return the content hash of the state of every day, or of those up to a day."""
    query = select(states.c.day, states.c.document_hash).filter_by(asset=asset, model_hash=model_hash)
    query = query.order_by(states.c.day)
    if day is not None:
        query = query.where(states.c.day <= day)
    return {day: found for day, found in connection.execute(query)}


def identity_of(hashes: Mapping[str, str]) -> str:
    """Return the identity of a turbine's state: one hash of those of its days, {day: hash}."""
    return hashlib.sha256(repr(tuple(hashes.items())).encode()).hexdigest()


def drop_state(connection: Connection, asset: str, model_hash: str, day: str) -> None:
    """Delete the state of a day, and the findings of advancing it."""
    connection.execute(_deleted(states, asset, model_hash, day=day))
    connection.execute(_deleted(findings, asset, model_hash, day=day, origin="advance"))


def put_findings(connection: Connection, rows: Sequence[Mapping[str, Any]]) -> None:
    """Add findings."""
    if rows:
        connection.execute(insert(findings), list(rows))


def drop_findings(connection: Connection, asset: str, model_hash: str, *, origin: str) -> None:
    """Delete the findings of an origin."""
    connection.execute(_deleted(findings, asset, model_hash, origin=origin))


def put_watched(
    connection: Connection, asset: str, model_hash: str, rows: Sequence[Mapping[str, Any]]
) -> list[Mapping[str, Any]]:
    """Store the present findings of monitoring a turbine's days; return the new ones.

    Earlier findings that no longer apply, as after a late record, are deleted.
    """
    own = select(findings).filter_by(asset=asset, model_hash=model_hash, origin="watch")
    before = {(handling.finding_key(row), row["text"]): row["id"] for row in _rows(connection, own)}
    now = {(handling.finding_key(row), row["text"]): row for row in rows}
    gone = [number for key, number in before.items() if key not in now]
    connection.execute(delete(findings).where(findings.c.id.in_(gone)))
    new = [row for key, row in now.items() if key not in before]
    put_findings(connection, new)
    return new


def list_modes(
    connection: Connection,
    asset: str,
    model_hash: str,
    *,
    label: str | None = None,
    since: datetime | None = None,
    until: datetime | None = None,
    after: int | None = None,
    limit: int | None = 1000,
    state: str | None = None,
    least_known: bool = False,
    record_id: str | None = None,
) -> list[Mapping[str, Any]]:
    """Return modes over time, in the order of their identification; of a record, or of a state of operation.

    With ``least_known``, the mode whose frequency has the largest relative standard deviation comes first;
    those that tell of none come last.
    """
    query = select(modes).filter_by(asset=asset, model_hash=model_hash)
    if label is not None:
        query = query.where(modes.c.label == label)
    if record_id is not None:
        query = query.where(modes.c.record_id == record_id)
    if after is not None:
        query = query.where(modes.c.id > after)
    query = between(of_state(query, modes.c.record_id, asset, state), modes.c.time_utc, since, until)
    if not least_known:
        return _rows(connection, query.order_by(modes.c.id).limit(limit))
    vague = modes.c.frequency_relative_std
    known = query.where(vague.is_not(None)).order_by(vague.desc(), modes.c.id)  # as an index has them
    first = _rows(connection, known.limit(limit))
    left = None if limit is None else limit - len(first)
    return first + _rows(connection, query.where(vague.is_(None)).order_by(modes.c.id).limit(left))


def list_findings(
    connection: Connection,
    asset: str,
    model_hash: str,
    *,
    severity: str | None = None,
    before: int | None = None,
    limit: int = 100,
) -> list[Mapping[str, Any]]:
    """Return findings, newest first."""
    query = select(findings).filter_by(asset=asset, model_hash=model_hash).limit(limit)
    if severity is not None:
        query = query.where(findings.c.severity == severity)
    if before is not None:
        query = query.where(findings.c.id < before)
    return _rows(connection, query.order_by(findings.c.id.desc()))


def _rows(connection: Connection, query: Select[Any]) -> list[Mapping[str, Any]]:
    return [dict(row._mapping) for row in connection.execute(query)]


def silent_assets(connection: Connection) -> dict[str, str]:
    """Return the assets with a finding of silence, {asset: subject}."""
    query = select(findings.c.asset, findings.c.subject).where(findings.c.origin == "silence")
    return {asset: since for asset, since in connection.execute(query)}


def put_knowledge(
    connection: Connection,
    asset: str,
    version: int,
    document: Mapping[str, Any],
    report: bytes | None,
    now: datetime,
) -> None:
    """Store the estimates of the supports under a version with their report, replacing earlier ones."""
    connection.execute(delete(knowledge).where(*_of_version(asset, version)))
    key = {"asset": asset, "version": version, "computed_utc": now}
    connection.execute(insert(knowledge).values(**key, document=dict(document), report=report))


_ANSWERS = ("known", "supports", "life", "watch")
"""Parts of what is stored of a version that answer requests; the others only save time."""


def find_kept(connection: Connection, asset: str, version: int) -> Mapping[str, Any]:
    """Return the stored intermediate results of estimations, by name."""
    document = connection.scalar(select(knowledge.c.document).where(*_of_version(asset, version))) or {}
    return {name: value for name, value in document.items() if name not in _ANSWERS}


def find_supports(connection: Connection, asset: str, version: int) -> dict[str, Any]:
    """Return the estimates of the supports and whether a report is kept (``reported``); empty before them."""
    query = select(knowledge.c.document["known"], knowledge.c.report.is_not(None))
    row = connection.execute(query.where(*_of_version(asset, version))).one_or_none()
    return {} if row is None or not row[0] else {**row[0], "reported": bool(row[1])}


def find_drawn(connection: Connection, asset: str, version: int, name: str) -> Any:
    """Return data of a page: ``explored``, ``structure`` or ``assumptions``; empty if there are none yet."""
    return _part(connection, asset, version, ("together", "known", name))


def find_stiffness(connection: Connection, asset: str, version: int) -> dict[str, Any]:
    """Return the stiffness of the supports on each day; empty if there is none yet."""
    return dict(_part(connection, asset, version, "supports"))


def find_watch(connection: Connection, asset: str, version: int) -> dict[str, Any]:
    """Return what the monitoring of a turbine's days showed; empty if there is nothing yet."""
    return dict(_part(connection, asset, version, "watch"))


def find_life(connection: Connection, asset: str, version: int) -> list[dict[str, Any]]:
    """Return the life of the welds that records damage most, in the order of `AssetLife`; empty if none."""
    return list(_part(connection, asset, version, "life"))


def _part(connection: Connection, asset: str, version: int, name: str | tuple[str, ...]) -> Any:
    query = select(knowledge.c.document[name]).where(*_of_version(asset, version))
    return connection.scalar(query) or {}


def find_report(connection: Connection, asset: str, version: int) -> bytes | None:
    """Return the compressed report, or None."""
    found: bytes | None = connection.scalar(select(knowledge.c.report).where(*_of_version(asset, version)))
    return found


def _of_version(asset: str, version: int) -> tuple[ColumnElement[bool], ...]:
    return knowledge.c.asset == asset, knowledge.c.version == version


def open_alarms(connection: Connection, asset: str | None = None) -> dict[str, list[str]]:
    """Return the sentences of the open alarms of the adopted versions, oldest first, {asset: sentences}.

    Muted, acknowledged and closed alarms are not open.
    """
    columns = (findings.c.asset, findings.c.day, findings.c.code, findings.c.subject, findings.c.text)
    query = _adopted(select(*columns), asset).where(findings.c.severity == "alarm")
    handled, found = handling.handled(connection, asset), dict[str, list[str]]()
    for row in _rows(connection, query.order_by(findings.c.time_utc, findings.c.id)):
        found.setdefault(row["asset"], []).extend([row["text"]] * handled.standing(row).open)
    return found


@dataclass(frozen=True)
class Estimated:
    """What a turbine's estimate says in short.

    Attributes
    ----------
    remaining_years, remaining_years_interval_90 : median of the years left to the weld that fails first, and
        90 % interval, where known; None of its ends is one that nobody waits for
    reliable : False if the model cannot reproduce the measurements
    """

    remaining_years: float | None = None
    remaining_years_interval_90: tuple[float | None, float | None] | None = None
    reliable: bool = True


def estimated(connection: Connection, asset: str | None = None) -> dict[str, Estimated]:
    """Return what the estimates of the adopted versions say in short, {asset: …}, where there is one."""
    years = knowledge.c.document["life"][0]["remaining_years"]
    reliable = knowledge.c.document["known"]["reliable"].as_boolean()
    known = (knowledge.c.asset == assets.c.name) & (knowledge.c.version == assets.c.adopted_version)
    query = select(assets.c.name, years, reliable).join(knowledge, known)
    query = query if asset is None else query.where(assets.c.name == asset)
    found = {}
    for name, left, meets in connection.execute(query):
        interval = None if left is None else (left.get("p05"), left.get("p95"))
        found[name] = Estimated((left or {}).get("p50"), interval, meets is not False)
    return found


def find_finding(connection: Connection, finding_id: int) -> Mapping[str, Any] | None:
    """Return a finding by its number, or None."""
    return next(iter(_rows(connection, select(findings).filter_by(id=finding_id))), None)


def count_findings(connection: Connection, asset: str | None = None) -> dict[str, dict[str, int]]:
    """Return the number of findings by severity of the adopted version, of each asset or of one."""
    query = _adopted(select(findings.c.asset, findings.c.severity, func.count()), asset)
    counts: dict[str, dict[str, int]] = {}
    for name, severity, n in connection.execute(query.group_by(findings.c.asset, findings.c.severity)):
        counts.setdefault(name, {})[severity] = n
    return counts


def _adopted(query: Select[Any], asset: str | None) -> Select[Any]:
    """Return a query on findings restricted to adopted versions of one asset, or of all living ones."""
    own = (versions.c.asset == assets.c.name) & (versions.c.version == assets.c.adopted_version)
    same = (findings.c.asset == versions.c.asset) & (findings.c.model_hash == versions.c.model_hash)
    query = query.select_from(assets.join(versions, own).join(findings, same))
    return query.where(assets.c.archived_utc.is_(None) if asset is None else assets.c.name == asset)
