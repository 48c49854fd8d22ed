"""Why a task has no result: wrong input, a worker that ended, no worker, no space on the disk."""

from __future__ import annotations

import errno
from typing import Any

from jackettwin.errors import InputError

LOST_WORKER = ("KilledWorker", "CancelledError", "FutureCancelledError")
"""Errors which say that a worker ended during a task, for whatever reason."""
DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""Numbers of system errors where nothing can be written."""


class NoWorker(Exception):
    """No worker began a task in time; the task itself may be fine."""


def problem_of(error: InputError) -> dict[str, Any]:
    """Return the problem with a user's input, without its path on the server."""
    return {
        "detail": error.problem,
        "field": error.field,
        "value": None if error.value is None else str(error.value)[:200],
        "allowed": error.allowed,
        "remedy": error.remedy,
    }
