"""Import of files from watched folders, each once its size no longer changes."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from jackettwin.service.intake.files import Accepted

log = logging.getLogger(__name__)

_LOOK_S = 0.5
"""Interval at which folders are listed: shared folders report no changes, and names may be no text."""
STILL_S = 2.0
"""Time without a change of size after which a file is complete."""
_LATER_S = 10.0
"""Time after which an import that failed temporarily is tried again."""
_IGNORED = (".json", ".tmp", ".part", ".swp", ".crdownload")
"""Extensions of descriptions, which belong to a record, and of unfinished files."""


def record_files(paths: Iterable[Path]) -> list[Path]:
    """Return the files to import from paths of files and folders, in a fixed order."""
    found: list[Path] = []
    for path in paths:
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        found += [file for file in inside if file.is_file() and not _left_out(file, given=not path.is_dir())]
    return found


def watch_folders(
    paths: Iterable[Path], take: Callable[[Path], Accepted | None], stop: Callable[[], bool] = lambda: False
) -> None:
    """Import existing and new files of folders until stopped; if ``take`` returns None, try again later."""
    folders = list(paths)
    seen: dict[Path, tuple[int, int]] = {}
    waiting: dict[Path, tuple[tuple[int, int], float]] = {}
    while not stop():
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
        time.sleep(_LOOK_S)


def _left_out(file: Path, *, given: bool) -> bool:
    return not given and (file.name.startswith(".") or file.suffix.lower() in _IGNORED)


def _mark(file: Path) -> tuple[int, int] | None:
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_size, found.st_mtime_ns
