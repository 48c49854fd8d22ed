"""Check for disk space before the work that needs it."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from jackettwin.errors import InputError

LEAST_BYTES = 50_000_000
"""Free space a report with its figures and tables needs, with some to spare."""


def check_room(path: Path, least_bytes: int = LEAST_BYTES) -> None:
    """Refuse a file or folder that could not be written: no right to, or no space.

    Raises
    ------
    InputError
        Names the path and the folder that stands in the way.
    """
    there = path.absolute()
    while not there.exists() and there != there.parent:
        there = there.parent
    if there != path.absolute() and not there.is_dir():
        raise InputError("is a file, not a folder", file=there, remedy=f"choose another place than {path}")
    if not os.access(there, os.W_OK):
        raise InputError(
            "cannot be written",
            file=path,
            value=str(there),
            allowed="a place you may write to",
            remedy="choose another place, or change its rights",
        )
    free = shutil.disk_usage(there).free
    if free < least_bytes:
        raise InputError(
            "no space left",
            file=path,
            value=f"{free / 1e6:.0f} MB free",
            allowed=f"at least {least_bytes / 1e6:.0f} MB",
            remedy="make room, or choose another place",
        )
