"""``python -m gallery [FOLDER]``: the figures of the thesis as ``gallery.html``, each beside it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from gallery.thesis_figures import thesis_figures
from jackettwin.report import PageSection
from jackettwin.report.pages.page import write_figures, write_page
from jackettwin.version import __version__


def write_gallery(sections: Sequence[PageSection], out: Path) -> Path:
    """Write the sections and their figures into a folder; return the path of the page."""
    write_figures(sections, out / "figures")
    title = "The figures of the thesis, recomputed"
    return write_page(sections, out / "gallery.html", title=title, subtitle=f"jackettwin {__version__}")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/gallery")
    print(write_gallery(thesis_figures(lambda step: print(step, file=sys.stderr)), folder))
