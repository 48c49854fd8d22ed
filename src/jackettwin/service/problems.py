"""Errors as problem documents, RFC 9457."""

from __future__ import annotations

import errno
import json
from typing import Any

from fastapi import FastAPI, HTTPException, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from pydantic import BaseModel, ConfigDict
from sqlalchemy.exc import DataError, OperationalError
from starlette.exceptions import HTTPException as StarletteHTTPException

from jackettwin.errors import InputError
from jackettwin.service.begun import NoWorker

MEDIA_TYPE = "application/problem+json"


class ProblemDocument(BaseModel):
    """What was wrong, where, and what to do."""

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
    503: "Service Unavailable",
    507: "Insufficient Storage",
}


class ApiError(Exception):
    """Answer a request with a problem document."""

    def __init__(
        self, status: int, detail: str, *, headers: dict[str, str] | None = None, **members: Any
    ) -> None:
        super().__init__(detail)
        self.problem = ProblemDocument(title=TITLES[status], status=status, detail=detail, **members)
        self.headers = headers


def no_database() -> ApiError:
    """Return the answer while the database is away: what was asked can be asked again."""
    return ApiError(503, "the database does not answer; try again soon", headers={"Retry-After": "5"})


def disk_full() -> ApiError:
    """Return the answer where nothing more can be written."""
    return ApiError(507, "the disk of the store is full", remedy="make room, or prune old samples")


def as_problem(error: InputError, status: int = 422) -> ProblemDocument:
    """Return an error of the user's input as a problem document; paths of ours are left out."""
    return ProblemDocument(
        title=TITLES[status],
        status=status,
        detail=error.problem,
        field=error.field,
        value=None if error.value is None else str(error.value)[:200],
        allowed=error.allowed,
        remedy=error.remedy,
    )


def answers(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the declaration of the problems a route may answer with."""
    return {
        status: {
            "description": TITLES[status],
            "content": {MEDIA_TYPE: {"schema": ProblemDocument.model_json_schema()}},
        }
        for status in statuses
    }


def register(app: FastAPI) -> None:
    """Have every error of an application answered by a problem document."""
    app.add_exception_handler(ApiError, _api_error)
    app.add_exception_handler(InputError, _input_error)
    app.add_exception_handler(StarletteHTTPException, _http_error)
    app.add_exception_handler(RequestValidationError, _invalid_request)
    app.add_exception_handler(OperationalError, _database_away)
    app.add_exception_handler(DataError, _not_kept)
    app.add_exception_handler(UnicodeEncodeError, _not_kept)
    app.add_exception_handler(NoWorker, _no_worker)
    app.add_exception_handler(OSError, _disk_full)
    app.add_exception_handler(Exception, _our_fault)


def _answer(problem: ProblemDocument, headers: dict[str, str] | None = None) -> Response:
    content = json.dumps(problem.model_dump(exclude_none=True))  # in ASCII: half a character is quoted, too
    return Response(content, problem.status, headers, media_type=MEDIA_TYPE)


def answered(error: ApiError) -> Response:
    """Return the answer that an error is."""
    return _answer(error.problem, error.headers)


async def _api_error(_: Request, error: Exception) -> Response:
    assert isinstance(error, ApiError)
    return answered(error)


async def _input_error(_: Request, error: Exception) -> Response:
    assert isinstance(error, InputError)
    return _answer(as_problem(error))


async def _database_away(_: Request, error: Exception) -> Response:
    assert isinstance(error, OperationalError)
    away = no_database()
    return _answer(away.problem, away.headers)


async def _not_kept(_: Request, error: Exception) -> Response:
    """Answer what no database can keep: half a character; in PostgreSQL, a NUL."""
    return answered(ApiError(422, "a text holds characters that cannot be kept"))


async def _no_worker(_: Request, error: Exception) -> Response:
    busy = "every worker is busy; nothing was kept, send it again"
    return answered(ApiError(503, busy, headers={"Retry-After": "30"}))


async def _disk_full(_: Request, error: Exception) -> Response:
    if not isinstance(error, OSError) or error.errno != errno.ENOSPC:
        raise error
    return answered(disk_full())


async def _our_fault(_: Request, error: Exception) -> Response:
    """Say no more than that; the log has the rest."""
    return _answer(ProblemDocument(title="Internal Server Error", status=500, detail="a fault of ours"))


async def _http_error(_: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException | StarletteHTTPException)
    title = TITLES.get(error.status_code, "Error")
    headers = dict(error.headers) if error.headers else None
    return _answer(ProblemDocument(title=title, status=error.status_code, detail=str(error.detail)), headers)


async def _invalid_request(_: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"] if part not in ("body", "query", "path", "header"))
    value = first.get("input")
    return _answer(
        ProblemDocument(
            title=TITLES[422],
            status=422,
            detail=first["msg"],
            field=place or None,
            value=None if value is None else str(value)[:200],
            remedy="see /api/v1/openapi.json for what is allowed",
        )
    )
