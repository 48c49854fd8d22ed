"""The parts of a server, which are passed to its functions."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from typing import TYPE_CHECKING

from sqlalchemy import Engine

from jackettwin.service.answer_cache import AnswerCache
from jackettwin.service.day_cache import DayCache
from jackettwin.service.event_feed import Feed
from jackettwin.service.login_attempts import LoginAttempts
from jackettwin.service.settings import ServiceSettings
from jackettwin.store import open_database

if TYPE_CHECKING:
    from jackettwin.service.workers.cluster import WorkerCluster


def _now() -> datetime:
    return datetime.now(UTC)


@dataclass(frozen=True)
class OpenStore:
    """A store without workers: what the command line has, beside a server or without one."""

    settings: ServiceSettings
    database: Engine
    now: Callable[[], datetime] = _now


@dataclass
class Service:
    """Everything a running server consists of."""

    settings: ServiceSettings
    database: Engine
    cluster: WorkerCluster
    server_id: str
    now: Callable[[], datetime] = _now
    login_attempts: LoginAttempts = field(default_factory=LoginAttempts)
    days: DayCache = field(default_factory=DayCache)
    answers: AnswerCache = field(default_factory=AnswerCache)
    periodic: list[Callable[[], None]] = field(default_factory=list)
    wake: Callable[[], None] = lambda: None
    turning: Callable[[], bool] = lambda: True
    broker_connected: Callable[[], bool | None] = lambda: None
    packets_refused: Callable[[], int] = lambda: 0

    @cached_property
    def feed(self) -> Feed:
        """The events, for readers of this server."""
        return Feed(self.database)

    def free_bytes(self) -> int:
        """Free space on the disk of the store; 0 if it is read-only, as disks become after faults."""
        store = self.settings.store
        return shutil.disk_usage(store).free if os.access(store, os.W_OK) else 0


Place = OpenStore | Service
"""What storing results needs: the settings of the store, its database, and the time."""


def open_service(settings: ServiceSettings) -> Service:
    """Open the database and start the workers.

    Raises
    ------
    InputError
        If the database cannot be opened.
    """
    from jackettwin.service.workers.cluster import WorkerCluster

    for folder in (settings.store, settings.spool, settings.models):
        folder.mkdir(parents=True, exist_ok=True)
    database = open_database(settings.database_url)
    return Service(settings, database, WorkerCluster(settings), f"{os.getpid()}-{secrets.token_hex(4)}")
