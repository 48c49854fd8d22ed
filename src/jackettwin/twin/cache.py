"""What is made of a record at great cost, kept by the content it was made of: nothing is done twice."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, TypeVar

from jackettwin.errors import InputError
from jackettwin.findings import Finding
from jackettwin.identification import Comparison, Identification, IdentificationSettings, ModalEstimate, Pick
from jackettwin.records import Record, record_id
from jackettwin.twin.codec import StoredSchema, digest
from jackettwin.version import __version__


@dataclass(frozen=True)
class Identified:
    """The costly part of an examination.

    Attributes
    ----------
    found : Identification
    methods : mapping or None
        The same modes by every method, if that was asked for.
    refused : mapping
        Methods that could not take the record, and why.
    """

    found: Identification
    methods: Mapping[str, tuple[ModalEstimate | None, ...]] | None = None
    refused: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, found: Identification, compared: Comparison | None) -> Identified:
        """Return an identification with what other methods made of the record."""
        return cls(found) if compared is None else cls(found, compared.modes, compared.refused)

    @property
    def comparison(self) -> Comparison | None:
        """The same modes by every method, None if that was not asked for."""
        return None if self.methods is None else Comparison(self.found, self.methods, self.refused)


IDENTIFIED = StoredSchema("identified", Identified)
"""How identifications are kept."""

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


def identified_key(
    ready: Record,
    settings: IdentificationSettings,
    picks: tuple[Pick, ...],
    findings: tuple[Finding, ...],
    *,
    compare: bool,
    in_rotor_axes: bool,
) -> str:
    """Return the identity of an identification: the same key, the same result to the last digit.

    The record's name counts: it stands in the result, and picks go by it.
    """
    own = [pick for pick in picks if pick.record in (None, ready.name)]
    return digest(
        [
            *record_content(ready),
            dict(settings),
            own,
            list(findings),
            compare,
            in_rotor_axes,
            __version__,
        ]
    )


def record_content(record: Record) -> tuple[str, str, str]:
    """Return the identity of a record's samples, its name, and all else that it says."""
    said = json.dumps([dict(record.conditions), dict(record.metadata)], sort_keys=True, default=str)
    return record_id(record), record.name, said
