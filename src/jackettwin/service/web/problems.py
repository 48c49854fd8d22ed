"""Errors as problem documents, RFC 9457."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict
from sqlalchemy.exc import DataError, OperationalError
from starlette.exceptions import HTTPException as StarletteHTTPException

from jackettwin.errors import InputError
from jackettwin.service.web.names import ALLOWED
from jackettwin.service.workers.failures import DISK_FULL, NoWorker, problem_of

MEDIA_TYPE = "application/problem+json"


class ProblemDocument(BaseModel):
    """Error with its place and remedy."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "type": "about:blank",
                "title": "Unprocessable Content",
                "status": 422,
                "detail": "sample rate must be a positive number",
                "field": "sample_rate_hz",
                "value": "0",
                "allowed": "1e-09 to 1e+09",
                "remedy": "state the logger's rate in Hz",
            }
        }
    )

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    field: str | None = None
    value: str | None = None
    allowed: str | None = None
    remedy: str | None = None


TITLES = {
    400: "Bad Request",
    401: "Unauthorized",
    403: "Forbidden",
    404: "Not Found",
    405: "Method Not Allowed",
    409: "Conflict",
    413: "Content Too Large",
    415: "Unsupported Media Type",
    422: "Unprocessable Content",
    429: "Too Many Requests",
    500: "Internal Server Error",
    503: "Service Unavailable",
    507: "Insufficient Storage",
}


class ApiError(Exception):
    """Error that is sent as a problem document."""

    def __init__(
        self, status: int, detail: str, *, headers: dict[str, str] | None = None, **members: Any
    ) -> None:
        super().__init__(detail)
        self.problem = ProblemDocument(title=TITLES[status], status=status, detail=detail, **members)
        self.headers = headers


def no_database() -> ApiError:
    """Return the error while the database is not available; the request can be repeated."""
    return ApiError(503, "the database does not answer; try again soon", headers={"Retry-After": "5"})


def laid_out_soon() -> ApiError:
    """Return the error for what may be part of the demonstration before it is there."""
    remedy = "it is here in a few seconds"
    return ApiError(503, "the demonstration is being laid out", headers={"Retry-After": "2"}, remedy=remedy)


def disk_full() -> ApiError:
    """Return the error if the disk is full."""
    return ApiError(
        507,
        "nothing can be written: the disk of the store is full, or read-only",
        remedy="free disk space, or store samples for fewer days (`serve --raw-days`); see the system's log",
    )


def answers(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the declaration of the errors of a route."""
    return {
        status: {
            "description": TITLES[status],
            "content": {MEDIA_TYPE: {"schema": ProblemDocument.model_json_schema()}},
        }
        for status in statuses
    }


def register(app: FastAPI) -> None:
    """Make an application answer every error by a problem document."""
    not_kept = "a text contains characters that cannot be stored"  # half a character; in PostgreSQL, a NUL
    busy = "every worker is busy and nothing was stored; send the request again"
    made: dict[type[Exception], Callable[[Any], Response]] = {
        ApiError: answered,
        InputError: lambda error: answered(ApiError(422, **problem_of(error))),
        StarletteHTTPException: _http_error,
        RequestValidationError: _invalid_request,
        OperationalError: lambda _: answered(no_database()),
        DataError: lambda _: answered(ApiError(422, not_kept)),
        UnicodeEncodeError: lambda _: answered(ApiError(422, not_kept)),
        NoWorker: lambda _: answered(ApiError(503, busy, headers={"Retry-After": "30"})),
        OSError: _disk_full,
        # details are only in the log
        Exception: lambda _: answered(ApiError(500, "internal error of the server")),
    }
    for kind, answer in made.items():
        app.add_exception_handler(kind, _handler(answer))


def _handler(answer: Callable[[Any], Response]) -> Callable[[Request, Exception], Awaitable[Response]]:
    async def handle(_: Request, error: Exception) -> Response:
        return answer(error)

    return handle


def _answer(problem: ProblemDocument, headers: dict[str, str] | None = None) -> Response:
    content = json.dumps(problem.model_dump(exclude_none=True))  # in ASCII: half a character is quoted, too
    return Response(content, problem.status, headers, media_type=MEDIA_TYPE)


def answered(error: ApiError) -> Response:
    """Return the response of an error."""
    return _answer(error.problem, error.headers)


def _disk_full(error: OSError) -> Response:
    if error.errno not in DISK_FULL:
        raise error
    return answered(disk_full())


def _http_error(error: StarletteHTTPException) -> Response:
    title = TITLES.get(error.status_code, "Error")
    headers = dict(error.headers) if error.headers else None
    if error.status_code == 304:  # the client has the response
        return Response(status_code=304, headers=headers)
    return _answer(ProblemDocument(title=title, status=error.status_code, detail=str(error.detail)), headers)


def _invalid_request(error: RequestValidationError) -> Response:
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"] if part not in ("body", "query", "path", "header"))
    value = first.get("input")
    allowed = ALLOWED.get(first.get("ctx", {}).get("pattern", ""))
    return _answer(
        ProblemDocument(
            title=TITLES[422],
            status=422,
            detail=first["msg"]
            if allowed is None
            else f"{str(value)[:80]!r} is not a name that is possible here",
            allowed=allowed,
            field=place or None,
            value=None if value is None else str(value)[:200],
            remedy="see /api/v1/openapi.json for what is allowed"
            if allowed is None
            else "write it with these characters only, for instance wtg_01",
        )
    )
