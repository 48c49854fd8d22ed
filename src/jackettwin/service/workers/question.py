"""Task of estimating a turbine's supports and changes from all records."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Question:
    """Data of a turbine's records for estimating its supports and changes.

    Attributes
    ----------
    identities : {day: identity}
        Of all days.
    days : {day: document}
        Days that are not in the stored sums, or all days.
    newest : documents of the newest observations, for the report
    in_all : number of records, and their total duration [s]
    kept : stored sums of past days and state of their monitoring, by name
    of : identity of the state
    """

    asset: str
    version: int
    twin_folder: str
    identities: Mapping[str, str]
    days: Mapping[str, str]
    newest: tuple[str, ...] = ()
    in_all: tuple[int, float] = (0, 0.0)
    kept: Mapping[str, Any] = field(default_factory=dict)
    of: str = ""
