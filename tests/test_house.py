"""The house stays as wide, as deep and as one-way as docs/design/009-rooms.md says."""

from __future__ import annotations

import ast
import json
from collections import Counter, defaultdict
from pathlib import Path

SOURCE = Path(__file__).parents[1] / "src" / "jackettwin"
MOST_MODULES = 20
"""Modules side by side in a folder; ``cli`` has one for each command."""
MOST_PAST_DOORS = 200
"""Names that are imported from within another package instead of through its door."""
PRIVATE_WORDS = set(
    "held kept kept_fits together sums doubts followed watched begun desk chores room remembered rendered "
    "confined likeness valley softer_feet believed".split()
)
"""Names of modules that said nothing to a newcomer."""


def modules() -> list[Path]:
    return [
        path for path in SOURCE.rglob("*.py") if path.stem != "__init__" and "migrations" not in path.parts
    ]


def test_no_folder_is_wide() -> None:
    folders = Counter(path.parent.relative_to(SOURCE).as_posix() for path in modules())
    assert {name: n for name, n in folders.items() if n > MOST_MODULES and name != "cli"} == {}


def test_no_module_has_a_private_name() -> None:
    assert [path for path in modules() if path.stem in PRIVATE_WORDS] == []


def past_doors() -> list[str]:
    """Return every name that one package imports from within another."""
    found = []
    for path in SOURCE.rglob("*.py"):
        own = path.relative_to(SOURCE).parts[0].removesuffix(".py")
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("jackettwin."):
                parts = str(node.module).split(".")
                if len(parts) > 2 and parts[1] != own:
                    found += [f"{path.stem}: {node.module}.{alias.name}" for alias in node.names]
    return found


def test_other_packages_are_entered_by_their_doors() -> None:
    assert len(past_doors()) <= MOST_PAST_DOORS


def test_no_public_class_has_the_name_of_another() -> None:
    homes = defaultdict(list)
    for path in modules():
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(path.relative_to(SOURCE).as_posix())
    assert {name: places for name, places in homes.items() if len(places) > 1} == {}


def test_the_window_stays_small_and_its_lock_file_names_no_registry() -> None:
    """As docs/design/014-window.md says: lines, packages at run time, no address to load them from."""
    app = SOURCE.parents[1] / "app"
    source = [path for path in (app / "src").rglob("*.*") if path.is_file() and path.name != "schema.d.ts"]
    assert sum(path.read_text("utf-8").count("\n") for path in source) <= 6000
    assert len(json.loads((app / "package.json").read_text("utf-8"))["dependencies"]) <= 8
    packages = json.loads((app / "package-lock.json").read_text("utf-8"))["packages"]
    assert len(packages) > 100 and not [name for name, one in packages.items() if "resolved" in one]
