"""Distribution of events to many clients with one query of the database."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import AsyncIterator

from sqlalchemy import Engine
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.store import journal, reading
from jackettwin.store.journal import Event

_TURN_S = 0.3
_RECENT = 2000
"""Number of events in memory; for older ones the database is read."""


class Feed:
    """The newest events, polled from the database, and the clients waiting for them."""

    def __init__(self, database: Engine) -> None:
        self._database = database
        self._recent: deque[Event] = deque(maxlen=_RECENT)
        self._news = asyncio.Condition()
        self._last = 0

    async def run(self) -> None:
        """Poll for events until cancelled."""
        self._last = await asyncio.to_thread(self._newest)
        while True:
            try:
                new = await asyncio.to_thread(self._after, self._last)
            except SQLAlchemyError:
                await asyncio.sleep(2.0)
                continue
            if new:
                async with self._news:
                    self._recent.extend(new)
                    self._last = new[-1].id
                    self._news.notify_all()
            await asyncio.sleep(_TURN_S)

    @property
    def last(self) -> int:
        """The number of the newest event."""
        return self._last

    async def follow(self, last: int, seconds: float) -> AsyncIterator[Event]:
        """Yield the events after number ``last`` for a number of seconds."""
        at, end = last, time.monotonic() + seconds
        while True:
            if at < self._last:
                oldest = self._recent[0].id if self._recent else self._last + 1
                ahead = (
                    [e for e in self._recent if e.id > at]
                    if oldest <= at + 1
                    else await asyncio.to_thread(self._after, at)
                )
                for event in ahead:
                    yield event
                if time.monotonic() > end:
                    return
                at = ahead[-1].id if ahead else self._last
            else:
                async with self._news:
                    while self._last <= at:
                        try:
                            await asyncio.wait_for(self._news.wait(), end - time.monotonic())
                        except TimeoutError:
                            return

    def _newest(self) -> int:
        with reading(self._database) as connection:
            return journal.last_event(connection)

    def _after(self, last: int) -> list[Event]:
        with reading(self._database) as connection:
            return journal.events_after(connection, last)
