"""Supports: what the ground does to the structure."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.soil.files import parse_law, read_support
    from jackettwin.soil.support import (
        Spring,
        Support,
        clamped,
        on_translations,
        own_support,
        pinned,
        with_static_reactions,
    )

__all__ = [
    "Spring",
    "Support",
    "clamped",
    "on_translations",
    "own_support",
    "parse_law",
    "pinned",
    "read_support",
    "with_static_reactions",
]

door(
    __name__,
    {
        "files": "parse_law read_support",
        "support": "Spring Support clamped on_translations own_support pinned with_static_reactions",
    },
)
