"""Reasons for a task without result: wrong input, an ended worker, no worker, a full disk."""

from __future__ import annotations

import errno
from typing import Any

from jackettwin.errors import InputError

LOST_WORKER = ("KilledWorker", "CancelledError", "FutureCancelledError")
"""Names of errors after which a worker has ended during a task, for any reason."""
DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""System errors if nothing can be written."""


ROOM_BYTES = 256 * 2**20
"""Least free disk space, which the database needs to complete its transactions."""


class NoWorker(Exception):
    """No worker began a task in time; the task itself has no fault."""


def problem_of(error: InputError) -> dict[str, Any]:
    """Return the problem with a user's input, without paths on the server's disk."""
    return {
        "detail": error.problem,
        "field": error.field,
        "value": None if error.value is None else str(error.value)[:200],
        "allowed": error.allowed,
        "remedy": error.remedy,
    }
