"""The web application: routes under /api/v1, pages under /, and what every request passes through."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress

from fastapi import FastAPI, Request
from sqlalchemy.exc import SQLAlchemyError
from starlette.datastructures import MutableHeaders
from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

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
    app.add_middleware(Guard, service=service)
    app.add_middleware(GZipMiddleware, minimum_size=1000, compresslevel=1)
    return app


class Guard:
    """Know who asks; refuse what is forged or too large; say to browsers what they may do with answers."""

    def __init__(self, app: ASGIApp, service: Service) -> None:
        self._app, self._service = app, service
        own = {"Strict-Transport-Security": "max-age=31536000"} if service.settings.secure else {}
        self._headers = {**_HEADERS, **own}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or answer it."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        request = Request(scope)

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in self._headers.items():
                    headers.setdefault(name, value)
            await send(message)

        try:
            self._refuse_large(request)
            request.state.who = await _who(self._service, request)
            auth.refuse_forged(request, request.state.who)
        except problems.ApiError as error:
            return await problems.answered(error)(scope, receive, with_headers)
        await self._app(scope, receive, with_headers)

    def _refuse_large(self, request: Request) -> None:
        length = request.headers.get("content-length", "0")
        most = self._service.settings.upload_limit_bytes + _FIELDS_BYTES
        if not length.isdecimal() or int(length) > most:
            raise problems.ApiError(413, "the request is too large", allowed=f"up to {most} bytes")


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
