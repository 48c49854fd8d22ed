"""Schemas of logins, users, groups, tokens and the log of actions."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import AwareDatetime, BaseModel, Field

from jackettwin.service.web import names
from jackettwin.service.web.schemas.common import FIRST, LAST


class Login(BaseModel):
    """Name and password."""

    name: str = Field(max_length=64)
    password: str = Field(max_length=1024)
    new: str | None = Field(
        default=None,
        min_length=12,
        max_length=1024,
        description="The new password, required once this one has expired.",
    )


class Me(BaseModel):
    """User of the request, and the CSRF token that a browser sends with changes."""

    name: str
    role: Literal["viewer", "engineer", "admin"]
    csrf_token: str | None = None


class NewUser(BaseModel):
    """A user to add."""

    name: str = Field(pattern=names.USER)
    role: Literal["viewer", "engineer", "admin"]
    password: str | None = Field(
        default=None,
        min_length=12,
        max_length=1024,
        description="Without a password the user logs in by OIDC.",
    )
    assets: list[str] | None = Field(
        default=None, max_length=10_000, description="Visible assets, groups as @NAME; null for all."
    )
    expires_utc: AwareDatetime | None = Field(default=None, ge=FIRST, le=LAST)


class GroupIn(BaseModel):
    """The assets of a group."""

    assets: list[str] = Field(max_length=10_000)


class GroupOut(BaseModel):
    """A group of assets."""

    name: str
    assets: list[str]


class UserOut(BaseModel):
    """A user."""

    name: str
    role: Literal["viewer", "engineer", "admin"]
    created_utc: datetime
    disabled: bool
    assets: list[str] | None = None
    expires_utc: datetime | None = None


class NewPassword(BaseModel):
    """The user's present and new password."""

    old: str = Field(max_length=1024)
    new: str = Field(min_length=12, max_length=1024)


class AuditOut(BaseModel):
    """Action of a user, with time and result."""

    id: int
    time_utc: datetime
    who: str
    action: str
    subject: str
    outcome: str


class NewToken(BaseModel):
    """A token to create for a machine."""

    label: str = Field(default="", max_length=128)
    days: int = Field(default=365, ge=1, le=3650)


class Token(BaseModel):
    """A new token, which is shown only once."""

    token: str
    expires_utc: datetime
