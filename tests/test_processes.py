"""Workers: none outlives its parent, and one that dies takes only its own item with it."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from jackettwin.processes import in_processes

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
