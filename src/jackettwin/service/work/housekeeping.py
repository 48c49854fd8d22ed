"""What is done now and then: old samples pruned by policy, old events, uploads and memory let go."""

from __future__ import annotations

import shutil
import time
from datetime import timedelta
from typing import TYPE_CHECKING

from jackettwin.service.workers.memory import give_back
from jackettwin.store import journal, records, settings, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

_EVERY_S = 600.0
_STALE_S = 3600.0
"""Age of an upload that was left behind by a server that died over it."""


class Housekeeping:
    """Keeps the store within its policy."""

    def __init__(self, service: Service) -> None:
        self._service = service
        if (days := service.settings.raw_days) is not None:
            with writing(service.database) as connection:
                settings.put(connection, settings.RAW_DAYS, days or None)
        self._next = 0.0

    def turn(self) -> None:
        """Tidy up if it is time to."""
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _EVERY_S
        prune(self._service)
        give_back()
        for folder in self._service.settings.spool.iterdir():
            if folder.is_dir() and time.time() - folder.stat().st_mtime > _STALE_S:
                shutil.rmtree(folder, ignore_errors=True)


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
