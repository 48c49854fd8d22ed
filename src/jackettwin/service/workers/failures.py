"""Why a task has no result: wrong input, a worker that ended, no worker, no space on the disk."""

from __future__ import annotations

import errno
from typing import Any

from jackettwin.errors import InputError

LOST_WORKER = ("KilledWorker", "CancelledError", "FutureCancelledError")
"""Errors that say that a worker ended over a task, whatever of."""
DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""What the system says where nothing can be written."""


ROOM_BYTES = 256 * 2**20
"""Room that must be left on the disk: the database needs it to finish what it began."""


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
