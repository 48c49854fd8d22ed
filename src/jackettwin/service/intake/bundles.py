"""Bundles of a twin file with every file it names, and their extraction."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from sqlalchemy import Connection

from jackettwin.errors import InputError
from jackettwin.files import read_yaml
from jackettwin.service import workers
from jackettwin.store import assets

if TYPE_CHECKING:
    from jackettwin.service.context import Place

_LARGEST = 50 * 2**20
"""Largest size of one file; structures, soil profiles and rotors are text files of kilobytes."""
_WORD = re.compile(r"""["']([^"'\n]{1,200})["']|([A-Za-z0-9_./\\-]{1,200}\.[A-Za-z0-9]{1,8})""")
"""Pattern of a file name inside another text file: quoted, or with an extension."""


def bundle(twin: Path) -> dict[str, bytes]:
    """Return the files of a twin by their relative path, the twin file itself as ``twin.yaml``.

    Records are omitted, since they are imported separately. Files outside the twin's folder are stored under
    ``attached/``, and the twin file's paths are changed accordingly.

    Raises
    ------
    InputError
        If the twin file cannot be read, or a file is too large to be part of a model.
    """
    data = read_yaml(twin, what="twin file")
    folder, files = twin.parent.resolve(), dict[str, bytes]()
    had_records = bool(data.pop("records", None))
    moved = False

    def take(value: str) -> str:
        nonlocal moved
        found = _existing(folder, value)
        if found is None:
            return value
        place = value
        if not found.is_relative_to(folder):
            place, moved = f"attached/{found.name}", True
        _add(files, found, place)
        return place

    rewritten = _walked(data, take)
    text = twin.read_bytes()
    if moved or had_records:
        text = yaml.safe_dump(rewritten, sort_keys=False, allow_unicode=True).encode()
    files[workers.engine.TWIN_FILE] = text
    return files


def twin_folder(connection: Connection, service: Place, asset: str, version: int | None = None) -> Path:
    """Return the folder with the files of a version, by default of the adopted one."""
    found = assets.found_version(connection, asset, version)
    place = service.settings.models / found.bundle_hash
    if not place.is_dir():
        assets.lay_out(assets.bundle_of(connection, asset, found.version), place)
    return place


def _walked(data: Any, take: Any) -> Any:
    if isinstance(data, dict):
        return {key: _walked(value, take) for key, value in data.items()}
    if isinstance(data, list):
        return [_walked(value, take) for value in data]
    return take(data) if isinstance(data, str) else data


def _existing(folder: Path, name: str) -> Path | None:
    """Return the file of this name, if it exists."""
    try:
        path = (folder / name).resolve()
        return path if path.is_file() else None
    except (OSError, ValueError):
        return None


def _add(files: dict[str, bytes], path: Path, place: str) -> None:
    """Add a file, and recursively those that it names."""
    if place in files:
        return
    content = path.read_bytes()
    if len(content) > _LARGEST:
        raise InputError(
            "the file is too large to be part of a model",
            file=path,
            value=len(content),
            allowed=f"up to {_LARGEST} bytes",
            remedy="records are not part of a twin: import them with `jackettwin intake`",
        )
    files[place] = content
    here = Path(place).parent
    for name in _named(content):
        found = _existing(path.parent, name)
        if found is not None and found.is_relative_to(path.parent.resolve()):
            inner = here / found.relative_to(path.parent.resolve())
            _add(files, found, inner.as_posix())


def _named(content: bytes) -> Iterator[str]:
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return
    for quoted, plain in _WORD.findall(text):
        yield (quoted or plain).replace("\\", "/")
