"""Workers: there are as many as were asked for, whatever becomes of them; a task has its time to itself."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import Future
from distributed.scheduler import KilledWorker
from tests.service.servers import free_port, wait_for_port

from jackettwin.service import ServiceSettings
from jackettwin.service.workers.certificates import own_security
from jackettwin.service.workers.cluster import WorkerCluster
from jackettwin.service.workers.failures import NoWorker


@pytest.fixture(scope="module")
def compute(tmp_path_factory: pytest.TempPathFactory) -> Iterator[WorkerCluster]:
    made = WorkerCluster(ServiceSettings(store=tmp_path_factory.mktemp("store"), workers=1))
    yield made
    made.close()


def test_a_worker_that_was_given_up_is_replaced(compute: WorkerCluster) -> None:
    """As after a kill while it was starting, which Dask does not mend."""
    before = compute.submit(os.getpid).result(timeout=60)
    (nanny,) = compute._cluster.workers.values()  # type: ignore[union-attr]
    compute._cluster.sync(nanny.close)  # type: ignore[union-attr]
    end = time.monotonic() + 60.0
    while not compute.workers and time.monotonic() < end:
        compute.mend()
        time.sleep(0.2)
    assert compute.submit(os.getpid).result(timeout=60) != before
    assert compute.workers == 1


def test_a_worker_has_loaded_what_it_needs_before_its_first_task(compute: WorkerCluster) -> None:
    loaded = "'jackettwin.service.workers.engine' in __import__('sys').modules"
    assert compute.submit(eval, loaded).result(timeout=60)


def test_waiting_for_a_worker_is_not_the_tasks_time(compute: WorkerCluster) -> None:
    """Half a second before it begins and half a second of its own: less than its 0.8 s."""
    compute.submit(os.getpid).result(timeout=60)  # the worker is there
    compute.submit(time.sleep, 0.5)
    begin = time.monotonic()
    assert compute.result(compute.submit(time.sleep, 0.5), 0.8) is None
    assert time.monotonic() - begin > 0.9
    compute.submit(time.sleep, 3.0)
    with pytest.raises(NoWorker):
        compute.result(compute.submit(time.sleep, 0.0), 0.2)


class Slow:
    """A task's future whose result is fetched slowly, as from a worker on a busy machine."""

    def __init__(self, future: Future) -> None:
        self._future, self._fetched = future, iter((False, True))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._future, name)

    def result(self, timeout: float) -> Any:
        """Return the result at the second call, which is after the task's end."""
        _until(self._future.done)
        if next(self._fetched):
            return self._future.result(timeout=60)
        raise TimeoutError


def test_a_result_that_is_fetched_slowly_is_not_a_task_that_takes_too_long(compute: WorkerCluster) -> None:
    done = compute.submit(os.getpid)
    assert compute.result(Slow(done), 60.0) == done.result(timeout=60)
    own = compute.submit(eval, "exec('raise TimeoutError(5)')")
    with pytest.raises(TimeoutError, match="5"):
        compute.result(own, 60.0)


def test_a_task_that_takes_too_long_ends_its_worker_and_what_waited_there_was_not_tried(
    compute: WorkerCluster,
) -> None:
    before = compute.submit(os.getpid).result(timeout=60)
    compute.mend()
    restarts = compute.restarts
    hanging, waiting = compute.submit(time.sleep, 600.0), compute.submit(os.getpid)
    with pytest.raises(TimeoutError):
        compute.result(hanging, 0.3)
    with pytest.raises(KilledWorker):
        waiting.result(timeout=60)
    assert compute.has_begun(hanging) and not compute.has_begun(waiting)
    after = compute.submit(os.getpid).result(timeout=60)
    compute.mend()
    assert after != before and compute.restarts == restarts + 1


def test_a_task_that_its_worker_dies_of_was_tried(compute: WorkerCluster) -> None:
    fatal = compute.submit(os.abort)
    with pytest.raises(KilledWorker):
        fatal.result(timeout=60)
    end = time.monotonic() + 30.0  # on a loaded machine the error arrives before the event
    while not compute.has_begun(fatal) and time.monotonic() < end:
        time.sleep(0.1)
    assert compute.has_begun(fatal)
    assert compute.submit(os.getpid).result(timeout=60)  # its nanny has another one


def test_a_file_does_not_wait_at_a_busy_worker_while_another_is_free(tmp_path: Path) -> None:
    two = WorkerCluster(ServiceSettings(store=tmp_path, workers=2))
    try:
        while two.workers < 2:
            time.sleep(0.1)
        long = two.submit(time.sleep, 600.0)
        two.submit(time.sleep, 1.0)
        asked = [two.submit(os.getpid, priority=100) for _ in range(2)]  # one is put behind each
        assert all(one.result(timeout=60) for one in asked)
        assert not long.done()
    finally:
        two.close()


def test_no_record_waits_behind_a_study(compute: WorkerCluster) -> None:
    """A posterior of a minute on a server with one worker for records."""
    assert compute.submit(os.getpid).result(timeout=60)
    before = compute.workers
    study = compute.submit(time.sleep, 60.0, study=True)
    end = time.monotonic() + 90.0
    while not compute.has_begun(study) and time.monotonic() < end:
        time.sleep(0.2)
    assert compute.has_begun(study)
    begin = time.monotonic()
    assert len({compute.submit(os.getpid).result(timeout=30) for _ in range(5)}) == 1
    assert time.monotonic() - begin < 20.0 and not study.done()
    assert compute.workers == before  # that take records
    compute.end(study)


def test_a_scheduler_that_dies_and_comes_back_is_found_again(tmp_path: Path) -> None:
    """Uploads are refused meanwhile, to be sent again, and what was under way is nobody's fault."""
    security = own_security()
    files = {name: tmp_path / f"{name}.pem" for name in ("ca", "certificate", "key")}
    files["ca"].write_text(security.tls_ca_file)
    files["certificate"].write_text(security.tls_scheduler_cert)
    files["key"].write_text(security.tls_scheduler_key)
    given = {f"scheduler_{name}": path for name, path in files.items()}
    port = free_port()
    tls = ["--tls-ca-file", files["ca"], "--tls-cert", files["certificate"], "--tls-key", files["key"]]
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    options = ["--protocol", "tls", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]

    def started() -> subprocess.Popen[bytes]:
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        process = subprocess.Popen([*dask, *options, *map(str, tls)], **quiet)
        wait_for_port(port, 60.0)
        return process

    scheduler = started()
    made = WorkerCluster(ServiceSettings(store=tmp_path, scheduler=f"tls://127.0.0.1:{port}", **given))
    try:
        waiting = made.submit(os.getpid)  # there is no worker
        assert made.reachable and not made.forsaken(waiting)
        scheduler.kill()
        scheduler.wait()
        _until(lambda: not made.reachable)
        assert made.forsaken(waiting) and made.workers == 0
        with pytest.raises(NoWorker):
            made.submit(os.getpid)
        with pytest.raises(NoWorker):
            made.result(waiting, 60.0)
        made.mend()  # it is not there yet
        assert not made.reachable
        scheduler = started()

        def mended() -> bool:
            made.mend()
            return made.reachable

        _until(mended)
        again = made.submit(os.getpid)
        assert made.forsaken(waiting) and not made.forsaken(again)
    finally:
        made.close()
        scheduler.kill()
        scheduler.wait()


def _until(holds: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.2)
