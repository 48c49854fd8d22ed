"""Where observations and fits are kept between runs: ``~/.cache/jackettwin``, or below ``XDG_CACHE_HOME``.

A file's name is a hash of all that it was made of (samples, model, settings, code): what changes makes
another name, and nothing has ever to be emptied by hand. The oldest files go when there are too many.
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
"""Size of the cache: some thousand records."""
MOST_RECORDS = 500
"""Records of one batch that are kept: more would push everything else out (``--out FOLDER`` keeps any)."""
_DECIDING = ("identification", "records", "response", "soil", "structure", "study", "twin", "updating")
"""What of the package decides on an observation or a fit."""


def cache_folder() -> Path:
    """Return the folder of the cache; it need not exist."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "jackettwin"


def keeping(*, fresh: bool = False) -> Keep:
    """Return what keeps observations and fits; with ``fresh`` those that are there are made again."""
    from jackettwin.files import NOT_KEPT

    folder = kept_folder()
    return NOT_KEPT if folder is None else kept_in(folder, fresh=fresh)


def kept_folder() -> Path | None:
    """Return the folder of what is kept between runs, pruned; None if nothing can be kept."""
    with suppress(OSError, RuntimeError):
        folder = cache_folder() / "kept"
        folder.mkdir(parents=True, exist_ok=True)
        _prune(folder)
        return folder
    return None


def kept_in(folder: Path, *, fresh: bool = False) -> KeptInFolder:
    """Return what keeps observations in a folder, as this code makes them."""
    from jackettwin.files import KeptInFolder

    return KeptInFolder(folder, _code(), fresh)


@cache
def _code() -> str:
    """Return the identity of the code that observes and fits: size and time of its files."""
    root = Path(jackettwin.__file__).parent
    files = [*root.glob("*.py"), *(file for name in _DECIDING for file in (root / name).rglob("*.py"))]
    stamps = sorted((str(f.relative_to(root)), f.stat().st_size, f.stat().st_mtime_ns) for f in files)
    return hashlib.sha256(repr([stamps, _installed()]).encode()).hexdigest()[:12]


def _installed() -> list[str]:
    """Return what is installed, with versions: plugins and numerical libraries decide on numbers, too."""
    return sorted(info.name for folder in sys.path for info in Path(folder).glob("*.dist-info"))


def _prune(folder: Path) -> None:
    """Remove the files that were not used for longest, until the rest fits."""
    files = sorted(((f.stat().st_mtime, f.stat().st_size, f) for f in folder.glob("*.json")), reverse=True)
    total = 0
    for _, size, file in files:
        total += size
        if total > MOST_BYTES:
            file.unlink(missing_ok=True)


def document_place(folder: Path, sources: Iterable[str | Path], asked: object) -> Path | None:
    """Return where the document of a command about records lies, or would.

    It goes by the bytes of all files that say something of the records, so that nothing numerical has to be
    loaded to find it.

    Parameters
    ----------
    sources : files, and folders of files
    asked : what else decides on the document, with a ``repr`` of its own

    Returns
    -------
    Path or None
        None if there are too many files to keep, or one that cannot be read: that is for others to say.
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
    """Return the files of a folder, or a file and the descriptions beside it."""
    if source.is_dir():
        return sorted(file for file in source.iterdir() if file.is_file())
    beside = (source.with_suffix(".json"), source.with_name("records.json"))
    return [source, *(file for file in beside if file.is_file())]


def kept_document(place: Path | None) -> Mapping[str, Any] | None:
    """Return a document as it was written; None if there is none, or nothing that can be read."""
    if place is not None:
        with suppress(OSError, ValueError):
            found = json.loads(place.read_text(encoding="utf-8"))
            os.utime(place)
            return found if isinstance(found, dict) else None
    return None


def keep_document(document: Mapping[str, Any], place: Path | None) -> None:
    """Keep a document, if there is room."""
    if place is not None:
        with suppress(OSError):
            place.parent.mkdir(parents=True, exist_ok=True)
            write_json(document, place)
