"""What a command did not do: said in its answer under ``left_out``, with the clause that would ask for it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass


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
