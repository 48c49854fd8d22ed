"""Dependencies of routes: the service, a connection, the sender, and the objects of a path.

A connection is opened before its route and closed before the response is sent (``scope="function"``), so that
the contents of a response are committed.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from typing import Annotated, Any

from anyio import CapacityLimiter
from fastapi import Depends, HTTPException, Path, Query, Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.service.answer_cache import Answer, content_tag, has_tag
from jackettwin.service.context import Service
from jackettwin.service.web import names
from jackettwin.service.web.auth import Who
from jackettwin.service.web.problems import ApiError, laid_out_soon
from jackettwin.store import assets, journal, reading, records, writing

_JSON = "application/json"


async def get_service(request: Request) -> Service:
    """Return the server's components."""
    service: Service = request.app.state.service
    return service


async def asker(request: Request) -> Who:
    """Return the sender of the request, after the route has checked the role."""
    who: Who = request.state.who
    return who


def at_most(requests: int) -> Any:
    """Return a dependency that limits the number of simultaneous requests.

    FastAPI runs dependencies and routes in 40 threads. A request with a connection needs another thread to
    continue; if all threads waited for connections, or for SQLite's only writer, there would be a deadlock.
    The limits below leave some threads free.
    """
    limiter = CapacityLimiter(requests)

    async def proceed() -> AsyncIterator[None]:
        async with limiter:
            yield

    return Depends(proceed, scope="function")


CONNECTED, WAITING = at_most(12), at_most(16)
"""Limits of requests with a connection, and of those that wait for a worker without one."""

Parts = Annotated[Service, Depends(get_service)]
Asker = Annotated[Who, Depends(asker)]
AssetName = Annotated[str, Path(pattern=names.ASSET, examples=["demo"])]
AnyVersion = Annotated[int | None, Query(ge=1, le=1_000_000, description="Default: the adopted one.")]
RecordId = Annotated[str, Path(pattern=names.RECORD, examples=["0123456789abcdef01234567"])]


def read(service: Parts, _: Annotated[None, CONNECTED]) -> Iterator[Connection]:
    """Yield a connection with a snapshot of the database."""
    with reading(service.database) as connection:
        yield connection


def write(service: Parts, _: Annotated[None, CONNECTED]) -> Iterator[Connection]:
    """Yield a connection in a transaction, which is committed if the route succeeds."""
    with writing(service.database) as connection:
        yield connection


Reads = Annotated[Connection, Depends(read, scope="function")]
Writes = Annotated[Connection, Depends(write, scope="function")]


class KnownAnswer(Exception):
    """Raised instead of calling a route whose response is in the cache."""

    def __init__(self, answer: Answer, headers: dict[str, str]) -> None:
        super().__init__()
        self.answer, self.headers = answer, headers


def read_version(request: Request, service: Parts, connection: Reads) -> Connection:
    """Yield a connection for data that change only with an event; the newest event is the response's version.

    The route is not called if the client has this version or the cache has its response. The version is read
    before the data: an event in between gives a new version, and the next response is made again.
    """
    version = journal.last_event(connection, request.path_params.get("asset"))
    who: Who = request.state.who
    headers = _tagged(f'W/"{service.server_id}-{version}{who.view and "-" + who.view}"')
    if has_tag(request.headers.get("if-none-match"), headers["ETag"]):
        raise HTTPException(304, headers=headers)
    known = service.answers.find(_question(request), version)
    if known is not None:
        raise KnownAnswer(known, headers)
    request.state.version, request.state.tag = version, headers
    return connection


ReadsAtVersion = Annotated[Connection, Depends(read_version, scope="function")]


class Route(APIRoute):
    """A route that rejects unknown query parameters and sends a response only if the client lacks it."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the handler of a request."""
        answer = super().get_route_handler()
        known = {parameter.alias for parameter in self.dependant.query_params}

        async def handle(request: Request) -> Response:
            unknown = next((name for name in request.query_params if name not in known), None)
            if unknown is not None and self.include_in_schema:
                allowed = ", ".join(sorted(known)) or "none here"
                raise ApiError(422, "no such query parameter", field=unknown, allowed=allowed)
            try:
                response = await answer(request)
            except ApiError as error:
                if error.problem.status == 404 and request.app.state.service.laying_out:
                    raise laid_out_soon() from None
                raise
            if hasattr(request.state, "version"):
                return _versioned(request, response)
            return _by_content(request, response) if request.method == "GET" else response

        return handle


def _versioned(request: Request, response: Response) -> Response:
    """Return a response with its version, and cache it if it is JSON."""
    if response.media_type != _JSON:
        response.headers.update(request.state.tag)
        return response
    made = Answer.of(request.state.version, bytes(response.body))
    request.app.state.service.answers.keep(_question(request), made)
    return sent(request, made, request.state.tag)


def sent(request: Request, answer: Answer, headers: dict[str, str]) -> Response:
    """Return a cached response, compressed if the client accepts this."""
    if "gzip" not in request.headers.get("accept-encoding", ""):
        return Response(answer.body, headers=headers, media_type=_JSON)
    packed = {**headers, "Content-Encoding": "gzip"}
    return Response(answer.compressed, headers=packed, media_type=_JSON)


def _by_content(request: Request, response: Response) -> Response:
    """Return a JSON response with a tag of its content; status 304 if the client has it."""
    if response.media_type != _JSON or response.status_code != 200:
        return response
    headers = _tagged(content_tag(bytes(response.body)))
    if has_tag(request.headers.get("if-none-match"), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    response.headers.update(headers)
    return response


def _question(request: Request) -> str:
    return f"{request.url.path}?{request.url.query} {request.state.who.view}"


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


def known_record(connection: Connection, record_id: str, who: Who) -> records.StoredRecord:
    """Return a record of a visible asset by its number; answers 404 if there is none."""
    found = [record for record in records.records_with_id(connection, record_id) if who.sees(record.asset)]
    if not found:
        raise ApiError(404, "no such record", field="record_id", value=record_id)
    return found[0]
