"""Workers: there are as many as were asked for, whatever becomes of them; a task has its time to itself."""

import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from distributed.scheduler import KilledWorker

from jackettwin.service import ServiceSettings
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
    compute.submit(time.sleep, 0.5)
    begin = time.monotonic()
    assert compute.result(compute.submit(time.sleep, 0.5), 0.8) is None
    assert time.monotonic() - begin > 0.9
    compute.submit(time.sleep, 0.8)
    with pytest.raises(NoWorker):
        compute.result(compute.submit(time.sleep, 0.0), 0.2)


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
