"""Health, readiness and metrics of the server, and the stream of events."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator
from math import isfinite
from typing import Annotated

from fastapi import APIRouter, Depends, Header, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST
from sse_starlette import EventSourceResponse, ServerSentEvent

from jackettwin.service.web import auth, metrics
from jackettwin.service.web.dependencies import Asker, AssetName, Parts, Reads, Route, known_asset
from jackettwin.service.web.problems import answers
from jackettwin.service.web.schemas.server import Health, Ready
from jackettwin.store import reading, streams
from jackettwin.version import __version__

_TOLD_S = 600.0
"""Duration of one stream of events."""

_LOOK_S = 0.2
"""Time between looks for packets of a stream."""

router = APIRouter(tags=["operation"], route_class=Route)


def _there(asset: AssetName, connection: Reads) -> None:
    """Refuse an asset that there is not, or not for who asks; the connection is not kept."""
    known_asset(connection, asset)


@router.get(
    "/health", responses={503: {"model": Health, "description": "The server hangs and must be restarted."}}
)
def health(parts: Parts, response: Response) -> Health:
    """Return whether the server runs, and its faults; needs no login.

    503 means that the server hangs and must be restarted, which helps in no other case.
    """
    said = metrics.problems(parts, metrics.readiness(parts))
    response.status_code = 200 if parts.turning() else 503
    return Health(
        status="degraded" if said else "ok",
        version=__version__,
        problems=said,
        openid=parts.settings.oidc_issuer is not None,
    )


@router.get("/ready", responses={503: {"model": Ready, "description": "Not ready."}})
def ready(parts: Parts, response: Response) -> Ready:
    """Return whether records can now be stored and observed; needs no login."""
    found = metrics.readiness(parts)
    response.status_code = 200 if found.ready else 503
    return found


@router.get(
    "/metrics",
    dependencies=[auth.VIEWER],
    response_class=Response,
    responses={200: {"content": {"text/plain": {}}}, **answers(401)},
)
def prometheus(who: Asker, parts: Parts) -> Response:
    """Return metrics for operators: age of the queue, late records, restarts of workers, disk."""
    return Response(metrics.exposition(parts, who.assets), media_type=CONTENT_TYPE_LATEST)


@router.get(
    "/events",
    dependencies=[auth.VIEWER],
    response_class=Response,
    responses={200: {"content": {"text/event-stream": {}}}, **answers(401, 422)},
)
async def events(
    request: Request,
    who: Asker,
    parts: Parts,
    last_event_id: Annotated[str | None, Header(max_length=20)] = None,
) -> EventSourceResponse:
    """Stream the events of visible assets: record, observation, state, finding, job.

    The stream ends after some time, so that an expired session or token receives no more events. A client
    that reconnects with the last number misses none.
    """
    start = int(last_event_id) if last_event_id and last_event_id.isdecimal() else parts.feed.last

    async def stream() -> AsyncIterator[ServerSentEvent]:
        yield ServerSentEvent(id=str(start))
        async for event in parts.feed.follow(start, _TOLD_S):
            if not who.sees(event.asset):
                continue
            payload = {"asset": event.asset, "time_utc": event.time_utc.isoformat(), **event.payload}
            yield ServerSentEvent(json.dumps(payload), event=event.kind, id=str(event.id))
            if await request.is_disconnected():
                return
            await asyncio.sleep(0)

    return EventSourceResponse(stream(), ping=15)


@router.get(
    "/assets/{asset}/live",
    dependencies=[auth.VIEWER],
    response_class=Response,
    responses={200: {"content": {"text/event-stream": {}}}, **answers(401, 404, 422)},
)
async def live(
    request: Request, asset: AssetName, parts: Parts, known: Annotated[None, Depends(_there)]
) -> EventSourceResponse:
    """Stream the samples of an asset as they arrive from its broker, a ``packet`` for each.

    A packet is ``{channel, t0_utc, rate_hz, samples}``. The stream ends as that of the events does.
    """

    def after(last: int | None) -> tuple[int, list[streams.Packet]]:
        with reading(parts.database) as connection:
            return streams.packets_after(connection, asset, last)

    async def stream() -> AsyncIterator[ServerSentEvent]:
        last, _ = await asyncio.to_thread(after, None)
        end = time.monotonic() + _TOLD_S
        yield ServerSentEvent("", event="open")
        while time.monotonic() < end and not await request.is_disconnected():
            last, new = await asyncio.to_thread(after, last)
            for packet in new:
                yield ServerSentEvent(_packet(packet), event="packet")
            await asyncio.sleep(_LOOK_S)

    return EventSourceResponse(stream(), ping=15)


def _packet(packet: streams.Packet) -> str:
    samples = [float(f"{v:.6g}") if isfinite(v) else None for v in packet.samples.tolist()]
    head = {"channel": packet.channel, "t0_utc": packet.t0_utc.isoformat(), "rate_hz": packet.rate_hz}
    return json.dumps({**head, "samples": samples})
