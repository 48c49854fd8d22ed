"""Cache of observations and fits between runs: ``~/.cache/jackettwin``, or below ``XDG_CACHE_HOME``.

A file's name is a hash of all inputs (samples, model, settings, code), so that a changed input gives another
name and the cache never has to be cleared manually. The oldest files are deleted when it is full.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jackettwin
from jackettwin.files import write_json

if TYPE_CHECKING:
    from jackettwin.files import Keep, KeptInFolder

MOST_BYTES = 500_000_000
"""Largest size of the cache, enough for some thousand records."""
MOST_RECORDS = 500
"""Largest batch of records that is cached, since more would displace all else; ``--out FOLDER`` has no
limit."""
_DECIDING = ("identification", "records", "response", "soil", "structure", "study", "twin", "updating")
"""Subpackages that affect an observation or a fit."""


def cache_folder() -> Path:
    """Return the folder of the cache; it need not exist."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "jackettwin"


def keeping(*, fresh: bool = False) -> Keep:
    """Return the store of observations and fits; with ``fresh`` existing ones are recomputed."""
    from jackettwin.files import NOT_KEPT

    folder = kept_folder()
    return NOT_KEPT if folder is None else kept_in(folder, fresh=fresh)


def kept_folder() -> Path | None:
    """Return the folder of the cache after pruning; None if it cannot be written."""
    with suppress(OSError, RuntimeError):
        folder = cache_folder() / "kept"
        folder.mkdir(parents=True, exist_ok=True)
        _prune(folder)
        return folder
    return None


def kept_in(folder: Path, *, fresh: bool = False) -> KeptInFolder:
    """Return the store of observations in a folder, for this version of the code."""
    from jackettwin.files import KeptInFolder

    return KeptInFolder(folder, _code(), fresh)


@cache
def _code() -> str:
    """Return the identity of the code for observations and fits, from size and time of its files."""
    root = Path(jackettwin.__file__).parent
    files = [*root.glob("*.py"), *(file for name in _DECIDING for file in (root / name).rglob("*.py"))]
    stamps = sorted((str(f.relative_to(root)), f.stat().st_size, f.stat().st_mtime_ns) for f in files)
    return hashlib.sha256(repr([stamps, _installed()]).encode()).hexdigest()[:12]


def _installed() -> list[str]:
    """Return the installed packages with versions, as plugins and numerical libraries also affect results."""
    return sorted(info.name for folder in sys.path for info in Path(folder).glob("*.dist-info"))


def _prune(folder: Path) -> None:
    """Remove the least recently used files until the rest fits."""
    files = sorted(((f.stat().st_mtime, f.stat().st_size, f) for f in folder.glob("*.json")), reverse=True)
    total = 0
    for _, size, file in files:
        total += size
        if total > MOST_BYTES:
            file.unlink(missing_ok=True)


def document_place(folder: Path, sources: Iterable[str | Path], asked: object) -> Path | None:
    """Return the path in the cache of a command's document about records.

    It depends on the bytes of all files about the records, so that no numerical library has to be imported.

    Parameters
    ----------
    sources : files, and folders of files
    asked : all other inputs of the document, with a unique ``repr``

    Returns
    -------
    Path or None
        None if there are too many files, or one cannot be read, which is reported elsewhere.
    """
    content = hashlib.sha256(repr(asked).encode())
    with suppress(OSError, ValueError):
        files = [file for source in sources for file in _files_about(Path(source))]
        if len(files) > 2 * MOST_RECORDS:
            return None
        for file in files:
            with file.open("rb") as stream:
                content.update(f"{file}\0{hashlib.file_digest(stream, 'sha256').hexdigest()}\0".encode())
        return folder / f"document-{content.hexdigest()[:32]}-{_code()}.json"
    return None


def _files_about(source: Path) -> list[Path]:
    """Return the files of a folder, or a file and its description files."""
    if source.is_dir():
        return sorted(file for file in source.iterdir() if file.is_file())
    beside = (source.with_suffix(".json"), source.with_name("records.json"))
    return [source, *(file for file in beside if file.is_file())]


def kept_document(place: Path | None) -> Mapping[str, Any] | None:
    """Return a stored document; None if there is none or it cannot be read."""
    if place is not None:
        with suppress(OSError, ValueError):
            found = json.loads(place.read_text(encoding="utf-8"))
            os.utime(place)
            return found if isinstance(found, dict) else None
    return None


def keep_document(document: Mapping[str, Any], place: Path | None) -> None:
    """Store a document, if there is space."""
    if place is not None:
        with suppress(OSError):
            place.parent.mkdir(parents=True, exist_ok=True)
            write_json(document, place)
