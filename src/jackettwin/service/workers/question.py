"""What a worker is asked of all that a turbine's records showed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Question:
    """What a turbine's records showed, of which it is asked what that says of the supports and of a change.

    Attributes
    ----------
    identities : {day: identity}
        Of all days.
    days : {day: document}
        Of those that are not in what is kept, or of all.
    newest : documents of the newest observations, for the page
    in_all : how many records there are, and how long they are together [s]
    kept : what is kept of the sums of past days and of watching them, by name
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
