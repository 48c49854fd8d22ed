"""The doors of packages: what a package offers, each name read from its module when it is first used.

A command then loads what it needs and no more. Where a function has the name of its module, the door gives
the function, whether or not the module was loaded before.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module
from types import ModuleType
from typing import Any


class Door(ModuleType):
    """A package whose public names are read from its modules on first use."""

    def __getattr__(self, name: str) -> Any:
        homes: dict[str, str] = self.__dict__.get("_homes", {})
        if name not in homes:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        value = getattr(import_module(f"{self.__name__}.{homes[name]}"), name)
        super().__setattr__(name, value)
        return value

    def __setattr__(self, name: str, value: Any) -> None:
        # importing a module sets it on its package: that must not hide a function of the same name
        if not (isinstance(value, ModuleType) and name in self.__dict__.get("_homes", {})):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.__dict__.get("_homes", {})})


def door(package: str, modules: Mapping[str, str]) -> None:
    """Make the names of some modules the public names of a package.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    modules : {module: names}
        Names apart by spaces.
    """
    module = sys.modules[package]
    module.__dict__["_homes"] = {name: home for home, names in modules.items() for name in names.split()}
    module.__class__ = Door
