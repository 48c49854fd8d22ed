"""Routes for findings and alarms, and their handling by people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query
from sqlalchemy import Connection

from jackettwin.service.context import Service
from jackettwin.service.web import answers as said, auth
from jackettwin.service.web.auth import Who
from jackettwin.service.web.dependencies import (
    Asker,
    AssetName,
    Parts,
    Reads,
    ReadsAtVersion,
    Route,
    Writes,
    known_asset,
)
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.findings import (
    Acknowledgement,
    AlarmOut,
    AssignIn,
    CloseIn,
    FindingOut,
    HandledOut,
    MuteIn,
    ReopenIn,
)
from jackettwin.store import handling, journal, people, results, rights

router = APIRouter(tags=["findings"], route_class=Route)

Cursor = Annotated[str | None, Query(max_length=500)]
Limit = Annotated[int, Query(ge=1, le=10_000)]
FindingId = Annotated[int, said.RowNumber]
_CHANGED: dict[str, Any] = {"dependencies": [auth.ENGINEER], "responses": answers(401, 403, 404, 422)}
_CONFLICTING: dict[str, Any] = {
    "dependencies": [auth.ENGINEER],
    "responses": answers(401, 403, 404, 409, 422),
}


@router.get("/assets/{asset}/findings", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def findings(
    asset: AssetName,
    connection: ReadsAtVersion,
    severity: Literal["info", "warning", "alarm"] | None = None,
    cursor: Cursor = None,
    limit: Limit = 100,
) -> Page[FindingOut]:
    """List the findings, newest first."""
    return said.findings(connection, known_asset(connection, asset), severity, cursor, limit, FindingOut)


@router.get("/assets/{asset}/alarms", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def alarms(
    asset: AssetName, connection: ReadsAtVersion, cursor: Cursor = None, limit: Limit = 100
) -> Page[AlarmOut]:
    """List the findings that need a person, newest first, with their acknowledgements."""
    return said.findings(connection, known_asset(connection, asset), "alarm", cursor, limit, AlarmOut)


@router.get("/findings/{finding_id}", dependencies=[auth.VIEWER], responses=answers(401, 404, 422))
def finding(finding_id: FindingId, who: Asker, connection: Reads) -> HandledOut:
    """Return a finding with the history of its handling."""
    return _answer(connection, _found(connection, finding_id, who))


@router.post("/alarms/{alarm_id}/acknowledge", **_CHANGED)
def acknowledge(
    alarm_id: FindingId, body: Acknowledgement, who: Asker, parts: Parts, connection: Writes
) -> AlarmOut:
    """Acknowledge an alarm."""
    row = results.find_finding(connection, alarm_id)
    if row is None or row["severity"] != "alarm" or not who.sees(row["asset"]):
        raise ApiError(404, "no such alarm", field="alarm_id", value=str(alarm_id))
    _act(connection, parts, who, row, "acknowledge", comment=body.comment)
    return said.finding_out(row, handling.handled(connection, row["asset"]), AlarmOut)


@router.post("/findings/{finding_id}/assign", **_CHANGED)
def assign(finding_id: FindingId, body: AssignIn, who: Asker, parts: Parts, connection: Writes) -> HandledOut:
    """Assign a finding to a user who may see its asset, or to nobody."""
    row = _found(connection, finding_id, who)
    if body.to is not None and people.any_user(connection):
        _refuse_blind(connection, body.to, row["asset"])
    _act(connection, parts, who, row, "assign", comment=body.comment, to=body.to)
    return _answer(connection, row)


@router.post("/findings/{finding_id}/comment", **_CHANGED)
def comment(
    finding_id: FindingId, body: Acknowledgement, who: Asker, parts: Parts, connection: Writes
) -> HandledOut:
    """Add a comment to a finding."""
    row = _found(connection, finding_id, who)
    _act(connection, parts, who, row, "comment", comment=body.comment)
    return _answer(connection, row)


@router.post("/findings/{finding_id}/mute", **_CHANGED)
def mute(finding_id: FindingId, body: MuteIn, who: Asker, parts: Parts, connection: Writes) -> HandledOut:
    """Mute a finding and similar ones of later days until a time."""
    row = _found(connection, finding_id, who)
    if body.until_utc <= parts.now():
        raise ApiError(422, "is in the past", field="until_utc", value=body.until_utc.isoformat())
    _act(connection, parts, who, row, "mute", comment=body.comment, until=body.until_utc)
    return _answer(connection, row)


@router.post("/findings/{finding_id}/close", **_CONFLICTING)
def close(finding_id: FindingId, body: CloseIn, who: Asker, parts: Parts, connection: Writes) -> HandledOut:
    """Close a finding with a reason."""
    row = _found(connection, finding_id, who)
    if handling.handled(connection, row["asset"]).standing(row).closed is not None:
        raise ApiError(409, "this finding is closed already", remedy="POST /findings/{id}/reopen")
    _act(connection, parts, who, row, "close", comment=body.reason)
    return _answer(connection, row)


@router.post("/findings/{finding_id}/reopen", **_CONFLICTING)
def reopen(finding_id: FindingId, body: ReopenIn, who: Asker, parts: Parts, connection: Writes) -> HandledOut:
    """Reopen a finding, which is then neither closed nor acknowledged nor muted."""
    row = _found(connection, finding_id, who)
    standing = handling.handled(connection, row["asset"]).standing(row)
    if standing.open:
        raise ApiError(409, "this finding is open already")
    if standing.muted_until_utc is not None:
        handling.act_on(connection, row, "unmute", who.name, parts.now(), comment=body.comment)
    _act(connection, parts, who, row, "reopen", comment=body.comment)
    return _answer(connection, row)


def _found(connection: Connection, finding_id: int, who: Who) -> Mapping[str, Any]:
    row = results.find_finding(connection, finding_id)
    if row is None or not who.sees(row["asset"]):
        raise ApiError(404, "no such finding", field="finding_id", value=str(finding_id))
    return row


def _act(
    connection: Connection, parts: Service, who: Who, row: Mapping[str, Any], action: str, **more: Any
) -> None:
    """Store a step of a finding's handling, with an entry in the audit log and an event."""
    now = parts.now()
    handling.act_on(connection, row, action, who.name, now, **more)
    people.note_down(connection, who.name, action, handling.finding_key(row), "ok", now)
    journal.tell(
        connection, "finding", row["asset"], {"id": row["id"], "action": action, "by": who.name}, now
    )


def _refuse_blind(connection: Connection, name: str, asset: str) -> None:
    """Raise an error on an unknown user, or one who may not see the asset.

    Raises
    ------
    ApiError
        422 in both cases.
    """
    user = people.find_user(connection, name)
    seen = None if user is None else rights.visible(connection, user.scope)
    if user is None or (seen is not None and asset not in seen):
        raise ApiError(422, "no user of this name sees the asset", field="to", value=name)


def _answer(connection: Connection, row: Mapping[str, Any]) -> HandledOut:
    return said.finding_out(row, handling.handled(connection, row["asset"]), HandledOut)
