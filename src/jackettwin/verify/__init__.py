"""Every published number, recomputed."""

from __future__ import annotations

from collections.abc import Callable

from jackettwin.verify import cantilever, jacket, supports, viscoelasticity
from jackettwin.verify.rows import Row

__all__ = ["Row", "published_rows"]

STEPS = 6
"""How often ``published_rows`` announces what it does."""


def published_rows(step: Callable[[str], None] = lambda _: None) -> tuple[Row, ...]:
    """Return every published number beside ours, in the order of the thesis."""
    step("chapter 3: cantilever")
    rows = cantilever.rows()
    step("chapter 4: viscoelasticity")
    rows += viscoelasticity.rows()
    step("chapter 5: jacket")
    rows += jacket.rows()
    return (*rows, *supports.rows(step))
