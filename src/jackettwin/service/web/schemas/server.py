"""Schemas of jobs and of the server itself."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, Field


class JobOut(BaseModel):
    """A job."""

    id: int
    kind: str
    asset: str
    record_id: str
    version: int
    state: Literal["queued", "leased", "done", "failed", "set_aside", "cancelled"]
    tries: int
    created_utc: datetime
    started_utc: datetime | None
    ended_utc: datetime | None
    reason: dict[str, Any] | None


class Health(BaseModel):
    """Whether the server runs, and its faults."""

    status: Literal["ok", "degraded"]
    version: str
    problems: list[str] = []
    openid: bool = Field(default=False, description="Whether people may log in at a provider.")


class Ready(BaseModel):
    """Whether records can now be stored and observed."""

    ready: bool
    database: bool
    scheduler: bool
    workers: int
    broker: bool | None
    free_bytes: int
    queue_age_s: float | None = None
