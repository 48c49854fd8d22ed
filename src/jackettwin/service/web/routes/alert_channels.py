"""Routes for channels of alerts."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path
from sqlalchemy import Connection

from jackettwin.service.alerts.kept_channels import add_channel, merged, of_file, remove_channel
from jackettwin.service.alerts.outbox import tried
from jackettwin.service.alerts.rules import Alerts, ChannelRule
from jackettwin.service.context import Service
from jackettwin.service.web import auth
from jackettwin.service.web.dependencies import WAITING, Asker, Parts, Reads, Route, Writes
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.service.web.schemas.channels import ChannelOut, Delivery, NewChannel
from jackettwin.service.web.schemas.common import Page
from jackettwin.store import people, reading, writing

router = APIRouter(prefix="/alert-channels", tags=["alerts"], route_class=Route)

ChannelId = Annotated[str, Path(min_length=1, max_length=64)]


@router.get("", dependencies=[auth.ADMIN], responses=answers(401, 403, 422))
def channels(parts: Parts, connection: Reads) -> Page[ChannelOut]:
    """List the channels of the server's alerts file and those that were added."""
    told = _told(connection, parts)
    return Page(items=[_out(parts, told, name) for name in told.channels])


@router.post("", status_code=201, dependencies=[auth.ADMIN], responses=answers(400, 401, 403, 422))
def add(body: NewChannel, who: Asker, parts: Parts, connection: Writes) -> ChannelOut:
    """Add a channel for later findings; its secrets are stored in files."""
    given = body.channel.model_dump(mode="json", exclude_none=True)
    rules = [rule.model_dump(mode="json") for rule in body.rules]
    told = add_channel(
        connection, parts.settings.store, of_file(parts.settings.alerts), body.name, given, rules
    )
    people.note_down(connection, who.name, "alert channel", body.name, "ok", parts.now())
    return _out(parts, told, body.name)


@router.delete(
    "/{channel_id}", status_code=204, dependencies=[auth.ADMIN], responses=answers(401, 403, 404, 422)
)
def remove(channel_id: ChannelId, who: Asker, parts: Parts, connection: Writes) -> None:
    """Delete an added channel with its secrets."""
    if not remove_channel(connection, parts.settings.store, channel_id):
        raise _unknown(channel_id)
    people.note_down(connection, who.name, "alert channel", channel_id, "removed", parts.now())


@router.post("/{channel_id}/test", dependencies=[auth.ADMIN, WAITING], responses=answers(401, 403, 404, 422))
def test(channel_id: ChannelId, who: Asker, parts: Parts) -> Delivery:
    """Send a test message and return whether it was accepted."""
    with reading(parts.database) as connection:
        told = _told(connection, parts)
    if channel_id not in told.channels:
        raise _unknown(channel_id)
    problem = tried(told.channels[channel_id], told.address, parts.settings.alerts_folder)
    with writing(parts.database) as connection:
        outcome = "delivered" if problem is None else "not delivered"
        people.note_down(connection, who.name, "alert test", channel_id, outcome, parts.now())
    return Delivery(delivered=problem is None, problem=problem)


def _told(connection: Connection, parts: Service) -> Alerts:
    return merged(connection, parts.settings.store, of_file(parts.settings.alerts)) or Alerts(
        channels={}, rules=[]
    )


def _unknown(name: str) -> ApiError:
    return ApiError(404, "no such channel", field="channel_id", value=name)


def _out(parts: Service, told: Alerts, name: str) -> ChannelOut:
    channel, file = told.channels[name], of_file(parts.settings.alerts)
    rules = [rule.model_dump(exclude={"channel"}) for rule in told.rules if rule.channel == name]
    return ChannelOut(
        id=name,
        kind="mail" if channel.kind == "email" else channel.kind,
        about=channel.about,
        from_file=file is not None and name in file.channels,
        rules=[ChannelRule(**rule) for rule in rules],
    )
