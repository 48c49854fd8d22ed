"""Provenance of a run: time, command, files and versions."""

from __future__ import annotations

import hashlib
import platform
import shlex
import sys
from collections.abc import Iterable
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jackettwin.twin import TwinConfig


_LIBRARIES = ("numpy", "scipy")
_BLOCK = 1 << 20


def provenance(config: TwinConfig) -> tuple[tuple[str, str], ...]:
    """Return the provenance of a run as (name, value); files by the first 16 digits of their SHA-256."""
    command = " ".join(["jackettwin", *map(shlex.quote, sys.argv[1:])])
    libraries = ", ".join(f"{name} {version(name)}" for name in _LIBRARIES)
    return (
        ("made", f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC"),
        ("command", command),
        ("versions", f"Python {platform.python_version()}, {libraries}"),
        ("seed", f"{config.update.seed} of the search and the posterior"),
        *((f"SHA-256 of {path.name}", _hash(path)) for path in _files(config)),
    )


def _files(config: TwinConfig) -> Iterable[Path]:
    """Return the input files of a run, the twin first."""
    return (path for path in (config.path, *config.records) if path.is_file())


def _hash(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()[:16]
