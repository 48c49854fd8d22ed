"""Authentication and authorisation: passwords, sessions, tokens, roles, CSRF, limits on guessing."""

from __future__ import annotations

import secrets
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import cache
from math import ceil
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError
from fastapi import Depends, Request, Response
from sqlalchemy import Connection, Engine

from jackettwin.errors import InputError
from jackettwin.service.login_attempts import LoginAttempts
from jackettwin.service.settings import ServiceSettings, is_loopback
from jackettwin.service.web.problems import ApiError
from jackettwin.store import people, reading, rights, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

COOKIE = "jackettwin_session"
SESSION = timedelta(hours=12)
TOKEN = timedelta(days=365)
SAFE_METHODS = ("GET", "HEAD", "OPTIONS")
ATTEMPTS, ATTEMPTS_FROM, ATTEMPTS_OF = 5, 30, 20
"""Failed logins per minute: of one name from one address, all from one address, and all of one name."""
PROXY_HEADERS = (
    "forwarded",
    "via",
    "x-real-ip",
    *(f"x-forwarded-{x}" for x in ("for", "host", "proto", "server")),
)
"""Headers of which a proxy sends at least one, if it is so configured."""
SHORTEST_PASSWORD = 12
"""Least number of characters; NIST SP 800-63B requires 8 and recommends more."""

_hasher = PasswordHasher()  # argon2id with the parameters of RFC 9106, second recommended choice


@cache
def nobodys_hash() -> str:
    """Return a hash to verify for unknown users, so that the response time does not reveal them."""
    return _hasher.hash(secrets.token_hex())


@dataclass(frozen=True)
class Who:
    """Authenticated sender of a request, with a role; ``kind`` is the way of authentication."""

    name: str
    role: str
    kind: str
    csrf: str = ""
    assets: rights.Assets = None

    def may(self, role: str) -> bool:
        """Return whether this role includes another one."""
        return people.ROLES.index(self.role) >= people.ROLES.index(role)

    def sees(self, asset: str) -> bool:
        """Return whether the sender may see an asset."""
        return self.assets is None or asset in self.assets

    @property
    def view(self) -> str:
        """Key of the visible assets, by which responses are cached; empty if all are visible."""
        return "" if self.assets is None else people.secret_hash(repr(sorted(self.assets)))[:16]


def hashed(password: str) -> str:
    """Return the argon2id hash of a password.

    Raises
    ------
    InputError
        If it is too short.
    """
    if len(password) < SHORTEST_PASSWORD:
        raise InputError(
            "the password is too short",
            field="password",
            allowed=f"{SHORTEST_PASSWORD} characters or more",
            remedy="use a few unrelated words",
        )
    return _hasher.hash(password)


def checked_login(connection: Connection, name: str, password: str, now: datetime) -> people.User | None:
    """Return the user of this name and password, or None, in the same time for unknown names."""
    user = people.find_user(connection, name)
    try:
        _hasher.verify((user and user.password_hash) or nobodys_hash(), password)
    except (VerificationError, InvalidHashError):
        return None
    return None if user is None or not user.may_enter(now) else user


def opened_session(
    service: Service, name: str, password: str, new: str | None, place: str
) -> tuple[people.User, str, str]:
    """Return the user of this name and password, a session's secret and CSRF token; the attempt is logged.

    An expired password only allows setting a new one.

    Raises
    ------
    ApiError
        401 if name or password is wrong, 403 if the password has expired without a new one given, 429 after
        too many tries.
    """
    limits, now, database = counted(service.login_attempts, name, place), service.now(), service.database
    with reading(database) as connection:  # hashing is slow, and must not block writers
        user = checked_login(connection, name, password, now)
    old = user is not None and _is_old(user, service.settings.password_days, now)
    replacement = hashed(_another(password, new)) if user is not None and new is not None else None
    entered = user is not None and (not old or replacement is not None)
    outcome = "ok" if entered else "expired" if old else "refused"
    with writing(database) as connection:
        people.note_down(connection, name, "login", place, outcome, now)
        if entered and replacement is not None:
            people.change_password(connection, name, replacement, now)
            people.note_down(connection, name, "password", place, "ok", now)
        grant = new_grant(connection, name, "session", "browser", now, SESSION) if entered else ("", "")
    if user is None:
        raise ApiError(401, "name or password is wrong")
    service.login_attempts.succeeded(limits)
    if not entered:
        remedy = "log in with a new password in `new`"
        raise ApiError(403, "the password has expired", field="new", remedy=remedy)
    return user, *grant


def _is_old(user: people.User, days: float | None, now: datetime) -> bool:
    """Return whether a password has expired; one of unknown age has."""
    if days is None:
        return False
    return user.password_utc is None or user.password_utc < now - timedelta(days=days)


def in_words(user: people.User) -> str:
    """Return the rights of a user in words, for the audit log."""
    scope = "" if user.scope is None else f" of {', '.join(user.scope)}"
    until = "" if user.expires_utc is None else f" until {user.expires_utc:%Y-%m-%d}"
    return f"{user.role}{scope}{until}"


def _another(old: str, new: str) -> str:
    if new == old:
        raise ApiError(422, "the new password equals the old one", field="new", allowed="another one")
    return new


def counted(attempts: LoginAttempts, name: str, place: str) -> dict[str, int]:
    """Count a login attempt and return its keys; without a name only by address.

    Raises
    ------
    ApiError
        429 after too many attempts.
    """
    peer = attempts.place(place)
    limits = {f"from {peer}": ATTEMPTS_FROM}
    if name:
        limits |= {f"{name} from {peer}": ATTEMPTS, name: ATTEMPTS_OF}
    wait = attempts.wait_s(limits)
    if wait > 0.0:
        raise ApiError(429, "too many failed logins; wait", headers={"Retry-After": str(ceil(wait))})
    return limits


def change_password(service: Service, name: str, old: str, new: str, place: str, secret: str) -> None:
    """Change a user's password after verifying the old one, since a stolen session does not suffice.

    Raises
    ------
    ApiError
        403 if the old one is wrong, 429 after too many tries.
    """
    limits, now = counted(service.login_attempts, name, place), service.now()
    with reading(service.database) as connection:
        right = checked_login(connection, name, old, now) is not None
    replacement = hashed(_another(old, new)) if right else ""
    with writing(service.database) as connection:
        people.note_down(connection, name, "password", place, "ok" if right else "refused", now)
        if right:
            people.change_password(connection, name, replacement, now, but=secret)
    if not right:
        raise ApiError(403, "the old password is wrong", field="old")
    service.login_attempts.succeeded(limits)


def secret_of(request: Request) -> str:
    """Return the secret of a request's session or token."""
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    return token.strip() if scheme.lower() == "bearer" else request.cookies.get(COOKIE, "")


def new_grant(
    connection: Connection, user: str, kind: str, label: str, now: datetime, lasts: timedelta
) -> tuple[str, str]:
    """Return the secret of a new session or token, and its CSRF token."""
    secret, csrf = secrets.token_urlsafe(32), secrets.token_urlsafe(32)
    people.grant(
        connection, secret, kind=kind, user=user, label=label, csrf=csrf, now=now, expires=now + lasts
    )
    return secret, csrf


def set_session(response: Response, secret: str, *, secure: bool) -> None:
    """Set the cookie of a session, not readable by scripts and not sent from other sites."""
    lasts = int(SESSION.total_seconds())
    response.set_cookie(COOKIE, secret, max_age=lasts, httponly=True, samesite="strict", secure=secure)


def who_asks(request: Request, database: Engine, settings: ServiceSettings, now: datetime) -> Who | None:
    """Return who sent a request.

    The sender is known by a bearer token, a session or a trusted proxy, or is anyone on an open loopback
    server.
    """
    with reading(database) as connection:
        if not people.any_user(connection):
            return (
                Who("local", "admin", "open") if settings.loopback and _from_here(request, settings) else None
            )
        scheme, _, token = request.headers.get("authorization", "").partition(" ")
        kind = "token" if scheme.lower() == "bearer" else "session"
        secret = token.strip() if kind == "token" else request.cookies.get(COOKIE)
        if secret or kind == "token":
            found = people.find_grant(connection, secret or "", now)
            if found is None or found.kind != kind:
                return None
            seen = rights.visible(connection, found.scope)
            return Who(found.user, found.role, kind, found.csrf if kind == "session" else "", seen)
        if settings.trusted_header and settings.trusts(request.state.peer):
            user = people.find_user(connection, request.headers.get(settings.trusted_header, ""))
            if user is not None and user.may_enter(now):
                return Who(user.name, user.role, "proxy", assets=rights.visible(connection, user.scope))
    return None


def unknown() -> ApiError:
    """Return the error for an unauthenticated sender."""
    return ApiError(
        401,
        "log in or send a token",
        headers={"WWW-Authenticate": "Bearer"},
        remedy="POST /api/v1/login, or Authorization: Bearer; a server without users is asked as localhost",
    )


def too_little(who: Who, role: str) -> ApiError:
    """Return the error for a sender whose role does not suffice."""
    return ApiError(403, f"this needs the role {role}; {who.name} is {who.role}")


def allowed(role: str) -> Callable[..., Awaitable[Who]]:
    """Return the dependency of a route that requires a role.

    If the path names an asset, the right to see it is also required; an invisible asset gives the same error
    as a missing one.
    """

    async def check(request: Request) -> Who:
        who: Who | None = request.state.who
        if who is None:
            raise unknown()
        if not who.may(role):
            raise too_little(who, role)
        asset = request.path_params.get("asset")
        if asset is not None and not who.sees(asset):
            raise ApiError(404, "no such asset or version", field="asset", value=asset)
        return who

    check.role = role  # type: ignore[attr-defined]  # read by the test that walks over all routes
    return check


def refuse_forged(request: Request, who: Who | None) -> None:
    """Raise an error on a request forged by another site: without CSRF token, or from another origin.

    Raises
    ------
    ApiError
        403.
    """
    if request.method in SAFE_METHODS:
        return
    origin = request.headers.get("origin")
    if origin and urlsplit(origin).netloc != request.headers.get("host"):
        raise ApiError(403, "the request was sent from another site")
    if who is not None and who.kind == "session":
        given = request.headers.get("x-csrf-token", "")
        if not secrets.compare_digest(given.encode(), who.csrf.encode()):
            raise ApiError(403, "the header X-CSRF-Token is missing or wrong; GET /api/v1/me returns it")


def _from_here(request: Request, settings: ServiceSettings) -> bool:
    """Return whether a request to an open server is from this machine, by its own name and without a proxy.

    Another site's name may resolve to 127.0.0.1, which a proxy also uses.
    """
    passed_on = settings.behind_proxy or any(name in request.headers for name in PROXY_HEADERS)
    return not passed_on and is_loopback(request.state.peer) and is_loopback(request.url.hostname or "")


VIEWER, ENGINEER, ADMIN = (Depends(allowed(role)) for role in people.ROLES)
