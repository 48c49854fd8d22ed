"""Files of strangers name other files: they may read those that came with them, and none of ours."""

from __future__ import annotations

import os
import sys
import zoneinfo
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import jackettwin
from jackettwin.errors import InputError
from jackettwin.plugins import load_all

_folder: ContextVar[Path | None] = ContextVar("folder", default=None)
_SOFTWARE = tuple(
    Path(place).resolve()
    for place in (sys.prefix, sys.base_prefix, str(Path(jackettwin.__file__).parent), *zoneinfo.TZPATH)
)
"""Where modules are loaded from, what is shipped with them, and time zones: nobody's secrets."""
_KNOWN_OF_MODULES = (".dist-info", ".egg-info")


@contextmanager
def only_files_in(folder: Path) -> Iterator[None]:
    """Refuse every file outside a folder that Python is asked to open in the block, whatever reader asks.

    Raises
    ------
    InputError
        In the block, whether there is such a file or not.
    """
    load_all()
    token = _folder.set(folder.resolve())
    try:
        yield
    finally:
        _folder.reset(token)


def _watch(event: str, arguments: tuple[Any, ...]) -> None:
    if event != "open" or (folder := _folder.get()) is None or isinstance(arguments[0], int):
        return
    path = Path(os.fsdecode(arguments[0])).resolve()
    known = any(path.is_relative_to(place) for place in (folder, *_SOFTWARE))
    if not known and path.parent.suffix not in _KNOWN_OF_MODULES:
        raise InputError(
            "a file is named that was not sent with it",
            field="files",
            value=Path(os.fsdecode(arguments[0])).name,
            allowed="the files of the twin, by their relative paths",
            remedy="send the file along and name it relative to the twin file",
        )


sys.addaudithook(_watch)
