"""Every refusal of a record says what to do."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import jackettwin.records
from jackettwin.cli import identify

FOLDER = Path(jackettwin.records.__file__).parent
SOURCES = [*sorted(FOLDER.rglob("*.py")), Path(identify.__file__)]


def refusals(source: Path) -> Iterator[ast.Call]:
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in ("InputError", "MissingExtra"):
            yield node


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_every_error_has_a_remedy(source: Path) -> None:
    without = [call.lineno for call in refusals(source) if "remedy" not in {k.arg for k in call.keywords}]
    assert not without, f"{source}: lines {without}"


def test_there_are_refusals_to_look_at() -> None:
    assert sum(1 for source in SOURCES for _ in refusals(source)) > 40
