"""Stored documents in one form: a schema's name, its version, and migrations of older versions.

Files written by any earlier version are read for ever: a version that changes adds its migration to the
schema's row, and a file in ``tests/twin/stored`` that the old version wrote.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from jackettwin.errors import InputError, located
from jackettwin.files.atomic import atomic_path
from jackettwin.files.codec import decode, encode

T = TypeVar("T")
Plain = dict[str, Any]
Migration = Callable[[Plain], Plain]

DIGITS = 24
"""Hexadecimal digits of an identity: two of a million things share one with a chance of 1e-17."""


@dataclass(frozen=True)
class StoredSchema(Generic[T]):
    """Schema of one kind of stored document.

    Attributes
    ----------
    name : str
        Stands in every document as ``schema``.
    kind : type
        The frozen dataclass it becomes.
    migrations : tuple of callable
        The first makes version 2 of version 1, and so on: the present version is one more than there are.
    """

    name: str
    kind: type[T]
    migrations: tuple[Migration, ...] = ()

    @property
    def version(self) -> int:
        """The version that is written."""
        return len(self.migrations) + 1

    def dump(self, value: T) -> Plain:
        """Return the document of a value: plain JSON data with schema and version."""
        return {"schema": self.name, "schema_version": self.version, **encode(value)}

    def load(self, document: Any) -> T:
        """Return the value of a document of this or any earlier version.

        Raises
        ------
        InputError
            If it is another kind of document, of a later version, or damaged; names the field.
        """
        if not isinstance(document, Mapping) or document.get("schema") != self.name:
            found = document.get("schema") if isinstance(document, Mapping) else document
            raise InputError("another kind of document", field="schema", value=found, allowed=self.name)
        version, plain = document.get("schema_version"), dict(document)
        if not isinstance(version, int) or not 1 <= version <= self.version:
            raise InputError(
                "unknown version of the document",
                field="schema_version",
                value=version,
                allowed=f"1 to {self.version}",
                remedy="read it with the version of jackettwin that wrote it, or a later one",
            )
        for migrate in self.migrations[version - 1 :]:
            plain = migrate(plain)
        del plain["schema"], plain["schema_version"]
        return decode(self.kind, plain)

    def write(self, value: T, path: Path) -> None:
        """Write a document, whole or not at all."""
        with atomic_path(path) as temporary:
            temporary.write_text(
                json.dumps(self.dump(value), ensure_ascii=False, allow_nan=False, separators=(",", ":")),
                encoding="utf-8",
            )

    def read(self, path: Path) -> T:
        """Read a document.

        Raises
        ------
        InputError
            If the file is no such document; names file and field.
        """
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
        except (json.JSONDecodeError, UnicodeDecodeError):
            raise InputError("not a JSON document", file=path) from None
        with located(file=path):
            return self.load(document)


def digest(value: Any) -> str:
    """Return the identity of a value by its content: equal documents, equal identity.

    Examples
    --------
    >>> digest({"a": 1, "b": (2.0,)}) == digest({"b": [2.0], "a": 1})
    True
    """
    text = json.dumps(encode(value), sort_keys=True, ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGITS]
