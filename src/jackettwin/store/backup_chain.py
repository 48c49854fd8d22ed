"""Chains of incremental backups: the contents of each, and whether the chain is complete."""

from __future__ import annotations

import hashlib
import json
import tarfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from jackettwin.errors import InputError, require

CONTENTS = "contents.txt"


def identity_of(lines: Iterable[bytes]) -> str:
    """Return the identity of lines: a hash of them all."""
    hashed = hashlib.sha256()
    for line in lines:
        hashed.update(line)
    return hashed.hexdigest()


def lines_not_in(lines: Iterable[bytes], before: Iterable[bytes]) -> Iterator[bytes]:
    """Yield the lines that are not among others; both in their order, neither in memory.

    >>> list(lines_not_in([b"a", b"b", b"d"], [b"a", b"c", b"d"]))
    [b'b']
    """
    others = iter(before)
    other = next(others, None)
    for line in lines:
        while other is not None and other < line:
            other = next(others, None)
        if other != line:
            yield line


@contextmanager
def earlier_contents(file: Path | None) -> Iterator[tuple[Iterable[bytes], str | None]]:
    """Give the contents of an earlier backup, line by line, and their identity; nothing without one.

    Raises
    ------
    InputError
        If it is no backup, or one of a version that wrote no contents.
    """
    if file is None:
        yield (), None
        return
    try:
        with tarfile.open(file, "r:gz") as archive:
            identity = identity_of(archive.extractfile(CONTENTS) or ())
            yield archive.extractfile(CONTENTS) or (), identity
    except (tarfile.TarError, EOFError, OSError, KeyError) as error:
        raise InputError(
            "not a backup that another one can follow",
            file=file,
            field="since",
            value=str(error)[:200],
            remedy="take a whole one first",
        ) from None


def checked_chain(files: Sequence[Path]) -> dict[Path, set[str] | None]:
    """Return which days of observations to take of each backup of a chain, oldest first; None for all.

    Raises
    ------
    InputError
        If one does not follow the one before it, or the first follows another one.
    """
    before = schema = None
    hashes: dict[Path, dict[str, str]] = {}
    for file in files:
        with tarfile.open(file, "r:gz") as archive:
            stream = archive.extractfile("manifest.json")
            manifest = json.load(stream) if stream is not None else {}
            schema = schema or manifest.get("schema_version")
            require(
                (manifest.get("since"), manifest.get("schema_version")) == (before, schema),
                "the backup does not follow the one that is given before it",
                file=file,
                field="earlier",
                remedy="give all backups from the whole one on, oldest first",
            )
            before = manifest.get("contents")
            if len(files) > 1:
                hashes[file] = _days(archive)
    if len(files) == 1:
        return {files[0]: None}
    return _newest(files, hashes)


def _days(archive: tarfile.TarFile) -> dict[str, str]:
    """Return the hash of every day of observations that there was, {day of whom: hash}."""
    found = {}
    for line in archive.extractfile(CONTENTS) or ():
        kind, *more = line.rstrip(b"\n").decode().split("\t")
        if kind == "o":
            found[more[0]] = more[1]
    return found


def _newest(files: Sequence[Path], hashes: dict[Path, dict[str, str]]) -> dict[Path, set[str] | None]:
    """Return the days that each backup holds as they were in the end: those that changed with it last."""
    wanted: dict[Path, set[str] | None] = {}
    known: dict[str, str] = {}
    last: dict[str, Path] = {}
    for file in files:
        for day, hashed in hashes[file].items():
            if known.get(day) != hashed:
                last[day] = file
        known = hashes[file]
    for file in files:
        wanted[file] = {day for day, place in last.items() if place == file and day in known}
    return wanted
