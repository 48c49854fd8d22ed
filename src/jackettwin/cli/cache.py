"""Where observations and fits are kept between runs: ``~/.cache/jackettwin``, or below ``XDG_CACHE_HOME``.

A file's name is a hash of all that it was made of (samples, model, settings, code): what changes makes
another name, and nothing has ever to be emptied by hand. The oldest files go when there are too many.
"""

from __future__ import annotations

import hashlib
import os
from functools import cache
from pathlib import Path

import jackettwin
from jackettwin.twin.cache import NOT_KEPT, Keep, KeptInFolder

MOST_BYTES = 500_000_000
"""Size of the cache: some thousand records."""
MOST_RECORDS = 500
"""Records of one batch that are kept: more would push everything else out (``--out FOLDER`` keeps any)."""
_DECIDING = ("identification", "records", "response", "soil", "structure", "twin", "updating")
"""What of the package decides on an observation or a fit."""


def cache_folder() -> Path:
    """Return the folder of the cache; it need not exist."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "jackettwin"


def keeping(*, fresh: bool = False) -> Keep:
    """Return what keeps observations and fits; with ``fresh`` those that are there are made again."""
    try:
        folder = cache_folder() / "kept"
        folder.mkdir(parents=True, exist_ok=True)
        _prune(folder)
    except (OSError, RuntimeError):  # no home, no right: everything works without
        return NOT_KEPT
    return kept_in(folder, fresh=fresh)


def kept_in(folder: Path, *, fresh: bool = False) -> KeptInFolder:
    """Return what keeps observations in a folder, as this code makes them."""
    return KeptInFolder(folder, _code(), fresh)


@cache
def _code() -> str:
    """Return the identity of the code that observes and fits: size and time of its files."""
    root = Path(jackettwin.__file__).parent
    stamps = sorted(
        (str(file.relative_to(root)), file.stat().st_size, file.stat().st_mtime_ns)
        for name in _DECIDING
        for file in (root / name).rglob("*.py")
    )
    return hashlib.sha256(repr(stamps).encode()).hexdigest()[:12]


def _prune(folder: Path) -> None:
    """Remove the files that were not used for longest, until the rest fits."""
    files = sorted(((f.stat().st_mtime, f.stat().st_size, f) for f in folder.glob("*.json")), reverse=True)
    total = 0
    for _, size, file in files:
        total += size
        if total > MOST_BYTES:
            file.unlink(missing_ok=True)
