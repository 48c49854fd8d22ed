"""Schemas and limits that many routes have in common."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Generic, TypeVar

from pydantic import BaseModel

T = TypeVar("T")

FIRST, LAST = datetime(1900, 1, 1, tzinfo=UTC), datetime(9000, 1, 1, tzinfo=UTC)
"""Range of times that a database can store and a time zone can shift."""


class Page(BaseModel, Generic[T]):
    """Part of a list, and the cursor of the next part."""

    items: list[T]
    next_cursor: str | None = None
