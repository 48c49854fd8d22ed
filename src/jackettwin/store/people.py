"""Users, sessions of browsers, tokens of machines, and the audit log."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import Connection, delete, func, insert, select, update

from jackettwin.errors import InputError
from jackettwin.store.tables import audit, tokens, users

ROLES = ("viewer", "engineer", "admin")
"""Roles; each includes the rights of those before it."""


@dataclass(frozen=True)
class User:
    """A user with the hash of the password.

    Attributes
    ----------
    password_hash : empty for a user who logs in by OIDC or a proxy
    scope : visible assets, and groups as ``@NAME``; None for all
    expires_utc : end of the user's rights; None for never
    password_utc : time at which the password was set; None if unknown, as from 0.1.0
    """

    name: str
    role: str
    password_hash: str
    created_utc: datetime
    disabled: bool = False
    scope: list[str] | None = None
    expires_utc: datetime | None = None
    password_utc: datetime | None = None

    def may_enter(self, now: datetime) -> bool:
        """Return whether the user is neither disabled nor expired."""
        return not self.disabled and (self.expires_utc is None or self.expires_utc > now)


@dataclass(frozen=True)
class Grant:
    """A session or token, with its user's name and role; ``csrf`` is required for changes by a session."""

    user: str
    role: str
    kind: str
    csrf: str
    expires_utc: datetime
    scope: list[str] | None = None


def secret_hash(secret: str) -> str:
    """Return the stored hash of a random secret of 256 bits, which needs no salt."""
    return hashlib.sha256(secret.encode()).hexdigest()


def any_user(connection: Connection) -> bool:
    """Return whether a user is defined."""
    return bool(connection.scalar(select(func.count()).select_from(users)))


def add_user(connection: Connection, user: User) -> None:
    """Add a user, or replace the one of this name, whose sessions and tokens end.

    Raises
    ------
    InputError
        If the last admin would lose the role, or an admin would see only some assets.
    """
    if user.role == "admin" and user.scope is not None:
        raise InputError(
            "an admin sees every asset", field="assets", value=user.name, allowed="viewer, engineer"
        )
    if user.role != "admin" or user.disabled or user.expires_utc is not None:
        _refuse_last(connection, user.name)
    _remove(connection, user.name)
    connection.execute(insert(users).values(**vars(user)))


def find_user(connection: Connection, name: str) -> User | None:
    """Return a user, or None."""
    row = connection.execute(select(users).where(users.c.name == name)).one_or_none()
    return None if row is None else User(**row._mapping)


def known_user(connection: Connection, name: str) -> User:
    """Return a user.

    Raises
    ------
    InputError
        If there is no user of this name.
    """
    found = find_user(connection, name)
    if found is None:
        known = ", ".join(user.name for user in list_users(connection)) or "none yet"
        raise InputError("no such user", field="user", value=name, allowed=known)
    return found


def list_users(connection: Connection) -> list[User]:
    """Return all users by name."""
    return [User(**row._mapping) for row in connection.execute(select(users).order_by(users.c.name))]


def grant(
    connection: Connection,
    secret: str,
    *,
    kind: str,
    user: str,
    label: str,
    csrf: str,
    now: datetime,
    expires: datetime,
) -> None:
    """Store a session or token as a hash."""
    connection.execute(delete(tokens).where(tokens.c.expires_utc < now))
    connection.execute(
        insert(tokens).values(
            hash=secret_hash(secret),
            kind=kind,
            user=user,
            label=label,
            csrf=csrf,
            created_utc=now,
            expires_utc=expires,
        )
    )


def find_grant(connection: Connection, secret: str, now: datetime) -> Grant | None:
    """Return the session or token of a secret; None if unknown or expired, or if its user is disabled."""
    query = (
        select(tokens.c.user, users.c.role, tokens.c.kind, tokens.c.csrf, tokens.c.expires_utc, users.c.scope)
        .join(users, users.c.name == tokens.c.user)
        .where(tokens.c.hash == secret_hash(secret), users.c.disabled.is_(False))
        .where(users.c.expires_utc.is_(None) | (users.c.expires_utc > now))
    )
    row = connection.execute(query).one_or_none()
    found = None if row is None else Grant(**row._mapping)
    return found if found is not None and found.expires_utc > now else None


def revoke(connection: Connection, secret: str) -> None:
    """End a session or token."""
    connection.execute(delete(tokens).where(tokens.c.hash == secret_hash(secret)))


@dataclass(frozen=True)
class KnownToken:
    """A token without its secret."""

    user: str
    label: str
    created_utc: datetime
    expires_utc: datetime


def list_tokens(connection: Connection) -> list[KnownToken]:
    """Return the tokens of machines, oldest first."""
    columns = (tokens.c.user, tokens.c.label, tokens.c.created_utc, tokens.c.expires_utc)
    query = select(*columns).where(tokens.c.kind == "token").order_by(tokens.c.created_utc)
    return [KnownToken(*row) for row in connection.execute(query)]


def revoke_tokens(connection: Connection, user: str, label: str | None = None) -> int:
    """End a user's tokens of a label, or all tokens and sessions; return their number."""
    mine = [tokens.c.user == user]
    if label is not None:
        mine += [tokens.c.label == label, tokens.c.kind == "token"]
    return connection.execute(delete(tokens).where(*mine)).rowcount


def remove_user(connection: Connection, name: str) -> bool:
    """Remove a user with all sessions and tokens; return whether there was one.

    Raises
    ------
    InputError
        If it is the last admin or the last user, without whom the server would be open.
    """
    _refuse_last(connection, name)
    if [user.name for user in list_users(connection)] == [name]:
        raise InputError(
            "the last user cannot be removed, as the server would then be open", field="user", value=name
        )
    return _remove(connection, name)


def _refuse_last(connection: Connection, name: str) -> None:
    enabled = (users.c.role == "admin", users.c.disabled.is_(False), users.c.expires_utc.is_(None))
    admins = connection.scalars(select(users.c.name).where(*enabled).with_for_update()).all()
    if admins == [name]:
        raise InputError(
            "the last admin cannot be removed or changed",
            field="user",
            value=name,
            remedy="first make another user admin",
        )


def _remove(connection: Connection, name: str) -> bool:
    revoke_tokens(connection, name)
    return connection.execute(delete(users).where(users.c.name == name)).rowcount == 1


def note_down(
    connection: Connection, who: str, action: str, subject: str, outcome: str, now: datetime
) -> None:
    """Write a line into the audit log."""
    row = {
        "time_utc": now,
        "who": who[:64],
        "action": action[:64],
        "subject": subject[:255],
        "outcome": outcome[:64],
    }
    connection.execute(insert(audit).values(**row))


@dataclass(frozen=True)
class AuditLine:
    """An action of a user with its subject and outcome."""

    id: int
    time_utc: datetime
    who: str
    action: str
    subject: str
    outcome: str


def read_audit(connection: Connection, limit: int, before: int | None = None) -> list[AuditLine]:
    """Return lines of the audit log, newest first, before a line or from the end."""
    query = select(audit).order_by(audit.c.id.desc()).limit(limit)
    if before is not None:
        query = query.where(audit.c.id < before)
    return [AuditLine(**row._mapping) for row in connection.execute(query)]


def forget_audit(connection: Connection, before: datetime) -> int:
    """Delete the lines of the audit log before a time; return their number."""
    return connection.execute(delete(audit).where(audit.c.time_utc < before)).rowcount


def change_password(
    connection: Connection, name: str, password_hash: str, now: datetime, but: str = ""
) -> None:
    """Change a user's password; all sessions except the present one end."""
    new = {"password_hash": password_hash, "password_utc": now}
    connection.execute(update(users).where(users.c.name == name).values(**new))
    others = (tokens.c.user == name, tokens.c.kind == "session", tokens.c.hash != secret_hash(but))
    connection.execute(delete(tokens).where(*others))
