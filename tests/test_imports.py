"""No module needs, at run time or for its types, a module that needs it."""

from __future__ import annotations

import ast
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src"


def homes(root: Path) -> dict[str, str]:
    """Return which module each public name of a package lives in: {package.name: module}."""
    return {
        ".".join((*package, alias.name)): ".".join((*package, statement.module))
        for path in root.rglob("__init__.pyi")
        for package in [path.relative_to(root).parent.parts]
        for statement in ast.parse(path.read_text()).body
        if isinstance(statement, ast.ImportFrom) and statement.module
        for alias in statement.names
    }


def imported(root: Path) -> dict[str, set[str]]:
    """Return which modules each module under a folder names in an import, wherever it stands."""
    names = {".".join(path.relative_to(root).with_suffix("").parts): path for path in root.rglob("*.py")}
    graph, offered = {}, homes(root)
    for name, path in names.items():
        if path.stem == "__init__":
            continue  # a door names its rooms for type checkers; it loads them on first use
        wanted: set[str] = set()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                full = {f"{node.module}.{alias.name}" for alias in node.names}
                wanted |= {offered.get(name, name) for name in full} | {node.module}
            elif isinstance(node, ast.Import):
                wanted |= {alias.name for alias in node.names}
        graph[name] = wanted & set(names)
    return graph


def test_no_module_needs_what_needs_it() -> None:
    graph = imported(SOURCE)
    assert len(graph) > 300
    TopologicalSorter(graph).prepare()


def test_a_circle_of_types_alone_is_seen(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("from b import f\n")
    (tmp_path / "b.py").write_text("if TYPE_CHECKING:\n    from a import T\n")
    with pytest.raises(CycleError):
        TopologicalSorter(imported(tmp_path)).prepare()


def test_no_door_offers_a_name_that_one_of_its_folders_has() -> None:
    """Once a module in that folder is imported, the folder would stand in the place of what is offered."""
    assert [name for name in homes(SOURCE) if (SOURCE / name.replace(".", "/")).is_dir()] == []


def test_no_public_class_name_stands_for_two_things() -> None:
    names = Counter(
        node.name
        for path in SOURCE.rglob("*.py")
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert [name for name, times in names.items() if times > 1] == []


def test_what_a_package_offers_comes_through_its_door() -> None:
    offered = [(*name.rpartition("."), home) for name, home in homes(SOURCE).items()]
    rooms = {(home, name) for package, _, name, home in offered if home.startswith(f"{package}.")}
    past = [
        f"{path.relative_to(SOURCE)}:{node.lineno} {alias.name}"
        for path in SOURCE.rglob("*.py")
        if path.stem != "__init__"
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and node.module and node.module.count(".") > 1
        if node.module.split(".")[1] != path.relative_to(SOURCE).parts[1]
        for alias in node.names
        if (node.module, alias.name) in rooms
    ]
    assert len(rooms) > 100 and past == []
