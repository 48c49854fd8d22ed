"""What is done now and then: mutes ended, old samples, events and uploads deleted, memory given back."""

from __future__ import annotations

import shutil
import time
from datetime import timedelta
from typing import TYPE_CHECKING

from jackettwin.service.workers.memory import give_back
from jackettwin.store import handling, journal, reading, records, settings, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

_EVERY_S = 600.0
_MUTES_S = 5.0
"""How late a mute ends at most."""
_STALE_S = 3600.0
"""Age of an upload that was left behind by a server that died over it."""


class Housekeeping:
    """Keeps the store within its policy."""

    def __init__(self, service: Service) -> None:
        self._service = service
        if (days := service.settings.raw_days) is not None:
            with writing(service.database) as connection:
                settings.put(connection, settings.RAW_DAYS, days or None)
        self._next = self._next_mutes = 0.0

    def turn(self) -> None:
        """Tidy up if it is time to."""
        if time.monotonic() >= self._next_mutes:
            self._next_mutes = time.monotonic() + _MUTES_S
            end_mutes(self._service)
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _EVERY_S
        prune(self._service)
        give_back()
        for folder in self._service.settings.spool.iterdir():
            if folder.is_dir() and time.time() - folder.stat().st_mtime > _STALE_S:
                shutil.rmtree(folder, ignore_errors=True)


def end_mutes(service: Service) -> None:
    """End the mutes whose time is over: from then on people are told again of what still holds."""
    now = service.now()
    with reading(service.database) as connection:
        if not handling.mutes_over(connection, now):
            return
    with writing(service.database) as connection:
        for mute in handling.mutes_over(connection, now):  # by another server, meanwhile
            handling.end_mute(connection, mute, now)
            journal.tell(connection, "finding", mute.asset, {"action": "unmute", "by": handling.SYSTEM}, now)


def prune(service: Service) -> int:
    """Delete the samples of observed records older than the policy says; return how many."""
    now = service.now()
    with writing(service.database) as connection:
        journal.forget_events(connection, now)
        days = settings.get(connection, settings.RAW_DAYS)
        if days is None:
            return 0
        old = records.with_samples_before(connection, now - timedelta(days=float(days)))
        for record in old:
            records.forget_samples(connection, record)
        for asset in {record.asset for record in old}:
            journal.tell(connection, "record", asset, {"samples_forgotten": True}, now)
    for record in old:
        (service.settings.store / str(record.waveform)).unlink(missing_ok=True)
    return len(old)
