"""Schemas of findings, and of what people do with them."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import AwareDatetime, BaseModel, Field

from jackettwin.service.web import names
from jackettwin.service.web.schemas.common import FIRST, LAST


class FindingOut(BaseModel):
    """Something worth saying, and how it stands; its sentence is made of code and params."""

    id: int
    asset: str
    record_id: str
    time_utc: datetime
    day: str = Field(description="UTC day; with asset, code and subject what the finding is known by.")
    code: str
    severity: Literal["info", "warning", "alarm"]
    subject: str | None
    params: dict[str, Any]
    text: str
    acknowledged_by: str | None = None
    acknowledged_utc: datetime | None = None
    assigned_to: str | None = None
    muted_until_utc: datetime | None = Field(
        default=None, description="What is muted is told to nobody; it is null again once the time is over."
    )
    closed_by: str | None = None
    closed_utc: datetime | None = None
    close_reason: str | None = None


class AlarmOut(FindingOut):
    """A finding that asks for a person, and what was said of it when it was acknowledged."""

    comment: str | None = None


class ActOut(BaseModel):
    """An action on a finding; ``unmute`` is the end of a mute, by a person or at its time."""

    action: Literal["acknowledge", "assign", "comment", "mute", "unmute", "close", "reopen"]
    by: str
    time_utc: datetime
    comment: str
    to: str | None = None
    until_utc: datetime | None = None


class HandledOut(FindingOut):
    """A finding with all that people did with it, oldest first."""

    history: list[ActOut]


Comment = Annotated[str, Field(max_length=2000)]


class Acknowledgement(BaseModel):
    """A comment on an alarm, a finding, or a record that is set aside."""

    comment: Comment = Field(min_length=1)


class AssignIn(BaseModel):
    """Whose a finding is to look after; null for nobody's."""

    to: str | None = Field(pattern=names.USER)
    comment: Comment = ""


class MuteIn(BaseModel):
    """Until when nobody is told of a finding: also of later days, of the same code and subject."""

    until_utc: AwareDatetime = Field(ge=FIRST, le=LAST)
    comment: Comment = ""


class CloseIn(BaseModel):
    """Why a finding needs nobody any more."""

    reason: Comment = Field(min_length=1)


class ReopenIn(BaseModel):
    """Why a finding needs somebody after all."""

    comment: Comment = ""
