"""Routes of the login at an OpenID provider: the redirect to it and the callback."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Cookie, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from jackettwin.service.web import auth, oidc
from jackettwin.service.web.dependencies import Parts, Route, at_most

router = APIRouter(tags=["people"], include_in_schema=False, route_class=Route)

_ASKING = at_most(4)
"""Limit of requests that wait for the provider, so that a hanging one does not block all threads."""
_HOME = '<!doctype html><meta http-equiv="refresh" content="0;url=/"><a href="/">jackettwin</a>'
"""Page that redirects to the window, as a strict cookie is not sent after a redirect from another site."""


@router.get("/oidc/login", dependencies=[_ASKING])
def login(parts: Parts) -> Response:
    """Send a browser to the provider."""
    url, begun = oidc.begin(parts.settings)
    response = RedirectResponse(url, status_code=302, headers={"Cache-Control": "no-store"})
    secure = parts.settings.secure
    response.set_cookie(
        oidc.COOKIE,
        begun.cookie,
        max_age=oidc.COOKIE_S,
        path=oidc.CALLBACK,
        httponly=True,
        samesite="lax",
        secure=secure,
    )
    return response


@router.get("/oidc/callback", dependencies=[_ASKING])
def callback(
    request: Request, parts: Parts, kept: Annotated[str, Cookie(alias=oidc.COOKIE, max_length=500)] = ""
) -> Response:
    """Verify the provider's answer and open a session."""
    place = request.client.host if request.client else "?"
    secret = oidc.finish(parts, request.query_params, kept, place)
    response = HTMLResponse(_HOME, headers={"Cache-Control": "no-store"})
    auth.set_session(response, secret, secure=parts.settings.secure)
    response.delete_cookie(oidc.COOKIE, path=oidc.CALLBACK)
    return response
