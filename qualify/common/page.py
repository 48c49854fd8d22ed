"""Pages of docs/verification: a script writes the upper part, people what follows ``## Notes``."""

from __future__ import annotations

import sys
from pathlib import Path

PAGES = Path(__file__).parents[2] / "docs" / "verification"
NOTES = "\n## Notes\n"


def write_page(name: str, lines: list[str]) -> None:
    """Write a page; its notes stay."""
    path = PAGES / f"{name}.md"
    old = path.read_text(encoding="utf-8") if path.exists() else ""
    _, heading, notes = old.partition(NOTES)
    text = "\n".join(lines).rstrip() + "\n"
    path.write_text(text + heading + notes, encoding="utf-8")
    sys.stdout.write(text)


def percent(low: float, high: float, digits: int = 1) -> str:
    """Return an interval in per cent."""
    return f"{100 * low:.{digits}f}–{100 * high:.{digits}f} %"
