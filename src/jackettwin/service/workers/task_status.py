"""What a worker and its server know of a task: that it began, what was wrong with it, that no worker came."""

from __future__ import annotations

import ctypes
import errno
import time
from collections.abc import Callable
from typing import Any

from jackettwin.errors import InputError

LOST_WORKER = ("KilledWorker", "CancelledError", "FutureCancelledError")
"""Errors that say that a worker ended over a task, whatever of."""
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""What the system says where nothing can be written."""
_SAID_S = 0.01
"""Until what a worker says is on its way, even if it dies of the task at once: Dask collects for 2 ms."""


class NoWorker(Exception):
    """No worker came to a task in time; nothing is wrong with it."""


def problem_of(error: InputError) -> dict[str, Any]:
    """Return what is wrong with a user's input; where it lies on our disk is nobody's business."""
    return {
        "detail": error.problem,
        "field": error.field,
        "value": None if error.value is None else str(error.value)[:200],
        "allowed": error.allowed,
        "remedy": error.remedy,
    }


def begun(topic: str, task: Callable[..., Any], *args: Any) -> Any:
    """Say that a worker begins with a task, do it, and give back the memory that it left free."""
    from distributed import get_worker  # the command line reads files without workers

    worker = get_worker()
    worker.log_event(topic, worker.get_current_task())
    time.sleep(_SAID_S)
    try:
        return task(*args)
    finally:
        give_back()


def give_back() -> None:
    """Return free memory to the system; glibc keeps what lies below the highest block in use, and grows."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:  # other C libraries have no such function
        trim(0)


def one_heap() -> None:
    """Have all threads of this process share one heap; glibc makes many, each with free room of its own."""
    tune = getattr(ctypes.CDLL(None), "mallopt", None)
    if tune is not None:
        tune(_M_ARENA_MAX, 1)


_M_ARENA_MAX = -8
"""Of glibc's ``mallopt``; other C libraries answer that they do not know it."""
