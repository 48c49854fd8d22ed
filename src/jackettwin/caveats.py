"""Limits of an answer: omissions (``left_out``) and assumptions (``assumptions``)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

TOLERANCES = "tolerances."
"""Prefix of the keys of assumptions that a twin file's ``tolerances`` can settle."""


@dataclass(frozen=True)
class Omission:
    """One thing that an answer does not cover.

    Attributes
    ----------
    what : str
        What is left out, and how to have it where that is possible.
    clause : str or None
        Standard and clause that treat it; None where no standard does.
    """

    what: str
    clause: str | None = None


OUT_OF_SCOPE = (
    Omission("ice: out of scope", "ISO 19906"),
    Omission("earthquakes: out of scope", "ISO 19901-2"),
)
"""Actions that no part of the program has."""


def omission_documents(omissions: Iterable[Omission]) -> list[dict[str, str | None]]:
    """Return omissions as they stand under ``left_out`` in every answer."""
    return [{"what": one.what, "clause": one.clause} for one in omissions]


def omission_sentences(documents: Iterable[Mapping[str, str | None]]) -> list[str]:
    """Return a line for each entry of ``left_out``, the clause in parentheses.

    Examples
    --------
    >>> omission_sentences([{"what": "ice", "clause": "ISO 19906"}, {"what": "crack growth", "clause": None}])
    ['ice (ISO 19906)', 'crack growth']
    """
    return [f"{one['what']} ({one['clause']})" if one["clause"] else str(one["what"]) for one in documents]


@dataclass(frozen=True)
class Assumption:
    """One thing that a run takes for granted.

    Attributes
    ----------
    key : str
        ``tolerances.NAME`` of a tolerance, else a word of its own.
    value : str
        A sentence for a choice of modelling; for a tolerance what it is and its standard deviation.
    confirmed : bool or None
        Whether somebody has weighed, measured or inspected it; None for a choice of modelling.
    moves : {parameter: float}
        Relative change of each updated parameter if the tolerance is one standard deviation more than stated.
    settled_by : str or None
        What would settle it.
    """

    key: str
    value: str
    confirmed: bool | None = None
    moves: Mapping[str, float] = field(default_factory=dict)
    settled_by: str | None = None


def assumption_documents(found: Iterable[Assumption]) -> list[dict[str, Any]]:
    """Return assumptions as plain JSON data."""
    return [{**vars(one), "moves": dict(one.moves)} for one in found]
