"""Elements of a page, and its output as one self-contained file."""

from __future__ import annotations

import gzip
import re
from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Literal

import plotly.graph_objects as go
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup, escape
from plotly.offline import get_plotlyjs

from jackettwin.files import atomic_path
from jackettwin.report.table import Table
from jackettwin.report.tables.light import Light
from jackettwin.report.tables.sentences import AnsweredQuestion


@dataclass(frozen=True)
class Text:
    """Paragraphs, or the items of a list."""

    paragraphs: tuple[str, ...]
    style: Literal["paragraphs", "list", "warnings"] = "paragraphs"
    kind: Literal["text"] = "text"


@dataclass(frozen=True)
class Plot:
    """A figure with a name, which is also the name of its file."""

    name: str
    caption: str
    figure: go.Figure
    big: bool = False
    """Drawn on request only."""
    fits: bool = False
    """Whether it is drawn as narrow as a small screen; others are scrolled sideways."""
    picks_of: str = ""
    """Record for which a click on a pole in the stabilisation diagram makes a pick."""
    kind: Literal["plot"] = "plot"

    @property
    def packed(self) -> str:
        """The figure as JSON, compressed."""
        return packed(self.figure.to_json())

    @property
    def scenes(self) -> int:
        """Number of 3D scenes, each of which needs a WebGL context."""
        return sum(1 for key in self.figure.layout.to_plotly_json() if key.startswith("scene"))

    @property
    def height(self) -> int:
        """Height [px]."""
        return int(self.figure.layout.height)


@dataclass(frozen=True)
class Drawing:
    """Drawings without script, side by side if there is room; the caption is the question they answer."""

    name: str
    caption: str
    drawings: tuple[Markup, ...]
    kind: Literal["drawing"] = "drawing"


@dataclass(frozen=True)
class FirstPage:
    """A light, questions with their answers, and drawings."""

    light: Light
    questions: tuple[AnsweredQuestion, ...]
    drawings: tuple[Drawing, ...]
    kind: Literal["first"] = "first"


@dataclass(frozen=True)
class Embedded:
    """A separate page that is shown in this one on request."""

    name: str
    caption: str
    html: str
    button: str
    height: int = 640
    kind: Literal["embedded"] = "embedded"

    @property
    def packed(self) -> str:
        """The page, compressed."""
        return packed(self.html)


Block = Text | Table | Plot | Drawing | FirstPage | Embedded


@dataclass(frozen=True)
class PageSection:
    """A heading and the blocks below it."""

    title: str
    blocks: tuple[Block, ...]
    appendix: bool = False

    @property
    def anchor(self) -> str:
        """Fragment identifier of the section."""
        return "".join(c if c.isalnum() else "-" for c in self.title.lower()).strip("-")


def page_text(sections: Sequence[PageSection], *, title: str, subtitle: str = "") -> str:
    """Return one self-contained HTML page, with the plotting library only if there is a plot."""
    library = packed(get_plotlyjs()) if any(_plots(sections)) else ""
    return _rendered(
        "page.html.j2", sections=sections, title=title, subtitle=subtitle, plotly=library, rules=rules()
    )


_LIBRARY = re.compile(r'(<script type="text/plain" class="packed" id="plotly">)[^<]*')
"""The library that draws the plots of a page, the same in each."""
_NO_LIBRARY = "'none-yet'"
_BLOCKS = re.compile(r'<(style|script)(?: type="module")?>(.*?)</\1>', re.DOTALL)
"""What a browser applies or runs of a page."""


@cache
def rules() -> str:
    """Return the rules of a page for its browser (Content-Security-Policy): nothing is loaded from elsewhere.

    What may run are the scripts and styles of our own templates and the plotting library, by hash; of a page
    its words and numbers add nothing, whatever they are. The library makes an empty style sheet and fills it
    rule by rule, so that the hash of no style at all is among them.
    """
    empty: dict[str, object] = {"title": "", "sections": (), "subtitle": "", "plotly": "", "rules": ""}
    pages = _rendered("page.html.j2", **empty), _rendered("view.html.j2", title="", facts=(), data="")
    blocks = [block for page in pages for block in _BLOCKS.findall(page)]
    styles = [_hash(text) for kind, text in blocks if kind == "style"]
    scripts = [_hash(text) for kind, text in blocks if kind == "script"]
    return (
        f"default-src 'none'; script-src {' '.join(scripts)} {_hash(get_plotlyjs())}; "
        f"style-src {' '.join(styles)} {_hash('')}; img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def without_library(page: str) -> str:
    """Return a page without the library that draws its plots."""
    return _LIBRARY.sub(r"\1", page).replace(str(escape(_hash(get_plotlyjs()))), _NO_LIBRARY, 1)


def with_library(page: str) -> str:
    """Return a page that :func:`without_library` made with the installed library in its place."""
    known = page.replace(_NO_LIBRARY, str(escape(_hash(get_plotlyjs()))), 1)
    return _LIBRARY.sub(lambda found: found[1] + packed(get_plotlyjs()), known)


def write_page(sections: Sequence[PageSection], path: Path, *, title: str, subtitle: str = "") -> Path:
    """Write one self-contained HTML file."""
    return _write(page_text(sections, title=title, subtitle=subtitle), path)


def write_figures(sections: Sequence[PageSection], directory: Path) -> None:
    """Write every figure as a file: plots as pages with a shared ``plotly.min.js``, drawings as SVG."""
    for drawing in _drawings(sections):
        for i, svg in enumerate(drawing.drawings, start=1):
            name = drawing.name if len(drawing.drawings) == 1 else f"{drawing.name}_{i}"
            with atomic_path(directory / f"{name}.svg") as temporary:
                temporary.write_text(svg, encoding="utf-8")
    plots = list(_plots(sections))
    if not plots:
        return
    with atomic_path(directory / "plotly.min.js") as temporary:
        temporary.write_text(get_plotlyjs(), encoding="utf-8")
    for plot in plots:
        _write(_rendered("figure.html.j2", plot=plot, title=plot.name), directory / f"{plot.name}.html")


def _drawings(sections: Iterable[PageSection]) -> Iterable[Drawing]:
    for section in sections:
        for block in section.blocks:
            if isinstance(block, Drawing):
                yield block
            elif isinstance(block, FirstPage):
                yield from block.drawings


def _plots(sections: Iterable[PageSection]) -> Iterable[Plot]:
    return (block for section in sections for block in section.blocks if isinstance(block, Plot))


def packed(text: str) -> str:
    """Return a compressed text (gzip, base64) for the page's script; the result is reproducible."""
    return b64encode(gzip.compress(text.encode(), compresslevel=6, mtime=0)).decode()


def _rendered(template: str, **context: object) -> str:
    environment = Environment(
        loader=PackageLoader("jackettwin.report"),
        autoescape=select_autoescape(("html", "j2")),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(**context)


def _write(text: str, path: Path) -> Path:
    with atomic_path(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return path
