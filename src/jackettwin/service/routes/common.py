"""What routes share: the service, transactions, and finding what a path names."""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable
from functools import partial, wraps
from typing import Annotated, Any, get_type_hints

from anyio import CapacityLimiter, to_thread
from fastapi import Depends, Path, Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service.auth import Who
from jackettwin.service.context import Service
from jackettwin.service.problems import ApiError
from jackettwin.store import assets, reading, records, writing

_ANSWERING = CapacityLimiter(12)
"""Threads that answer questions: more only wait for each other."""
_WAITING = CapacityLimiter(16)
"""Threads of requests that wait for a worker, so that those who only ask need not wait for them."""

_REQUEST = "request_itself"


def get_service(request: Request) -> Service:
    """Return the server's parts."""
    service: Service = request.app.state.service
    return service


def asker(request: Request) -> Who:
    """Return who sent the request; routes ask for a role before."""
    who: Who = request.state.who
    return who


Parts = Annotated[Service, Depends(get_service)]
Reads = Annotated[Connection, reading]
Writes = Annotated[Connection, writing]
"""A connection in a transaction, kept if the route succeeds."""
Asker = Annotated[Who, Depends(asker)]
AssetName = Annotated[str, Path(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$", examples=["demo"])]
RecordId = Annotated[str, Path(pattern=r"^[0-9a-f]{8,64}$", examples=["0123456789abcdef01234567"])]


class Transaction(APIRoute):
    """A route whose transaction, work and answer are done in one thread.

    A connection that were opened in one thread and used in the next would be held by requests that wait for a
    thread, while all threads wait for a connection.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **more: Any) -> None:
        tagged = more.get("methods") in ({"GET"}, ["GET"])
        run = endpoint if inspect.iscoroutinefunction(endpoint) else _in_one_thread(endpoint, tagged)
        super().__init__(path, run, **more)


def waits(route: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a route that waits for a worker."""
    route.waits = True  # type: ignore[attr-defined]
    return route


def _in_one_thread(route: Callable[..., Any], tagged: bool) -> Callable[..., Any]:
    hints = get_type_hints(route, include_extras=True)
    names = [name for name, hint in hints.items() if hint in (Reads, Writes)]
    opening = hints[names[0]].__metadata__[0] if names else None
    asked = next((name for name, hint in hints.items() if hint is Request), None)
    limiter = _WAITING if getattr(route, "waits", False) else _ANSWERING

    def work(request: Request, values: dict[str, Any]) -> Any:
        if opening is None:
            found = route(**values)
        else:
            with opening(get_service(request).database) as connection:
                found = route(**values, **{names[0]: connection})
        plain = tagged and "response" not in values and isinstance(found, BaseModel)
        return _answer(request, found) if plain else found

    @wraps(route)
    async def endpoint(**values: Any) -> Any:
        request = values[asked] if asked else values.pop(_REQUEST)
        return await to_thread.run_sync(partial(work, request, values), limiter=limiter)

    signature = inspect.signature(route)
    kept = [p for p in signature.parameters.values() if p.name not in names]
    own = [] if asked else [inspect.Parameter(_REQUEST, inspect.Parameter.KEYWORD_ONLY, annotation=Request)]
    by_name = [p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in kept]
    endpoint.__signature__ = signature.replace(parameters=[*own, *by_name])  # type: ignore[attr-defined]
    return endpoint


def _answer(request: Request, found: BaseModel) -> Response:
    """Return an answer with a tag of its content; one the reader has already is not sent again."""
    body = found.model_dump_json().encode()
    tag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
    headers = {"ETag": tag, "Cache-Control": "private, no-cache"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    return Response(body, headers=headers, media_type="application/json")


def known_asset(connection: Connection, name: str) -> assets.Version:
    """Return the adopted version of an asset; answers 404 if there is none."""
    try:
        return assets.found_version(connection, name)
    except InputError as error:
        raise ApiError(404, error.problem, field="asset", value=name) from None


def known_record(connection: Connection, record_id: str) -> records.StoredRecord:
    """Return a record by its number; answers 404 if there is none."""
    found = records.records_with_id(connection, record_id)
    if not found:
        raise ApiError(404, "no such record", field="record_id", value=record_id)
    return found[0]
