"""A hook of MkDocs: formulas become MathML when pages are built; a reader needs no script for them."""

from __future__ import annotations

import html
import re
from typing import Any

from latex2mathml.converter import convert

_FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def on_page_content(content: str, **_: Any) -> str:
    """Replace each formula that arithmatex has marked, in line or on a line of its own."""

    def mathml(found: re.Match[str]) -> str:
        tag, kind, tex = found.groups()
        shown = "block" if kind == "[" else "inline"
        return f'<{tag} class="arithmatex">{convert(html.unescape(tex), display=shown)}</{tag}>'

    return _FORMULA.sub(mathml, content)
