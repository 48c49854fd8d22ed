"""Every threat that the design page names is attacked by tests that there are."""

from __future__ import annotations

import ast
import re
from pathlib import Path

HERE = Path(__file__).parent
PAGE = HERE.parents[1] / "docs" / "design" / "015-threats.md"


def lines() -> list[list[str]]:
    """Return the columns of every line of the table."""
    rows = [line for line in PAGE.read_text("utf-8").splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in row.strip("|").split(" | ")] for row in rows[1:]]


def functions_of(name: str) -> set[str]:
    """Return the names of the tests in a file."""
    return {
        node.name
        for node in ast.parse((HERE / name).read_text("utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


def test_every_threat_is_attacked() -> None:
    known: dict[str, set[str]] = {}
    assert len(lines()) >= 20
    for who, does, answer, attacked in lines():
        assert who and does and answer
        named = re.findall(r"`(\w+\.py)::(\w+)`", attacked)
        assert named, does
        for file, test in named:
            assert test in known.setdefault(file, functions_of(file)), f"{file}::{test}"
