"""Routes for login and logout, users and tokens."""

from __future__ import annotations

from datetime import timedelta
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from jackettwin.service.web import auth
from jackettwin.service.web.dependencies import CONNECTED, Asker, AssetName, Parts, Reads, Route, Writes
from jackettwin.service.web.problems import ApiError, answers
from jackettwin.service.web.schemas.common import Page
from jackettwin.service.web.schemas.people import (
    AuditOut,
    GroupIn,
    GroupOut,
    Login,
    Me,
    NewPassword,
    NewToken,
    NewUser,
    Token,
    UserOut,
)
from jackettwin.store import people, rights

router = APIRouter(tags=["people"], route_class=Route)


@router.post("/login", dependencies=[CONNECTED], responses=answers(401, 403, 422, 429))
def login(body: Login, request: Request, response: Response, parts: Parts) -> Me:
    """Open a session: set its cookie and return the CSRF token for changes."""
    place = request.client.host if request.client else "?"
    user, secret, csrf = auth.opened_session(parts, body.name, body.password, body.new, place)
    auth.set_session(response, secret, secure=parts.settings.secure)
    return Me(name=user.name, role=user.role, csrf_token=csrf)  # type: ignore[arg-type]


@router.post("/logout", status_code=204, dependencies=[auth.VIEWER], responses=answers(401, 403))
def logout(request: Request, response: Response, who: Asker, parts: Parts, connection: Writes) -> None:
    """End the session or token of the request."""
    people.revoke(connection, auth.secret_of(request))
    people.note_down(connection, who.name, "logout", who.kind, "ok", parts.now())
    response.delete_cookie(auth.COOKIE)


@router.get("/me", dependencies=[auth.VIEWER], responses=answers(401))
def me(who: Asker) -> Me:
    """Return the user of the request."""
    return Me(
        name=who.name,
        role=who.role,  # type: ignore[arg-type]
        csrf_token=who.csrf or None,
    )


@router.post(
    "/me/password",
    status_code=204,
    dependencies=[auth.VIEWER, CONNECTED],
    responses=answers(400, 401, 403, 409, 422, 429),
)
def change_password(body: NewPassword, request: Request, who: Asker, parts: Parts) -> None:
    """Change one's own password; other sessions end, tokens do not."""
    if who.kind in ("open", "proxy"):
        raise ApiError(409, "the request is not from a user with a password")
    place = request.client.host if request.client else "?"
    auth.change_password(parts, who.name, body.old, body.new, place, auth.secret_of(request))


@router.get("/audit", dependencies=[auth.ADMIN], responses=answers(401, 403, 422))
def audit(
    connection: Reads,
    cursor: Annotated[int | None, Query(ge=1, le=2**62)] = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> Page[AuditOut]:
    """List the actions of users, newest first."""
    found = people.read_audit(connection, limit + 1, cursor)
    more = str(found[limit - 1].id) if len(found) > limit else None
    items = [AuditOut.model_validate(line, from_attributes=True) for line in found[:limit]]
    return Page(items=items, next_cursor=more)


@router.get("/users", dependencies=[auth.ADMIN], responses=answers(401, 403))
def users(connection: Reads) -> Page[UserOut]:
    """List the users."""
    return Page(items=[_out(user) for user in people.list_users(connection)])


@router.post("/users", status_code=201, dependencies=[auth.ADMIN], responses=answers(400, 401, 403, 422))
def add_user(body: NewUser, who: Asker, parts: Parts, connection: Writes) -> UserOut:
    """Add a user, or change role and password of one."""
    now = parts.now()
    scope = None if body.assets is None else rights.checked_scope(connection, body.assets)
    password = "" if body.password is None else auth.hashed(body.password)
    user = people.User(
        body.name, body.role, password, now, scope=scope, expires_utc=body.expires_utc, password_utc=now
    )
    people.add_user(connection, user)
    people.note_down(connection, who.name, "user add", body.name, auth.in_words(user), now)
    return _out(user)


@router.get("/groups", dependencies=[auth.ADMIN], responses=answers(401, 403))
def groups(connection: Reads) -> Page[GroupOut]:
    """List the groups of assets for users' rights."""
    found = rights.groups(connection).items()
    return Page(items=[GroupOut(name=name, assets=members) for name, members in found])


@router.put("/groups/{group}", dependencies=[auth.ADMIN], responses=answers(400, 401, 403, 422))
def put_group(group: AssetName, body: GroupIn, who: Asker, parts: Parts, connection: Writes) -> GroupOut:
    """Define the assets of a group; without assets it is deleted."""
    members = rights.put_group(connection, group, body.assets)
    people.note_down(connection, who.name, "group", f"{group}: {', '.join(members)}", "ok", parts.now())
    return GroupOut(name=group, assets=members)


@router.post(
    "/tokens", status_code=201, dependencies=[auth.VIEWER], responses=answers(400, 401, 403, 409, 422)
)
def add_token(body: NewToken, who: Asker, parts: Parts, connection: Writes) -> Token:
    """Create a token for a machine, with the role of the user."""
    if who.kind == "open":
        raise ApiError(409, "this server is open to its own machine; define a user first")
    lasts = timedelta(days=body.days)
    secret, _ = auth.new_grant(connection, who.name, "token", body.label, parts.now(), lasts)
    people.note_down(connection, who.name, "token add", body.label, "ok", parts.now())
    return Token(token=secret, expires_utc=parts.now() + lasts)


def _out(user: people.User) -> UserOut:
    return UserOut(
        name=user.name,
        role=user.role,  # type: ignore[arg-type]
        created_utc=user.created_utc,
        disabled=user.disabled,
        assets=user.scope,
        expires_utc=user.expires_utc,
    )
