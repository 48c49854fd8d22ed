"""Components of a running server."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from sqlalchemy import Engine

from jackettwin.service import workers
from jackettwin.service.answer_cache import AnswerCache
from jackettwin.service.day_cache import DayCache
from jackettwin.service.event_feed import Feed
from jackettwin.service.fleet_cache import FleetCache
from jackettwin.service.latency import Latency
from jackettwin.service.login_attempts import LoginAttempts
from jackettwin.service.settings import ServiceSettings
from jackettwin.store import open_database, private_folder


def _now() -> datetime:
    return datetime.now(UTC)


@dataclass(frozen=True)
class OpenStore:
    """A store without workers, as the command line uses it, with or without a running server."""

    settings: ServiceSettings
    database: Engine
    now: Callable[[], datetime] = _now


@dataclass
class Service:
    """All components of a running server."""

    settings: ServiceSettings
    database: Engine
    cluster: workers.WorkerCluster
    server_id: str
    now: Callable[[], datetime] = _now
    login_attempts: LoginAttempts = field(default_factory=LoginAttempts)
    days: DayCache = field(default_factory=DayCache)
    answers: AnswerCache = field(default_factory=AnswerCache)
    fleet: FleetCache[Any] = field(default_factory=FleetCache)
    latency: Latency = field(default_factory=Latency)
    periodic: list[Callable[[], None]] = field(default_factory=list)
    wake: Callable[[], None] = lambda: None
    turning: Callable[[], bool] = lambda: True
    has_intake: bool = False
    """Whether this server, of several on a store, handles the inbox and the broker."""
    on_lost: list[Callable[[], None]] = field(default_factory=list)
    """Functions called when the database is lost, after which another server may take over."""
    laying_out: bool = False
    """Whether the demonstration is being laid out, before which there is no turbine."""
    broker_connected: Callable[[], bool | None] = lambda: None
    packets_refused: Callable[[], int] = lambda: 0

    @cached_property
    def feed(self) -> Feed:
        """The feed of events for clients of this server."""
        return Feed(self.database)

    def free_bytes(self) -> int:
        """Free disk space of the store [bytes]; 0 on a read-only disk, as disks become after faults."""
        store = self.settings.store
        return shutil.disk_usage(store).free if os.access(store, os.W_OK) else 0


Place = OpenStore | Service
"""Context for storing results: location of the store, its database, and the time."""


def _keep_caches(folder: Path) -> None:
    """Have workers keep what they compile, and what they know of fonts, in the store if nowhere else."""
    if not os.access(Path(__file__).parent, os.W_OK):
        os.environ.setdefault("NUMBA_CACHE_DIR", str(folder))
    if not os.access(os.path.expanduser("~"), os.W_OK):
        fonts = folder / "matplotlib"
        fonts.mkdir(parents=True, exist_ok=True)
        os.environ.setdefault("MPLCONFIGDIR", str(fonts))


def open_service(settings: ServiceSettings) -> Service:
    """Open the database and start the workers.

    Raises
    ------
    InputError
        If the database cannot be opened.
    """
    private_folder(settings.store)
    _keep_caches(settings.store / "cache")
    for folder in (settings.spool, settings.models):
        folder.mkdir(parents=True, exist_ok=True)
    database = open_database(settings.database_url)
    made = Service(
        settings, database, workers.WorkerCluster(settings), f"{os.getpid()}-{secrets.token_hex(4)}"
    )
    made.latency.watch(database, settings.slow_query_s)
    return made
