"""Periodic tasks: end mutes, delete old samples, events and uploads, release memory."""

from __future__ import annotations

import shutil
import time
from datetime import timedelta
from typing import TYPE_CHECKING

from jackettwin.processes import give_back
from jackettwin.store import handling, journal, people, reading, records, results, settings, work, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

POLICIES = (settings.RAW_DAYS, settings.OBSERVATION_DAYS, settings.JOB_DAYS, settings.AUDIT_DAYS)
_EVERY_S = 600.0
_MUTES_S = 5.0
"""Largest delay of the end of a mute."""
_STALE_S = 3600.0
"""Age after which an upload is a remainder of a crashed server."""


class Housekeeping:
    """Applies the store's policy on old data."""

    def __init__(self, service: Service) -> None:
        self._service = service
        given = {name: getattr(service.settings, name) for name in POLICIES}
        if any(days is not None for days in given.values()):
            with writing(service.database) as connection:
                for name, days in given.items():
                    if days is not None:
                        settings.put(connection, name, days or None)
        self._next = self._next_mutes = 0.0

    def turn(self) -> None:
        """Run the housekeeping if it is due."""
        if time.monotonic() >= self._next_mutes:
            self._next_mutes = time.monotonic() + _MUTES_S
            end_mutes(self._service)
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _EVERY_S
        prune(self._service)
        forget(self._service)
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


def forget(service: Service) -> None:
    """Forget what each record said, work that ended, and lines of the audit log, by the policy."""
    now = service.now()
    with writing(service.database) as connection:
        days = {name: settings.get(connection, name) for name in POLICIES}
        before = {name: now - timedelta(days=float(n)) for name, n in days.items() if n is not None}
        if settings.OBSERVATION_DAYS in before:  # of whole days: one is summed anew, or it is not
            midnight = before[settings.OBSERVATION_DAYS].replace(hour=0, minute=0, second=0, microsecond=0)
            for asset in results.forget_observations(connection, midnight):
                journal.tell(connection, "asset", asset, {"observations_forgotten": True}, now)
        if settings.JOB_DAYS in before:
            work.forget_jobs(connection, before[settings.JOB_DAYS])
        if settings.AUDIT_DAYS in before and people.forget_audit(connection, before[settings.AUDIT_DAYS]):
            kept = f"{days[settings.AUDIT_DAYS]:g} days are kept"
            people.note_down(connection, handling.SYSTEM, "audit", kept, "older lines deleted", now)


def prune(service: Service) -> int:
    """Delete samples of observed records that are older than the policy's limit; return their number."""
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
