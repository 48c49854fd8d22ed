"""Where identifications are kept between runs: ``~/.cache/jackettwin``, or below ``XDG_CACHE_HOME``.

A file's name is a hash of the record's content, all settings and the code that identifies: what changes makes
another name, and nothing has ever to be emptied by hand. The oldest files go when there are too many.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from pathlib import Path

import jackettwin
from jackettwin.errors import InputError
from jackettwin.twin.identified import IDENTIFIED, Identified, Keep, not_kept

MOST_BYTES = 500_000_000
"""Size of the cache: some thousand records."""
MOST_RECORDS = 500
"""Records of one batch that are kept: more would push everything else out (``--out FOLDER`` keeps any)."""
_IDENTIFYING = ("identification", "records", "twin")
"""What of the package decides on an identification."""


def cache_folder() -> Path:
    """Return the folder of the cache; it need not exist."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if Path(base).is_absolute() else Path.home() / ".cache") / "jackettwin"


def keeping(*, fresh: bool = False) -> Keep:
    """Return what keeps identifications; with ``fresh`` those that are there are computed again."""
    try:
        folder = cache_folder() / "identified"
        folder.mkdir(parents=True, exist_ok=True)
        _prune(folder)
    except (OSError, RuntimeError):  # no home, no right: everything works without
        return not_kept
    return partial(_kept, folder, fresh)


def _kept(folder: Path, fresh: bool, key: str, compute: Callable[[], Identified]) -> Identified:
    path = folder / f"{key}-{_code()}.json"
    if not fresh:
        with suppress(OSError, InputError):
            kept = IDENTIFIED.read(path)
            os.utime(path)
            return kept
    made = compute()
    with suppress(OSError):
        IDENTIFIED.write(made, path)
    return made


@cache
def _code() -> str:
    """Return the identity of the code that identifies: size and time of its files."""
    root = Path(jackettwin.__file__).parent
    stamps = sorted(
        (str(file.relative_to(root)), file.stat().st_size, file.stat().st_mtime_ns)
        for name in _IDENTIFYING
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
