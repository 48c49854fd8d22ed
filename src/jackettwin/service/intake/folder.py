"""Files that appear in folders: taken once they stand still, whatever else is written beside them."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from watchfiles import watch

from jackettwin.service.intake.files import Accepted

log = logging.getLogger(__name__)

STILL_S = 2.0
"""A file whose size did not change for so long is written."""
_LATER_S = 10.0
"""After which a file is tried again that could not be taken now: it may be one of thousands."""
_IGNORED = (".json", ".tmp", ".part", ".swp", ".crdownload")
"""Descriptions come with their record; the others are not finished."""


def record_files(paths: Iterable[Path]) -> list[Path]:
    """Return the files to take of some paths, folders opened, in a fixed order."""
    found: list[Path] = []
    for path in paths:
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        found += [file for file in inside if file.is_file() and not _left_out(file, given=not path.is_dir())]
    return found


def watch_folders(
    paths: Iterable[Path], take: Callable[[Path], Accepted | None], stop: Callable[[], bool] = lambda: False
) -> None:
    """Take what stands in folders and what appears, until told to stop; what ``take`` returns None of, later.

    ``watchfiles`` says that something happened; what is there is looked at each time, so that no event is
    needed twice and none can be lost.
    """
    folders = list(paths)
    seen: dict[Path, tuple[int, int]] = {}
    waiting: dict[Path, tuple[tuple[int, int], float]] = {}
    for _ in watch(*folders, yield_on_timeout=True, rust_timeout=500, raise_interrupt=False, stop_event=None):
        if stop():
            return
        for file in record_files(folders):
            mark = _mark(file)
            if mark is None or seen.get(file) == mark:
                continue
            known, since = waiting.get(file, (None, time.monotonic()))
            if known != mark:
                waiting[file] = (mark, time.monotonic())
            elif time.monotonic() - since >= STILL_S:
                took = take(file)
                if took is None:
                    waiting[file] = (mark, time.monotonic() + _LATER_S)
                else:
                    del waiting[file]
                    seen[file] = mark
                    log.info("%s: %s", file.name, took.problem["detail"] if took.problem else took.record_id)


def _left_out(file: Path, *, given: bool) -> bool:
    return not given and (file.name.startswith(".") or file.suffix.lower() in _IGNORED)


def _mark(file: Path) -> tuple[int, int] | None:
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_size, found.st_mtime_ns
