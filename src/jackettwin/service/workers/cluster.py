"""Cluster of workers.

It is a local Dask cluster or an external scheduler; slow and dying tasks are distinguished from wrong input.
The time of a task is measured from its begin at a worker, without waiting for a worker or its start.
"""

from __future__ import annotations

import logging
import os
import secrets
import signal
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

import dask
from distributed import Client, Future, LocalCluster, get_worker
from distributed.core import Status
from distributed.utils import sync

from jackettwin.errors import InputError
from jackettwin.processes import give_back
from jackettwin.service.settings import ServiceSettings
from jackettwin.service.workers.certificates import given_security, own_security
from jackettwin.service.workers.failures import NoWorker

log = logging.getLogger(__name__)

_NICE = 5
"""Nice value of local workers, so that requests have priority over observations.

It is set absolutely, since Dask runs the code twice."""
_START = (
    f"import os, {__package__}.engine, {__package__}.tasks\n"
    f"os.setpriority(os.PRIO_PROCESS, 0, {os.nice(0) + _NICE})"
)
"""Code that a local worker runs at its start, so that no record waits for imports."""
_DASK = {
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.terminate": 0.95,
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.work-stealing": True,
    "distributed.admin.tick.limit": "60s",
    "distributed.admin.tick.interval": "2s",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.worker.memory.monitor-interval": "500ms",
    "distributed.worker.daemon": True,
    "distributed.deploy.lost-worker-timeout": "1h",
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.log-length": 100,
    "distributed.admin.low-level-log-length": 10,
    "distributed.worker.preload": [_START],
    "distributed.scheduler.http.routes": ["distributed.http.health"],
    "distributed.worker.http.routes": ["distributed.http.health"],
    "distributed.nanny.pre-spawn-environ.MALLOC_ARENA_MAX": 1,
}
"""Settings of Dask.

A worker above its memory limit is ended, not paused. A task that ended a worker returns at once and counts as
a try. Idle workers take tasks queued at busy ones, so that an upload does not wait for a posterior. After the
timeout of a lost worker Dask ends its successor, even one that is just starting, which happened with the
default of 15 s. Dask's profiler and monitor store an hour of activity, and its logs the last thousand
messages of every connection with their contents; these are switched off or shortened. Without authentication
it only reports its health.
"""

ARRIVAL, STUDY = "arrival", "study"
"""Dask resources that separate workers for records from those for studies, as no record may wait for one."""
_LOOK_S = 1.0
"""Interval at which a waiting caller checks whether the scheduler is still available."""
_RECONNECT = "3s"
"""Timeout of reconnecting to a lost scheduler, which is repeated at the next heartbeat."""
_REMEMBERED = 10_000
"""Number of stored begin times of tasks, far more than there are tasks at once."""


_HEARD_S = 5.0
"""Longest wait until the scheduler has heard of a task's begin; a task is not refused for want of that."""


def run(topic: str, task: Callable[..., Any], *args: Any) -> Any:
    """Run a task in a worker: report its begin, and release free memory afterwards.

    The scheduler acknowledges the report, so that it is not lost if the task ends the worker at once.
    """
    worker = get_worker()
    with suppress(Exception):
        heard = worker.scheduler.log_event
        sync(worker.loop, heard, topic=topic, msg=worker.get_current_task(), callback_timeout=_HEARD_S)
    try:
        return task(*args)
    finally:
        give_back()


class WorkerCluster:
    """Processes in which records are read and observed, separate from the server's process."""

    def __init__(self, settings: ServiceSettings) -> None:
        dask.config.set(_DASK)
        self._lock = Lock()
        self._wanted = settings.workers
        self._topic, self._began = f"begun-{secrets.token_hex(8)}", dict[str, float]()
        self._cluster: LocalCluster | None = None
        self._security = own_security() if settings.scheduler is None else given_security(settings)
        if settings.scheduler is None:
            self._cluster = LocalCluster(
                n_workers=0,  # they start while the server already answers
                threads_per_worker=1,
                processes=True,
                memory_limit=settings.worker_memory_bytes,
                dashboard_address="127.0.0.1:0",
                worker_dashboard_address="127.0.0.1:0",
                host="127.0.0.1",
                protocol="tls://",
                security=self._security,
                resources={ARRIVAL: 1},
                silence_logs=logging.ERROR,
            )
            self._cluster.scale(settings.workers)
        self._where = self._cluster or settings.scheduler
        try:
            self.client = self._connected("30s")
        except (OSError, ValueError):  # an SSLError is an OSError
            raise InputError(
                "no Dask scheduler answers at this address",
                field="scheduler",
                value=settings.scheduler,
                allowed="tls://HOST:PORT",
                remedy="check that `dask scheduler` runs there, can be reached, and trusts this server's "
                "certificate",
            ) from None
        self._ever, self._ended = set[str](), 0

    def _connected(self, timeout: str) -> Client:
        """Return a new connection to the scheduler."""
        client = Client(self._where, security=self._security, set_as_default=False, timeout=timeout)
        client.subscribe_topic(self._topic, self._note)
        self._scheduler = client.scheduler_info(n_workers=0).get("id")
        return client

    @property
    def reachable(self) -> bool:
        """Whether the scheduler answers, without which nothing can be read or observed."""
        return bool(self.client.status == "running")

    @property
    def workers(self) -> int:
        """Number of workers for records, without those for studies."""
        return len(self._offering(ARRIVAL) or self._addresses()) if self.reachable else 0

    @property
    def restarts(self) -> int:
        """Number of replaced workers: all local ones that ended, or external ones that this server ended."""
        return self._ended if self._cluster is None else max(len(self._ever) - self._wanted, 0)

    def _addresses(self) -> set[str]:
        """Addresses of the workers; a restarted one has a new address."""
        return set(self.client.scheduler_info(n_workers=-1).get("workers", {}))

    def _offering(self, resource: str) -> set[str]:
        found = self.client.scheduler_info(n_workers=-1).get("workers", {})
        return {address for address, worker in found.items() if worker.get("resources", {}).get(resource)}

    def mend(self) -> None:
        """Replace lost local workers, or reconnect to an external scheduler.

        Dask restarts a dead worker, but not one that dies or takes long during its start. A client of a lost
        scheduler gives up after a while, and is not valid for a new scheduler at the same address, so a new
        client is made.
        """
        if self._cluster is None:
            self._find_scheduler()
        else:
            self._ever |= self._addresses()
            self._cluster.loop.add_callback(self._replace_lost, self._cluster)

    def _find_scheduler(self) -> None:
        # a lost scheduler would be asked for half a minute
        if self.reachable and self.client.scheduler_info(n_workers=0).get("id") == self._scheduler:
            return
        gone, place = self.client, urlsplit(str(self._where))
        try:
            with socket.create_connection((place.hostname or "", place.port or 8786), timeout=1.0):
                pass  # a client without scheduler leaves threads behind
            self.client = self._connected(_RECONNECT)
        except (OSError, ValueError) as error:
            log.warning("the scheduler does not answer: %s", str(error).partition("\n")[0])
            return
        log.warning("the scheduler answers again")
        with suppress(Exception):
            gone.close(timeout=1)

    def forsaken(self, future: Future) -> bool:
        """Return whether a task is lost because its scheduler was lost."""
        gone = future.client is not self.client or future.status in ("lost", "cancelled")
        return gone or not self.reachable

    def _replace_lost(self, cluster: LocalCluster) -> None:
        for name, nanny in list(cluster.workers.items()):
            if nanny.status in (Status.closed, Status.failed):
                del cluster.workers[name]
        cluster.scale(self._wanted)

    def submit(self, task: Callable[..., Any], *args: Any, priority: int = 0, study: bool = False) -> Future:
        """Submit a task with a priority. Studies run on a separate worker, which the first study starts.

        The key begins with the task's name, from which Dask estimates its duration for scheduling.

        Raises
        ------
        NoWorker
            If the scheduler does not answer.
        """
        if not self.reachable:
            raise NoWorker
        name = getattr(task, "func", task).__name__
        how = {"key": f"{name}-{secrets.token_hex(16)}", "priority": priority, "retries": 0}
        if study and self._cluster is not None:
            self._start_studying(self._cluster)
        kind = STUDY if study else ARRIVAL
        if self._cluster is not None or self._offering(kind):
            how["resources"] = {kind: 1}
        return self.client.submit(run, self._topic, task, *args, **how)

    def _start_studying(self, cluster: LocalCluster) -> None:
        """Start the worker for studies, which is then replaced like the others if lost."""
        if STUDY in cluster.worker_spec:
            return
        usual = cluster.new_spec
        later = {**usual["options"], "resources": {STUDY: 1}}
        self._wanted += 1
        cluster.worker_spec[STUDY] = {"cls": usual["cls"], "options": later}
        cluster.scale(self._wanted)

    def _note(self, event: tuple[float, str]) -> None:
        self._began[event[1]] = time.monotonic()
        while len(self._began) > _REMEMBERED:
            del self._began[next(iter(self._began))]

    def has_begun(self, future: Future, ago_s: float = 0.0) -> bool:
        """Return whether a worker began a task at least ``ago_s`` ago."""
        began = self._began.get(future.key)
        return began is not None and time.monotonic() - began >= ago_s

    def result(self, future: Future, limit_s: float) -> Any:
        """Return the result of a task, which is ended if it takes longer than the limit from its begin.

        Raises
        ------
        NoWorker
            If no worker began it within the same time, or the scheduler was lost.
        TimeoutError
            If it takes longer than the limit.
        """
        asked = time.monotonic()
        while True:
            left = self._began.get(future.key, asked) + limit_s - time.monotonic()
            try:
                return future.result(timeout=_LOOK_S if future.done() else max(min(left, _LOOK_S), 0.0))
            except Exception as error:
                if self.forsaken(future):
                    raise NoWorker from None
                if not isinstance(error, TimeoutError) or future.status == "error":  # it is the task's own
                    raise
                if future.done():  # its result is on its way
                    continue
                left = self._began.get(future.key, asked) + limit_s - time.monotonic()
                if left > 0.0:
                    continue
                if future.key not in self._began:
                    future.cancel()
                    raise NoWorker from None
                self.end(future)
                raise

    def end(self, future: Future) -> None:
        """End a task that takes too long by restarting its worker."""
        with self._lock, suppress(Exception):
            busy = [address for address, keys in self.client.processing().items() if future.key in keys]
            future.cancel()
            self._ended += len(busy)
            if self._cluster is None:
                self.client.restart_workers(busy, timeout=30, raise_for_error=False)
            else:  # a nanny restarts a dead worker faster than one that it must end itself
                for nanny in self._cluster.workers.values():
                    if nanny.worker_address in busy:
                        os.kill(nanny.pid, signal.SIGKILL)

    def close(self) -> None:
        """Stop; running tasks are dropped and will be leased again."""
        with suppress(Exception):
            self.client.close(timeout=5)
        if self._cluster is not None:
            with suppress(Exception):
                self._cluster.close(timeout=5)
