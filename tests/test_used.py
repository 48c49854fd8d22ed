"""What only tests call is not kept: a public name is used by its package, offered by a door or documented."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
CALLED_BY_OTHERS = ("jackettwin.client", "jackettwin.store.asset_copy", "jackettwin.store.migrations")
"""Modules whose names users, scripts or Alembic call."""
NAMED = re.compile(r"[\w.]+:\w+")


def imports(nodes: Iterable[ast.AST]) -> Iterator[tuple[str, str]]:
    """Yield (module, name) of everything that is imported, or named ``module:name`` in a table."""
    for node in nodes:
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and NAMED.fullmatch(node.value):
            module, _, name = node.value.partition(":")
            yield module, name
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)


def offered(root: Path) -> Iterator[tuple[str, str]]:
    """Yield (module, name) of everything that a package's stub offers."""
    for path in root.rglob("__init__.pyi"):
        package = ".".join(path.relative_to(root).parent.parts)
        nodes = ast.walk(ast.parse(path.read_text("utf-8")))
        yield from ((f"{package}.{module}", name) for module, name in imports(nodes))


def unused(
    trees: dict[str, ast.Module], documented: set[str], doors: frozenset[tuple[str, str]] = frozenset()
) -> list[str]:
    """Return the public functions and classes that nothing but themselves reads.

    What a door offers is imported from the module that the door names.
    """
    imported, attributes, readers, own_reads = set(doors), set(), Counter[tuple[str, str]](), {}
    for module, tree in trees.items():
        for place, statement in enumerate(tree.body):
            nodes = list(ast.walk(statement))  # once: there are a million
            imported.update(imports(nodes))
            of_others = {n.attr for n in nodes if isinstance(n, ast.Attribute)}
            names = of_others | {n.id for n in nodes if isinstance(n, ast.Name)}
            attributes |= of_others
            own_reads[module, place] = names
            readers.update((module, name) for name in names)
    found = []
    for module, tree in trees.items():
        package, _, own = module.rpartition(".")
        for place, node in enumerate(tree.body):
            if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
                continue
            if isinstance(node, ast.FunctionDef) and node.decorator_list:
                continue  # a command or a route: the decorator hands it on
            here = readers[module, node.name] > (node.name in own_reads[module, place])
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
