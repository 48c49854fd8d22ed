"""Whether the server lives, is ready, and how it does; events as they happen."""

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
from jackettwin.service.web.schemas import Health, Ready
from jackettwin.version import __version__

_TOLD_S = 600.0
"""How long one stream of events lasts."""

router = APIRouter(tags=["operation"], route_class=Route)


@router.get("/health", responses={503: {"model": Health, "description": "It hangs: start it anew."}})
def health(parts: Parts, response: Response) -> Health:
    """Tell whether the server turns, and what it lacks; needs no login.

    503 asks for a new start, which helps against nothing else than a server that hangs.
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
    """Tell whether records can be taken and observed now; needs no login."""
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
    """Return what an operator can alarm on: queue age, records late, restarts of workers, disk."""
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
    """Stream what happens to the assets that may be seen: record, observation, state, finding, job.

    A reader that comes back with the last number misses nothing. It must, now and then: the stream ends, so
    that somebody whose session or token has ended is not told for ever.
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
