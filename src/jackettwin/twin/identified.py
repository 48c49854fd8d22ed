"""What identification makes of a prepared record, kept by what it was made of."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from jackettwin.findings import Finding
from jackettwin.identification import Identification, IdentificationSettings, ModalEstimate
from jackettwin.identification.comparison import Comparison
from jackettwin.identification.picks import Pick
from jackettwin.records import Record
from jackettwin.records.identity import record_id
from jackettwin.twin.stored import StoredSchema, digest
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

Keep = Callable[[str, Callable[[], Identified]], Identified]
"""Returns what is kept under a key; else computes it, and keeps it."""


def not_kept(_: str, compute: Callable[[], Identified]) -> Identified:
    """Compute, and keep nothing."""
    return compute()


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
    said = json.dumps([dict(ready.conditions), dict(ready.metadata)], sort_keys=True, default=str)
    own = [pick for pick in picks if pick.record in (None, ready.name)]
    return digest(
        [
            record_id(ready),
            ready.name,
            said,
            settings,
            own,
            list(findings),
            compare,
            in_rotor_axes,
            __version__,
        ]
    )
