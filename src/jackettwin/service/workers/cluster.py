"""Workers.

A Dask cluster of this machine or somebody's scheduler; slow and dying tasks are told apart from wrong input.
A task's time counts from when a worker begins with it: neither waiting for a worker nor its start count.
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

from jackettwin.errors import InputError
from jackettwin.service.settings import ServiceSettings
from jackettwin.service.workers.certificates import given_security, own_security
from jackettwin.service.workers.failures import NoWorker
from jackettwin.service.workers.memory import give_back

log = logging.getLogger(__name__)

_NICE = 5
"""Of workers of our own: readers are answered first, records are observed with what is left of the cores.

Stated absolutely, since Dask runs it twice."""
_START = (
    f"import os, {__package__}.engine, {__package__}.tasks\n"
    f"os.setpriority(os.PRIO_PROCESS, 0, {os.nice(0) + _NICE})"
)
"""What a worker of our own does before it takes a task: a record does not wait for libraries."""
_DASK = {
    "distributed.worker.memory.target": False,
    "distributed.worker.memory.spill": False,
    "distributed.worker.memory.pause": False,
    "distributed.worker.memory.terminate": 0.95,
    "distributed.scheduler.allowed-failures": 0,
    "distributed.scheduler.work-stealing": True,
    "distributed.admin.tick.limit": "60s",
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
"""A worker over its memory is ended, not paused.

A task that ended a worker comes back to us at once, and counts a try. A free worker takes what waits at a
busy one: an upload does not wait for a posterior. The timeout of a lost worker is when Dask ends whoever took
its place, if that one is just starting: after its own 15 s that happened. Dask's profiler and monitor
keep what every thread did for an hour, and its logs the last thousand messages of every connection with all
that was sent: off, and short. What it tells without being asked who asks is that it lives.
"""

ARRIVAL, STUDY = "arrival", "study"
"""Resources of Dask by which workers take records alone, or studies: no record waits behind one."""
_LOOK_S = 1.0
"""How often somebody who waits for a task looks whether the scheduler is still there."""
_RECONNECT = "3s"
"""Time for a scheduler that went away to answer; it is asked again at the next beat."""
_REMEMBERED = 10_000
"""Tasks of which it is known that they began: far more than there are at once."""


_SENT_S = 0.01
"""Time for a worker's message to leave even if the task ends it at once: Dask collects messages for 2 ms."""


def run(topic: str, task: Callable[..., Any], *args: Any) -> Any:
    """Run a task in a worker: say that it begins, and give back the memory that it left free."""
    worker = get_worker()
    worker.log_event(topic, worker.get_current_task())
    time.sleep(_SENT_S)
    try:
        return task(*args)
    finally:
        give_back()


class WorkerCluster:
    """Where records are read and observed: never in the server's own process."""

    def __init__(self, settings: ServiceSettings) -> None:
        dask.config.set(_DASK)
        self._lock = Lock()
        self._wanted = settings.workers
        self._topic, self._began = f"begun-{secrets.token_hex(8)}", dict[str, float]()
        self._cluster: LocalCluster | None = None
        self._security = own_security() if settings.scheduler is None else given_security(settings)
        if settings.scheduler is None:
            self._cluster = LocalCluster(
                n_workers=0,  # they come while the server answers already
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
                "no scheduler of Dask answers there",
                field="scheduler",
                value=settings.scheduler,
                allowed="tls://HOST:PORT",
                remedy="see that `dask scheduler` runs there, may be reached, and trusts our certificate",
            ) from None
        self._ever, self._ended = set[str](), 0

    def _connected(self, timeout: str) -> Client:
        """Return a connection to the scheduler, as it is now."""
        client = Client(self._where, security=self._security, set_as_default=False, timeout=timeout)
        client.subscribe_topic(self._topic, self._note)
        self._scheduler = client.scheduler_info(n_workers=0).get("id")
        return client

    @property
    def reachable(self) -> bool:
        """Whether the scheduler answers: nothing can be read or observed without it."""
        return bool(self.client.status == "running")

    @property
    def workers(self) -> int:
        """How many workers there are now that take records; those for studies apart."""
        return len(self._offering(ARRIVAL) or self._addresses()) if self.reachable else 0

    @property
    def restarts(self) -> int:
        """How many workers were replaced: our own, whatever they ended of; of others', those we ended."""
        return self._ended if self._cluster is None else max(len(self._ever) - self._wanted, 0)

    def _addresses(self) -> set[str]:
        """Where workers are; one that is started anew is elsewhere."""
        return set(self.client.scheduler_info(n_workers=-1).get("workers", {}))

    def _offering(self, resource: str) -> set[str]:
        found = self.client.scheduler_info(n_workers=-1).get("workers", {})
        return {address for address, worker in found.items() if worker.get("resources", {}).get(resource)}

    def mend(self) -> None:
        """Start workers of our own that are gone for good; find somebody's scheduler that came back.

        Dask starts a worker that died anew, but gives one up that dies, or takes long, while it starts. A
        client of a scheduler that went away gives up after a while, and one that finds another scheduler in
        its place knows nothing of its tasks: a new client is made.
        """
        if self._cluster is None:
            self._find_scheduler()
        else:
            self._ever |= self._addresses()
            self._cluster.loop.add_callback(self._replace_lost, self._cluster)

    def _find_scheduler(self) -> None:
        same = self.client.scheduler_info(n_workers=0).get("id") == self._scheduler
        if self.reachable and same:
            return
        gone, place = self.client, urlsplit(str(self._where))
        try:
            with socket.create_connection((place.hostname or "", place.port or 8786), timeout=1.0):
                pass  # a client that finds nobody leaves threads behind
            self.client = self._connected(_RECONNECT)
        except (OSError, ValueError) as error:
            log.warning("the scheduler does not answer: %s", str(error).partition("\n")[0])
            return
        log.warning("the scheduler answers again")
        with suppress(Exception):
            gone.close(timeout=1)

    def forsaken(self, future: Future) -> bool:
        """Tell whether a task is nobody's any more: its scheduler went away, and nothing will come of it."""
        gone = future.client is not self.client or future.status in ("lost", "cancelled")
        return gone or not self.reachable

    def _replace_lost(self, cluster: LocalCluster) -> None:
        for name, nanny in list(cluster.workers.items()):
            if nanny.status in (Status.closed, Status.failed):
                del cluster.workers[name]
        cluster.scale(self._wanted)

    def submit(self, task: Callable[..., Any], *args: Any, priority: int = 0, study: bool = False) -> Future:
        """Start a task; urgent ones overtake. Studies have a worker of their own, started for the first one.

        Its key begins with its name, by which Dask knows how long such tasks take and where to put the next.

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
        """Start the worker for studies, which from then on is mended as the others are."""
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
        """Tell whether a worker began with a task, and so long ago."""
        began = self._began.get(future.key)
        return began is not None and time.monotonic() - began >= ago_s

    def result(self, future: Future, limit_s: float) -> Any:
        """Return the result of a task that may take so long once it has begun, or end it.

        Raises
        ------
        NoWorker
            If no worker came to it within the same time, or the scheduler went away.
        TimeoutError
            If it takes longer.
        """
        asked = time.monotonic()
        while True:
            left = self._began.get(future.key, asked) + limit_s - time.monotonic()
            try:
                return future.result(timeout=max(min(left, _LOOK_S), 0.0))
            except Exception as error:
                if self.forsaken(future):
                    raise NoWorker from None
                if not isinstance(error, TimeoutError) or future.done():  # it is the task's own
                    raise
                left = self._began.get(future.key, asked) + limit_s - time.monotonic()
                if left > 0.0:
                    continue
                if future.key not in self._began:
                    future.cancel()
                    raise NoWorker from None
                self.end(future)
                raise

    def end(self, future: Future) -> None:
        """Give a task up that takes too long: its worker is started anew, with whatever it holds."""
        with self._lock, suppress(Exception):
            busy = [address for address, keys in self.client.processing().items() if future.key in keys]
            future.cancel()
            self._ended += len(busy)
            if self._cluster is None:
                self.client.restart_workers(busy, timeout=30, raise_for_error=False)
            else:  # a nanny starts a worker anew that died, sooner than one that it must end itself
                for nanny in self._cluster.workers.values():
                    if nanny.worker_address in busy:
                        os.kill(nanny.pid, signal.SIGKILL)

    def close(self) -> None:
        """Stop; what runs is dropped and will be leased again."""
        with suppress(Exception):
            self.client.close(timeout=5)
        if self._cluster is not None:
            with suppress(Exception):
                self._cluster.close(timeout=5)
