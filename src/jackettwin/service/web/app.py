"""Web application: routes under /api/v1, pages under /, and the middleware of all requests."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from importlib.resources import files
from typing import Any

from fastapi import FastAPI, HTTPException, Request, Response
from sqlalchemy.exc import SQLAlchemyError
from starlette.datastructures import MutableHeaders
from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from jackettwin.service.context import Service
from jackettwin.service.web import auth, pages, problems
from jackettwin.service.web.dependencies import KnownAnswer, sent
from jackettwin.service.web.routes import (
    alert_channels,
    assets,
    assumptions,
    findings,
    health,
    jobs,
    laws,
    modes,
    oidc,
    people,
    records,
)
from jackettwin.version import __version__

API = "/api/v1"
EXAMPLES: dict[str, Any] = json.loads(files("jackettwin.service").joinpath("examples.json").read_bytes())
"""One example of every schema, by its name."""
ROUTERS = (
    people.router,
    oidc.router,
    assets.router,
    records.router,
    modes.router,
    laws.router,
    findings.router,
    alert_channels.router,
    assumptions.router,
    jobs.router,
    health.router,
)
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Content-Security-Policy": (
        "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; "
        "form-action 'self'; frame-ancestors 'none'"
    ),
}
"""Headers of all responses; scripts and styles may only come from this server's files."""
_FIELDS_BYTES = 2**20
"""Allowance for form fields other than the file."""
_TEXT_BYTES = 32 * 2**20
"""Largest request that is not a form, for twins with their files and years of conditions."""
_FEW_BYTES = 2**16
"""Largest request of clients who may not send files, for a name and a password."""


def create_app(service: Service) -> FastAPI:
    """Return the application of a server."""

    @asynccontextmanager
    async def living(_: FastAPI) -> AsyncIterator[None]:
        feed = asyncio.create_task(service.feed.run())
        await asyncio.to_thread(auth.nobodys_hash)  # the first login must not take longer
        yield
        feed.cancel()
        with suppress(asyncio.CancelledError):
            await feed

    app = FastAPI(
        title="jackettwin",
        summary="Living digital twins of jacket foundations.",
        version=__version__,
        openapi_url=f"{API}/openapi.json",
        docs_url=None,
        redoc_url=None,
        lifespan=living,
        license_info={"name": "Apache-2.0", "identifier": "Apache-2.0"},
    )
    app.state.service = service
    problems.register(app)
    app.add_exception_handler(KnownAnswer, known_answer)
    for router in ROUTERS:
        app.include_router(router, prefix=API)
    app.include_router(pages.router)
    app.openapi = lambda: described(app)  # type: ignore[method-assign]
    app.add_middleware(Guard, service=service)
    app.add_middleware(GZipMiddleware, minimum_size=1000, compresslevel=1)
    app.add_middleware(BelievedProxies, service=service)
    return app


async def known_answer(request: Request, known: Exception) -> Response:
    """Answer from the cache."""
    assert isinstance(known, KnownAnswer)
    return sent(request, known.answer, known.headers)


def described(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI document, with an example of every request and response."""
    document = FastAPI.openapi(app)
    for name, schema in document["components"]["schemas"].items():
        of = name.removeprefix("Page_").removesuffix("_")
        if of in EXAMPLES:
            one = EXAMPLES[of]
            schema["example"] = one if of == name else {"items": [one], "next_cursor": None}
    return document


class BelievedProxies:
    """Middleware that stores the peer's address and applies the headers of a trusted proxy."""

    def __init__(self, app: ASGIApp, service: Service) -> None:
        self._app, trusted = app, service.settings.trusted_proxies
        if service.settings.behind_proxy:
            self._app = ProxyHeadersMiddleware(app, trusted_hosts=list(trusted))  # type: ignore[arg-type, assignment]

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""
        if scope["type"] == "http":
            scope.setdefault("state", {})["peer"] = (scope["client"] or ("", 0))[0]
        await self._app(scope, receive, send)


class Guard:
    """Middleware that authenticates, rejects forged or too large requests, and sets security headers."""

    def __init__(self, app: ASGIApp, service: Service) -> None:
        self._app, self._service = app, service
        own = {"Strict-Transport-Security": "max-age=31536000"} if service.settings.secure else {}
        self._headers = {**_HEADERS, **own}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or answer it."""
        if scope["type"] != "http":
            return await self._app(scope, receive, send)
        with self._service.latency.request(scope) as said:
            await self._answer(scope, receive, send, said)

    async def _answer(self, scope: Scope, receive: Receive, send: Send, said: dict[str, Any]) -> None:
        request = Request(scope)

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                said["status"] = message["status"]
                headers = MutableHeaders(scope=message)
                for name, value in self._headers.items():
                    headers.setdefault(name, value)
            await send(message)

        try:
            request.state.who = await _who(self._service, request)
            auth.refuse_forged(request, request.state.who)
            bounded = self._bounded(request, receive)
        except problems.ApiError as error:
            return await problems.answered(error)(scope, receive, with_headers)
        await self._app(scope, bounded, with_headers)

    def _bounded(self, request: Request, receive: Receive) -> Receive:
        """Return the receiver of the request's body with the limit of its sender, applied before the route.

        Raises
        ------
        ApiError
            If the stated size exceeds the limit, which is small without login or without the right to send
            files.
        """
        who = request.state.who
        if who is None and request.method not in auth.SAFE_METHODS and request.url.path != f"{API}/login":
            raise auth.unknown()
        sends = who is not None and who.may("engineer")
        most = _TEXT_BYTES if sends else _FEW_BYTES
        if who is not None and request.headers.get("content-type", "").startswith("multipart/"):
            if not sends:
                raise auth.too_little(who, "engineer")
            most = self._service.settings.upload_limit_bytes + _FIELDS_BYTES
        length = request.headers.get("content-length", "0")
        if not length.isdecimal() or int(length) > most:
            raise problems.ApiError(413, "the request is too large", allowed=f"up to {most} bytes")
        came = 0

        async def counted() -> Message:
            nonlocal came
            message = await receive()
            came += len(message.get("body", b""))
            if came > most:
                raise HTTPException(413, f"the request is too large; allowed: up to {most} bytes")
            return message

        return counted


async def _who(service: Service, request: Request) -> auth.Who | None:
    """Return the sender of a request; without a database only health requests are answered."""
    try:
        return await asyncio.to_thread(
            auth.who_asks, request, service.database, service.settings, service.now()
        )
    except SQLAlchemyError:
        if request.url.path in (f"{API}/health", f"{API}/ready"):
            return None
        raise problems.no_database() from None
