"""Cache of expensive results by the content of their inputs."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeVar

from jackettwin.errors import InputError
from jackettwin.files.stored_schema import StoredSchema
from jackettwin.version import __version__

T = TypeVar("T")


class Keep(Protocol):
    """Keeps values of any schema under keys; it crosses processes."""

    def get(self, schema: StoredSchema[T], key: str) -> T | None:
        """Return what is kept under a key; None if nothing is, or nothing that this version can read."""
        ...

    def put(self, schema: StoredSchema[T], key: str, value: T) -> None:
        """Keep a value, if there is room."""
        ...


@dataclass(frozen=True)
class NotKept:
    """Keeps nothing."""

    def get(self, schema: StoredSchema[T], key: str) -> T | None:
        """Return None."""
        return None

    def put(self, schema: StoredSchema[T], key: str, value: T) -> None:
        """Do nothing."""


@dataclass(frozen=True)
class KeptInFolder:
    """Keeps each value as a file.

    Attributes
    ----------
    folder : Path
    version : str
        Of the code: what another one made is not found.
    fresh : bool
        Whether what is there is made again.
    """

    folder: Path
    version: str = __version__
    fresh: bool = False

    def place(self, schema: StoredSchema[T], key: str) -> Path:
        """Return where a value lies, or would."""
        return self.folder / f"{schema.name}-{key}-{self.version}.json"

    def get(self, schema: StoredSchema[T], key: str) -> T | None:
        """Return what is kept under a key; None if nothing is, or nothing that this version can read."""
        path = self.place(schema, key)
        with suppress(OSError, InputError):
            if not self.fresh:
                value = schema.read(path)
                os.utime(path)
                return value
        return None

    def put(self, schema: StoredSchema[T], key: str, value: T) -> None:
        """Keep a value, if there is room."""
        with suppress(OSError):
            schema.write(value, self.place(schema, key))


NOT_KEPT = NotKept()


def kept(keep: Keep, schema: StoredSchema[T], key: str, compute: Callable[[], T]) -> T:
    """Return what is kept under a key; else compute it and keep it."""
    known = keep.get(schema, key)
    if known is None:
        known = compute()
        keep.put(schema, key, known)
    return known
