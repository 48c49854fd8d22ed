"""The documentation's pictures are of figures that the program still draws."""

from __future__ import annotations

import re
from pathlib import Path

import jackettwin
from pictures.__main__ import SHOTS


def test_the_captions_by_which_figures_are_found_are_still_written() -> None:
    """``make pictures`` waits for them in vain otherwise, after minutes."""
    source = Path(jackettwin.__file__).parent
    texts = (path.read_text("utf-8") for path in source.rglob("*") if path.suffix in (".py", ".html"))
    written = re.sub(r"\{[^{}]*\}", "c", " ".join(texts))  # as c varies
    assert [shot.figure for shot in SHOTS if shot.figure and shot.figure not in written] == []
