"""What only tests call is not kept: a public name is used, offered by a door, or documented."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]


def names(tree: ast.AST) -> Iterator[str]:
    """Yield every name that is read in a module, as such, as an attribute or as a text."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def offered(tree: ast.Module) -> Iterator[str]:
    """Yield the names that a package's door offers."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            yield from (alias.name for alias in node.names)


def public(tree: ast.Module) -> Iterator[str]:
    """Yield public functions, classes and methods; what is decorated, or overrides, is called by others."""
    plain = [n for n in tree.body if isinstance(n, ast.FunctionDef | ast.ClassDef) and not n.decorator_list]
    methods = [
        method
        for own in tree.body
        if isinstance(own, ast.ClassDef) and not own.bases
        for method in own.body
        if isinstance(method, ast.FunctionDef)
    ]
    yield from (node.name for node in (*plain, *methods) if not node.name.startswith("_"))


def test_nothing_is_called_by_tests_alone() -> None:
    trees = {path: ast.parse(path.read_text(encoding="utf-8")) for path in ROOT.glob("src/**/*.py")}
    read = Counter(name for tree in trees.values() for name in names(tree))
    doors = {name for path, tree in trees.items() if path.stem == "__init__" for name in offered(tree)}
    pages = " ".join(path.read_text(encoding="utf-8") for path in ROOT.glob("docs/**/*.md"))
    code = " ".join(re.findall(r"`[^`\n]+`|^ .*$", pages, re.MULTILINE))
    documented = set(re.findall(r"\w+", code))
    unused = [
        f"{path.relative_to(ROOT)}: {name}"
        for path, tree in trees.items()
        for name in public(tree)
        if not read[name] and name not in doors | documented
    ]
    assert unused == []
