"""Dispatcher of a server.

It leases jobs, submits them to workers, stores results, and takes over jobs of dead servers.
"""

from __future__ import annotations

import logging
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection
from sqlalchemy.exc import DataError, IntegrityError, SQLAlchemyError, StatementError

from jackettwin.service.systemd import tell_systemd
from jackettwin.service.work import consequences
from jackettwin.service.workers.failures import LOST_WORKER, NoWorker
from jackettwin.service.workers.question import Question
from jackettwin.service.workers.tasks import Outcome, Task, know, observe_stored
from jackettwin.store import reading, work, writing
from jackettwin.version import __version__

if TYPE_CHECKING:
    from distributed import Future

    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

_BEAT_S = 2.0
DEAD_AFTER_S = 15.0
"""Time without heartbeat, by another server's monotonic clock, after which a server is dead."""
HANGS_AFTER_S = 60.0
"""Time without a cycle after which the dispatcher hangs; systemd's watchdog then restarts the server."""
_TURN_S = 0.25
_RESTS = 3.0
"""Ratio of idle to busy time of estimations, which so use at most a quarter of one worker."""
_AHEAD = 2
"""Number of queued tasks for each worker, so that none waits for the next lease."""


@dataclass
class _Running:
    job: work.Job
    future: Future
    since: float


class Dispatcher(Thread):
    """Thread that runs the dispatcher until it is stopped.

    Jobs that are unfinished then are leased again by the next dispatcher.
    """

    def __init__(self, service: Service) -> None:
        super().__init__(name="dispatcher", daemon=True)
        self.service = service
        self.wake = Event()
        self._stop_asked = Event()
        self._running: dict[int, _Running] = {}
        self._seen: dict[str, tuple[int, float]] = {}
        self._last_beat = -_BEAT_S
        self._turned = time.monotonic()
        self._served: Counter[str] = Counter()
        self._rest_until = 0.0

    def run(self) -> None:
        """Run cycles until stopped, waiting while the database is not available."""
        waited = 0.0
        while not self._stop_asked.is_set():
            self._turned = time.monotonic()
            try:
                self._turn()
                waited = 0.0
            except (SQLAlchemyError, OSError) as error:
                waited = min(waited + 1.0, 10.0)
                self.service.has_intake = False  # another server may have taken over the intake
                for leave in self.service.on_lost:
                    leave()
                log.warning("dispatcher waits %g s: %s", waited, str(error).splitlines()[0])
                self._stop_asked.wait(waited)
            except Exception:
                log.exception("dispatcher continues after an internal error")
                self._stop_asked.wait(1.0)
            self.wake.wait(_TURN_S)
            self.wake.clear()

    @property
    def turning(self) -> bool:
        """Whether the dispatcher runs its cycles."""
        return self.is_alive() and time.monotonic() - self._turned < HANGS_AFTER_S

    def stop(self) -> None:
        """Stop, and remove this server from the list so that others take over at once."""
        self._stop_asked.set()
        self.wake.set()
        if self.is_alive():
            self.join(timeout=10.0)
        try:
            with writing(self.service.database) as connection:
                work.remove_server(connection, self.service.server_id)
        except SQLAlchemyError:
            log.warning("could not leave the list of servers; others will notice the missing heartbeat")

    def _turn(self) -> None:
        self._beat()
        self._collect()
        self._end_overrun()
        self._lease()
        for chore in self.service.periodic:
            chore()

    def _beat(self) -> None:
        """Send a heartbeat, remove dead servers, and register again if this one was removed."""
        if time.monotonic() - self._last_beat < _BEAT_S:
            return
        self._last_beat = time.monotonic()
        self.service.cluster.mend()
        me, now = self.service.server_id, self.service.now()
        with writing(self.service.database) as connection:
            if not work.beat(connection, me):
                about = {"version": __version__, "pid": os.getpid(), "machine": _MACHINE}
                work.join(connection, me, about, now)
            beats = work.beats(connection)
            for server in [name for name in beats if name != me and self._dead(name, *beats[name])]:
                freed = work.remove_server(connection, server, beats[server][0])
                log.warning("server %s is dead, %d pieces of work go back to the queue", server, len(freed))
            work.take_back_orphans(connection, me, self._running)
            self.service.has_intake = work.hold_duty(connection, "intake", me)
        tell_systemd("WATCHDOG=1")

    def _dead(self, server: str, count: int, about: Mapping[str, Any]) -> bool:
        """Return whether a server's process on this machine has ended, or its heartbeat has stopped."""
        if _MACHINE and about.get("machine") == _MACHINE and not _runs(about["pid"]):
            return True
        known, since = self._seen.get(server, (None, 0.0))
        if known != count:
            self._seen[server] = (count, time.monotonic())
            return False
        return time.monotonic() - since > DEAD_AFTER_S

    def _lease(self) -> None:
        if not self.service.cluster.reachable:
            return
        observing = sum(running.job.kind == work.OBSERVE for running in self._running.values())
        free = _AHEAD * max(self.service.cluster.workers, 1) - observing
        kind = self._next_kind()
        if kind is None or (kind == work.OBSERVE and free <= 0):
            return
        me, now = self.service.server_id, self.service.now()
        with writing(self.service.database) as connection:
            most = free if kind == work.OBSERVE else 1
            jobs = work.lease(connection, me, most, now, kind=kind, served=self._served)
            self._served.update(job.asset for job in jobs)
            for job in jobs if kind == work.OBSERVE else ():
                consequences.observing(connection, self.service, job)
        for job in jobs:
            with self._its_own_fault(job):
                self._start(job)
            self._turned = time.monotonic()

    @contextmanager
    def _its_own_fault(self, job: work.Job) -> Iterator[None]:
        """Count any error but the loss of the database or disk as a try of a job, so that others go on."""
        try:
            yield
        except Exception as error:
            lost = isinstance(error, SQLAlchemyError | OSError)
            refused = isinstance(error, DataError | IntegrityError) or type(error) is StatementError
            if lost and not refused:
                raise
            log.exception("job %d cannot be done", job.id)
            reason = f"the server could not prepare it or store its result ({type(error).__name__})"
            with writing(self.service.database) as connection:
                consequences.failed(connection, self.service, job, reason)

    def _start(self, job: work.Job, *, every_day: bool = False) -> None:
        """Submit a job to a worker, unless its inputs no longer exist."""
        try:
            with reading(
                self.service.database
            ) as connection:  # a read connection, since reading years of days would block writers
                function, argument = self._task(connection, job, every_day)
        except LookupError as gone:
            with writing(self.service.database) as connection:
                consequences.keep(connection, self.service, job, Outcome(None, problem={"detail": str(gone)}))
            return
        study = job.kind == work.KNOW
        try:
            future = self.service.cluster.submit(function, argument, priority=job.priority, study=study)
        except NoWorker:  # the scheduler was lost meanwhile
            with writing(self.service.database) as connection:
                work.release(connection, job, self.service.server_id)
            return
        future.add_done_callback(lambda _: self.wake.set())
        self._running[job.id] = _Running(job, future, time.monotonic())

    def _next_kind(self) -> str | None:
        """Return the kind of job to lease: records first, those of archived assets last.

        Estimations are leased one at a time and only after their idle time, but for the first of a model.
        """
        with reading(self.service.database) as connection:
            if work.any_queued(connection, work.OBSERVE):
                return work.OBSERVE
            asking = any(running.job.kind == work.KNOW for running in self._running.values())
            rests = time.monotonic() < self._rest_until
            if not asking and work.any_queued(connection, work.KNOW, first=rests):
                return work.KNOW
            return work.OBSERVE if work.any_queued(connection, work.OBSERVE, gone=True) else None

    def _task(
        self, connection: Connection, job: work.Job, every_day: bool
    ) -> tuple[Callable[..., Outcome | None], Task | Question]:
        if job.kind == work.KNOW:
            return know, consequences.question_of(connection, self.service, job, every_day=every_day)
        return observe_stored, consequences.task_of(connection, self.service, job)

    def _collect(self) -> None:
        for number, running in list(self._running.items()):
            if running.future.done() or self.service.cluster.forsaken(running.future):
                enough = True
                with self._its_own_fault(running.job):
                    enough = self._keep(running)
                self._turned = time.monotonic()
                del self._running[number]
                if not enough:
                    with self._its_own_fault(running.job):
                        self._start(running.job, every_day=True)
                elif running.job.kind == work.KNOW:
                    took = time.monotonic() - running.since
                    self._rest_until = time.monotonic() + _RESTS * took

    def _keep(self, running: _Running) -> bool:
        """Store the result of a job; return False if the worker needs all days for it."""
        if self.service.cluster.forsaken(running.future):  # not the record's fault
            with writing(self.service.database) as connection:
                work.release(connection, running.job, self.service.server_id)
            return True
        if running.future.status == "finished":
            outcome: Outcome | None = running.future.result()
            if outcome is None:
                return False
            with writing(self.service.database) as connection:
                asked = running.job.kind == work.KNOW
                keep = consequences.keep_known if asked else consequences.keep
                keep(connection, self.service, running.job, outcome)
            return True
        reason, tried = _reason(running.future), self.service.cluster.has_begun(running.future)
        with writing(self.service.database) as connection:
            if tried:
                consequences.failed(connection, self.service, running.job, reason)
            else:  # it was queued at a worker that died of another task
                work.release(connection, running.job, self.service.server_id)
        return True

    def _end_overrun(self) -> None:
        settings = self.service.settings
        for running in list(self._running.values()):
            limit = settings.study_limit_s if running.job.kind == work.KNOW else settings.observe_limit_s
            if self.service.cluster.has_begun(running.future, limit) and not running.future.done():
                reason = f"took longer than {limit:g} s"
                self.service.cluster.end(running.future)
                with writing(self.service.database) as connection:
                    consequences.failed(connection, self.service, running.job, reason)
                del self._running[running.job.id]


def _runs(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass  # the process of another user
    return True


def _machine() -> str:
    """Return the identity of the process namespace, common to servers on one machine; empty if unknown."""
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
        return f"{boot} {os.readlink('/proc/self/ns/pid')}"
    except OSError:
        return ""


_MACHINE = _machine()


def _reason(future: Future) -> str:
    """Return a sentence with the reason that a task has no result."""
    try:
        error = future.exception(timeout=1)
    except Exception as lost:
        error = lost
    name = type(error).__name__
    if name in LOST_WORKER:
        return "the worker that observed it ended, out of memory or killed"
    return f"{name}: {error}"[:500]
