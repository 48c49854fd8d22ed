"""Numbers that can only be in the wrong unit."""

from __future__ import annotations

from jackettwin.errors import InputError


def refuse_tiny(field: str, value: float, *, least: float, remedy: str) -> None:
    """Refuse a positive value below ``least``; zero is no matter of units.

    Raises
    ------
    InputError
        Names the unit by an example.
    """
    if 0.0 < value < least:
        raise InputError(
            "too small to be in this unit",
            field=field,
            value=value,
            allowed=f"0, or {least:g} and more",
            remedy=remedy,
        )
