"""What routes share: the service, transactions, and finding what a path names."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Coroutine
from functools import partial, wraps
from typing import Annotated, Any, get_type_hints

from anyio import CapacityLimiter, to_thread
from fastapi import Depends, Path, Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.web.answer_cache import compressed, content_tag, has_tag
from jackettwin.service.web.auth import Who
from jackettwin.service.web.problems import ApiError
from jackettwin.store import assets, journal, reading, records, writing

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
Told = Annotated[Connection, reading, "told"]
"""A connection that reads what changes with an event only: its newest number is the answer's version."""
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

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return what answers a request; in the API a query that no one reads is refused, not ignored."""
        answer = super().get_route_handler()
        if not self.include_in_schema:
            return answer
        known = {parameter.alias for parameter in self.dependant.query_params}

        async def answer_known(request: Request) -> Response:
            unknown = next((name for name in request.query_params if name not in known), None)
            if unknown is not None:
                allowed = ", ".join(sorted(known)) or "none here"
                raise ApiError(422, "no such query parameter", field=unknown, allowed=allowed)
            return await answer(request)

        return answer_known


def waits(route: Callable[..., Any]) -> Callable[..., Any]:
    """Mark a route that waits for a worker."""
    route.waits = True  # type: ignore[attr-defined]
    return route


def _in_one_thread(route: Callable[..., Any], tagged: bool) -> Callable[..., Any]:
    hints = get_type_hints(route, include_extras=True)
    names = [name for name, hint in hints.items() if hint in (Reads, Told, Writes)]
    kind = hints[names[0]] if names else None
    asked = next((name for name, hint in hints.items() if hint is Request), None)
    limiter = _WAITING if getattr(route, "waits", False) else _ANSWERING

    def work(request: Request, values: dict[str, Any]) -> Any:
        if kind is None:
            return route(**values)
        with kind.__metadata__[0](get_service(request).database) as connection:
            answer = partial(route, **values, **{names[0]: connection})
            if kind == Told:
                return _by_version(request, connection, values.get("asset"), answer)
            return _by_content(request, answer()) if tagged else answer()

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


def _by_content(request: Request, found: Any) -> Any:
    """Return an answer with a tag of its content; one the reader has already is not sent again."""
    if not isinstance(found, BaseModel):
        return found
    body = found.model_dump_json().encode()
    headers = _tagged(content_tag(body))
    if has_tag(request.headers.get("if-none-match"), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return Response(body, headers=headers, media_type="application/json")


def _by_version(
    request: Request, connection: Connection, asset: str | None, answer: Callable[[], Any]
) -> Any:
    """Return an answer about an asset, or about all, which is made only if something happened since the last.

    The version is read before the answer: what happens between them makes a new version, and a new answer.
    """
    service = get_service(request)
    version = journal.last_event(connection, asset)
    headers = _tagged(f'W/"{service.server_id}-{version}"')
    if has_tag(request.headers.get("if-none-match"), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    question = f"{request.url.path}?{request.url.query}"
    known = service.rendered.find(question, version)
    if known is None:
        found = answer()
        if isinstance(found, Response):
            found.headers.update(headers)
            return found
        known = compressed(version, found.model_dump_json().encode())
        service.rendered.keep(question, known)
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(known.body, headers=headers, media_type="application/json")
    headers["Content-Encoding"] = "gzip"
    return Response(known.compressed, headers=headers, media_type="application/json")


def _tagged(tag: str) -> dict[str, str]:
    return {"ETag": tag, "Cache-Control": "private, no-cache", "Vary": "Accept-Encoding"}


def known_asset(connection: Connection, name: str) -> assets.Version:
    """Return the adopted version of an asset; answers 404 if there is none."""
    return known_version(connection, name, None)


def living_asset(connection: Connection, name: str) -> None:
    """Answer 404 if there is no such asset, 409 if it is archived."""
    known_asset(connection, name)
    if assets.is_archived(connection, name):
        raise ApiError(
            409, "the asset is archived", field="asset", value=name, remedy="POST /assets/{asset}/unarchive"
        )


def known_version(connection: Connection, name: str, version: int | None) -> assets.Version:
    """Return a version of an asset, by default the adopted one; answers 404 if there is none."""
    try:
        return assets.found_version(connection, name, version)
    except InputError as error:
        raise ApiError(404, error.problem, field=error.field, value=str(error.value)) from None


def known_record(connection: Connection, record_id: str) -> records.StoredRecord:
    """Return a record by its number; answers 404 if there is none."""
    found = records.records_with_id(connection, record_id)
    if not found:
        raise ApiError(404, "no such record", field="record_id", value=record_id)
    return found[0]
