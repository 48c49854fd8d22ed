"""The web application: routes under /api/v1, pages under /, and what every request passes through."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

from fastapi import FastAPI, Request, Response
from fastapi.responses import JSONResponse
from sqlalchemy.exc import SQLAlchemyError
from starlette.middleware.gzip import GZipMiddleware

from jackettwin.service import auth, pages, problems
from jackettwin.service.context import Service
from jackettwin.service.routes import assets, health, jobs, modes, people, records
from jackettwin.version import __version__

API = "/api/v1"
ROUTERS = (people.router, assets.router, records.router, modes.router, jobs.router, health.router)
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Content-Security-Policy": (
        "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
        "worker-src blob:; frame-ancestors 'none'"
    ),
}
"""Scripts come from files of ours alone; Plotly writes styles into the page."""
_FIELDS_BYTES = 2**20
"""Room for what comes beside a file in a form."""


def create_app(service: Service) -> FastAPI:
    """Return the application of a server."""

    @asynccontextmanager
    async def living(_: FastAPI) -> AsyncIterator[None]:
        feed = asyncio.create_task(service.feed.run())
        yield
        feed.cancel()
        with suppress(asyncio.CancelledError):
            await feed

    app = FastAPI(
        title="jackettwin",
        summary="A digital twin of jacket foundations that lives: records in, answers out.",
        version=__version__,
        openapi_url=f"{API}/openapi.json",
        docs_url=None,
        redoc_url=None,
        lifespan=living,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
    )
    app.state.service = service
    problems.register(app)
    for router in ROUTERS:
        app.include_router(router, prefix=API)
    app.include_router(pages.router)
    app.middleware("http")(_guarded(service))
    app.add_middleware(GZipMiddleware, minimum_size=1000)
    return app


def _guarded(
    service: Service,
) -> Callable[[Request, Callable[[Request], Awaitable[Response]]], Awaitable[Response]]:
    async def guard(request: Request, go_on: Callable[[Request], Awaitable[Response]]) -> Response:
        """Know who asks.

        Refuse what is forged or too large, mark answers so that unchanged ones need not be sent.
        """
        try:
            length = request.headers.get("content-length", "0")
            most = service.settings.upload_limit_bytes + _FIELDS_BYTES
            if not length.isdecimal() or int(length) > most:
                raise problems.ApiError(413, "the request is too large", allowed=f"up to {most} bytes")
            request.state.who = await _who(service, request)
            auth.refuse_forged(request, request.state.who)
        except problems.ApiError as error:
            return JSONResponse(
                error.problem.model_dump(exclude_none=True),
                error.problem.status,
                error.headers,
                media_type=problems.MEDIA_TYPE,
            )
        response = await go_on(request)
        response.headers.update({k: v for k, v in _HEADERS.items() if k not in response.headers})
        if service.settings.secure:
            response.headers["Strict-Transport-Security"] = "max-age=31536000"
        return await _tagged(request, response)

    return guard


async def _who(service: Service, request: Request) -> auth.Who | None:
    """Return who asks; without a database only the questions about the server's health are answered."""
    try:
        return await asyncio.to_thread(
            auth.who_asks, request, service.database, service.settings, service.now()
        )
    except SQLAlchemyError:
        if request.url.path in (f"{API}/health", f"{API}/ready"):
            return None
        raise problems.no_database() from None


async def _tagged(request: Request, response: Response) -> Response:
    """Give an answer of JSON a tag of its content; one the reader has already is not sent again."""
    kind = response.headers.get("content-type", "")
    if request.method != "GET" or response.status_code != 200 or not kind.startswith("application/json"):
        return response
    body = b"".join([piece async for piece in response.body_iterator])  # type: ignore[attr-defined]
    tag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
    headers = {k: v for k, v in response.headers.items() if k != "content-length"} | {"ETag": tag}
    headers["Cache-Control"] = "private, no-cache"
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers={k: v for k, v in headers.items() if k != "content-type"})
    return Response(body, headers=headers)
