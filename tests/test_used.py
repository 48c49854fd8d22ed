"""What only tests call is not kept: a public name is used by its package, offered by a door or documented."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
CALLED_BY_OTHERS = ("jackettwin.client", "jackettwin.store.asset_copy", "jackettwin.store.migrations")
"""Modules whose names users, scripts or Alembic call."""


def imports(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Yield (module, name) of everything that is imported, or named ``module:name`` in a table."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and re.fullmatch(r"[\w.]+:\w+", str(node.value)):
            module, _, name = str(node.value).partition(":")
            yield module, name
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)


def offered(root: Path) -> Iterator[tuple[str, str]]:
    """Yield (module, name) of everything that a package's stub offers."""
    for path in root.rglob("__init__.pyi"):
        package = ".".join(path.relative_to(root).parent.parts)
        yield from (
            (f"{package}.{module}", name) for module, name in imports(ast.parse(path.read_text("utf-8")))
        )


def read(tree: ast.AST) -> set[str]:
    """Return all names that are read, as such or as attributes."""
    return {
        n.id if isinstance(n, ast.Name) else n.attr
        for n in ast.walk(tree)
        if isinstance(n, ast.Name | ast.Attribute)
    }


def unused(
    trees: dict[str, ast.Module], documented: set[str], doors: frozenset[tuple[str, str]] = frozenset()
) -> list[str]:
    """Return the public functions and classes that nothing but themselves reads.

    What a door offers is imported from the module that the door names.
    """
    imported = {*doors, *(pair for tree in trees.values() for pair in imports(tree))}
    attributes = {n.attr for tree in trees.values() for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    found = []
    for module, tree in trees.items():
        package, _, own = module.rpartition(".")
        for node in tree.body:
            if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
                continue
            if isinstance(node, ast.FunctionDef) and node.decorator_list:
                continue  # a command or a route: the decorator hands it on
            here = any(node.name in read(other) for other in tree.body if other is not node)
            as_attribute = (package, own) in imported and node.name in attributes
            if not (here or as_attribute or (module, node.name) in imported or node.name in documented):
                found.append(f"{module}.{node.name}")
    return found


def test_nothing_is_called_by_tests_alone() -> None:
    trees = {
        ".".join(path.relative_to(ROOT / "src").with_suffix("").parts).removesuffix(".__init__"): ast.parse(
            path.read_text("utf-8")
        )
        for path in (ROOT / "src").rglob("*.py")
    }
    pages = "\n".join(path.read_text("utf-8") for path in (ROOT / "docs").rglob("*.md"))
    code = " ".join(re.findall(r"`[^`\n]+`|^ .*$", pages, re.MULTILINE))
    found = unused(trees, set(re.findall(r"\w+", code)), frozenset(offered(ROOT / "src")))
    assert [name for name in found if not name.startswith(CALLED_BY_OTHERS)] == []


def test_a_name_that_nobody_reads_is_seen() -> None:
    trees = {"p.a": ast.parse("def f(): ...\ndef g(): ..."), "p.b": ast.parse("from p.a import f")}
    assert unused(trees, set()) == ["p.a.g"]
    assert unused(trees, {"g"}) == []
