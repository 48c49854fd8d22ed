"""Workers: none outlives its parent, and one that dies takes only its own item with it."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from jackettwin.processes import GRACE_S, in_processes, on_one_blas_thread

PARENT = """
import os, sys, time
from jackettwin.processes import worker_pool

if __name__ == "__main__":
    with worker_pool(2) as pool:
        pids = {pool.submit(os.getpid).result() for _ in range(8)}
        if sys.argv[1] == "busy":
            jobs = [pool.submit(time.sleep, 600) for _ in range(4)]
        print("ready", flush=True)
        time.sleep(600)
"""
"""Ends long after any patience below, unless it is killed."""


@pytest.mark.parametrize("what", ["idle", "busy"])
@pytest.mark.skipif(sys.platform == "win32", reason="has no SIGKILL")
def test_workers_end_when_their_parent_is_killed(what: str, tmp_path: Path) -> None:
    """They share its output: that ends when the last of them has."""
    script = tmp_path / "parent.py"
    script.write_text(PARENT, encoding="utf-8")
    with subprocess.Popen([sys.executable, script, what], stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"ready\n"
        parent.send_signal(signal.SIGKILL)
        # two processes that have nothing to do but end; they take milliseconds on an idle machine
        parent.communicate(timeout=30.0)


def test_a_worker_that_dies_loses_its_own_item_only() -> None:
    """Of nine items two end their process; the others under way then are done again."""
    items = [f"{i} ** 2" for i in range(9)]
    items[2] = items[7] = "__import__('os')._exit(3)"
    found = dict(in_processes(eval, items, 2))
    assert found == {i: None if i in (2, 7) else i**2 for i in range(9)}


def test_an_error_of_the_work_is_raised() -> None:
    with pytest.raises(ZeroDivisionError):
        list(in_processes(eval, ["1 / 0"], 1))


INTERRUPTED = """
import sys, time
from jackettwin.files import atomic_path
from jackettwin.processes import GRACE_S, in_processes, on_one_blas_thread

def work(path):
    with atomic_path(path):
        print("ready", flush=True)
        time.sleep(600)

if __name__ == "__main__":
    list(in_processes(work, sys.argv[1:], 2))
"""


def test_ctrl_c_ends_what_runs_within_two_seconds_and_leaves_nothing(tmp_path: Path) -> None:
    script, out = tmp_path / "parent.py", tmp_path / "out"
    script.write_text(INTERRUPTED, encoding="utf-8")
    places = [str(out / name) for name in ("a", "b", "c")]
    with subprocess.Popen(
        [sys.executable, script, *places], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as parent:
        assert parent.stdout is not None
        assert [parent.stdout.readline() for _ in range(2)] == [b"ready\n"] * 2
        begun = time.monotonic()
        parent.send_signal(signal.SIGINT)
        parent.communicate(timeout=30.0)
        took = time.monotonic() - begun
    # one second of grace, and a machine that may be busy
    assert took < 2.0 + GRACE_S
    assert list(out.iterdir()) == []


def test_on_one_blas_thread_and_afterwards_on_as_many_as_before() -> None:
    def threads() -> set[int]:
        np.linalg.inv(np.eye(2))
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    with threadpool_limits(limits=2, user_api="blas"):
        assert (threads(), on_one_blas_thread(threads)(), threads()) == ({2}, {1}, {2})
