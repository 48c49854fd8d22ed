"""Supports: what the ground does to the structure."""

from typing import TYPE_CHECKING

from jackettwin.doors import door

if TYPE_CHECKING:
    from jackettwin.soil.files import parse_law as parse_law, read_support as read_support
    from jackettwin.soil.support import (
        Spring as Spring,
        Support as Support,
        clamped as clamped,
        on_translations as on_translations,
        own_support as own_support,
        pinned as pinned,
        with_static_reactions as with_static_reactions,
    )

door(__name__)
