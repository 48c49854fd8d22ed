"""The doors of packages: what a package offers, each name read from its module when it is first used.

A command then loads what it needs and no more. The names stand once, in the imports that the package's
``__init__`` makes for type checkers alone (as scientific Python's ``lazy_loader`` reads them from a stub).
Where a function has the name of its module, the door gives the function, whether or not the module was
loaded before.
"""

from __future__ import annotations

import ast
import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class Door(ModuleType):
    """A package whose public names are read from its modules on first use."""

    def __getattr__(self, name: str) -> Any:
        homes: dict[str, tuple[str, str]] = self.__dict__.get("_homes", {})
        if name not in homes:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        home, there = homes[name]
        value = getattr(import_module(home), there)
        super().__setattr__(name, value)
        return value

    def __setattr__(self, name: str, value: Any) -> None:
        # importing a module sets it on its package: that must not hide a function of the same name
        if not (isinstance(value, ModuleType) and name in self.__dict__.get("_homes", {})):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.__dict__.get("_homes", {})})


def door(package: str) -> None:
    """Make the names that a package imports ``if TYPE_CHECKING:`` its public names.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    """
    module = sys.modules[package]
    homes = _homes(ast.parse(module.__loader__.get_source(package)))  # type: ignore[union-attr]
    module.__dict__.update(_homes=homes, __all__=sorted(homes))
    module.__class__ = Door


def _homes(tree: ast.Module) -> dict[str, tuple[str, str]]:
    """Return {public name: (module, name there)} of the imports made for type checkers alone."""
    return {
        alias.asname or alias.name: (statement.module, alias.name)
        for block in tree.body
        if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
        for statement in block.body
        if isinstance(statement, ast.ImportFrom) and statement.module
        for alias in statement.names
    }
