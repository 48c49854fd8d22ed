"""Health, readiness and metrics of the server, and the stream of events."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Header, Request, Response
from prometheus_client import CONTENT_TYPE_LATEST
from sse_starlette import EventSourceResponse, ServerSentEvent

from jackettwin.service.web import auth, metrics
from jackettwin.service.web.dependencies import Asker, Parts, Route
from jackettwin.service.web.problems import answers
from jackettwin.service.web.schemas.server import Health, Ready
from jackettwin.version import __version__

_TOLD_S = 600.0
"""Duration of one stream of events."""

router = APIRouter(tags=["operation"], route_class=Route)


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
