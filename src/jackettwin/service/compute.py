"""Workers.

A Dask cluster of this machine or somebody's scheduler; slow and dying tasks are told apart from wrong input.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from typing import Any

import dask
from distributed import Client, Future, LocalCluster
from distributed.core import Status

from jackettwin.service.settings import ServiceSettings

log = logging.getLogger(__name__)

_NICE = 5
"""Of workers of our own: readers are answered first, records are observed with what is left of the cores.

Stated absolutely, since Dask runs it twice."""
_DASK = {
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.terminate": 0.95,
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.work-stealing": False,
    "distributed.admin.tick.limit": "60s",
    "distributed.worker.daemon": True,
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.log-length": 100,
    "distributed.worker.preload": [f"import os; os.setpriority(os.PRIO_PROCESS, 0, {os.nice(0) + _NICE})"],
}
"""A worker over its memory is ended, not paused.

A task that ended a worker comes back to us at once, and counts a try. Dask's profiler and monitor keep
what every thread did for an hour, and let workers grow meanwhile: off, and short.
"""


class Compute:
    """Where records are read and observed: never in the server's own process."""

    def __init__(self, settings: ServiceSettings) -> None:
        dask.config.set(_DASK)
        self._lock = Lock()
        self._wanted = settings.workers
        self._cluster: LocalCluster | None = None
        if settings.scheduler is None:
            self._cluster = LocalCluster(
                n_workers=settings.workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=settings.worker_memory_bytes,
                dashboard_address="127.0.0.1:0",
                host="127.0.0.1",
                silence_logs=logging.ERROR,
            )
        self.client = Client(self._cluster or settings.scheduler, set_as_default=False, timeout="30s")
        self.restarts = 0

    @property
    def workers(self) -> int:
        """How many workers there are now."""
        return len(self.client.scheduler_info(n_workers=-1).get("workers", {}))

    def mend(self) -> None:
        """Start workers of our own that are gone for good.

        Dask starts a worker that died anew, but gives one up that dies, or takes long, while it starts.
        """
        if self._cluster is not None:
            self._cluster.loop.add_callback(self._replace_lost, self._cluster)

    def _replace_lost(self, cluster: LocalCluster) -> None:
        for name, nanny in list(cluster.workers.items()):
            if nanny.status in (Status.closed, Status.failed):
                del cluster.workers[name]
        cluster.scale(self._wanted)

    def submit(self, task: Callable[..., Any], *args: Any, priority: int = 0) -> Future:
        """Start a task; urgent ones overtake."""
        return self.client.submit(task, *args, pure=False, priority=priority, retries=0)

    def end(self, future: Future) -> None:
        """Give a task up that takes too long: its worker is started anew, with whatever it holds."""
        with self._lock, suppress(Exception):
            busy = [address for address, keys in self.client.processing().items() if future.key in keys]
            future.cancel()
            if busy:
                self.restarts += 1
                self.client.restart_workers(busy, timeout=30, raise_for_error=False)

    def close(self) -> None:
        """Stop; what runs is dropped and will be leased again."""
        with suppress(Exception):
            self.client.close(timeout=5)
        if self._cluster is not None:
            with suppress(Exception):
                self._cluster.close(timeout=5)
