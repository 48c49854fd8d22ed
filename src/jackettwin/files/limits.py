"""Ranges of the numbers in files: named ones for schemas, and in words for messages."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, get_args

from annotated_types import Ge, Gt, Le, Lt
from pydantic import Field

Angle = Annotated[float, Field(ge=-360.0, le=360.0)]
"""A direction [°]: more than a turn either way is a slip."""
Height = Annotated[float, Field(ge=-1e4, le=1e4)]
"""From still water [m]; open ends may be written as ±9999."""
ForceCoefficient = Annotated[float, Field(ge=0.0, le=10.0)]
"""C_D, C_a or C_p of members and their ends: DNV-RP-C205's tables end at 2 to 3 for one member."""
Frequency = Annotated[float, Field(ge=1e-3, le=1e3)]
"""Of vibrations [Hz]."""
Seed = Annotated[int, Field(ge=0, lt=2**63)]
"""Of a random number generator."""


def in_words(annotation: Any, metadata: list[Any], **broken: float) -> str | None:
    """Return the range of a field that holds the broken bound (``ge``, ``gt``, ``le``, ``lt``).

    A field may be of several kinds, each with a range of its own.

    >>> in_words(float, [Ge(0.0), Le(10.0)], le=10.0)
    '0 to 10'
    >>> in_words(float | None, [Gt(0.0)], gt=0.0)
    '> 0'
    """
    for limits in _limits(annotation, metadata):
        if broken.items() <= limits.items():
            return _text(limits)
    return None


def _limits(annotation: Any, metadata: tuple[Any, ...] | list[Any]) -> Iterator[dict[str, float]]:
    """Yield the bounds of an annotation and of all inside it."""
    found: dict[str, float] = {}
    for given in metadata:
        for one in getattr(given, "metadata", [given]):
            found |= {
                name: getattr(one, name)
                for kind, name in ((Ge, "ge"), (Gt, "gt"), (Le, "le"), (Lt, "lt"))
                if isinstance(one, kind)
            }
    if found:
        yield found
    for inside in get_args(annotation):
        yield from _limits(inside, getattr(inside, "__metadata__", ()))


def _text(limits: dict[str, float]) -> str:
    if limits.keys() == {"ge", "le"}:
        return f"{limits['ge']:g} to {limits['le']:g}"
    signs = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}
    return ", ".join(f"{sign} {limits[name]:g}" for name, sign in signs.items() if name in limits)
