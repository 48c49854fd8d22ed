"""Restriction of uploaded files to the files that were sent with them."""

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
"""Folders of modules, package data and time zones, which are not secret."""
_KNOWN_OF_MODULES = (".dist-info", ".egg-info")


@contextmanager
def only_files_in(folder: Path) -> Iterator[None]:
    """Raise an error if Python opens a file outside a folder within the block.

    Raises
    ------
    InputError
        Within the block, whether the file exists or not.
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
    # a collection of garbage within the block asks how much memory this process uses
    known = known or path == Path(f"/proc/{os.getpid()}/statm")
    if not known and path.parent.suffix not in _KNOWN_OF_MODULES:
        raise InputError(
            "it names a file that was not sent with it",
            field="files",
            value=Path(os.fsdecode(arguments[0])).name,
            allowed="the files of the twin, by their relative paths",
            remedy="also send the file, and name it relative to the twin file",
        )


sys.addaudithook(_watch)
