"""Entries that other installed packages add to our registries through entry points."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, TypeVar

from jackettwin.errors import InputError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

Kind = TypeVar("Kind")


@cache
def plugins(group: str) -> dict[str, object]:
    """Load what installed packages enter in a group, by the name of the entry point.

    Parameters
    ----------
    group : str
        Group of entry points, ``"jackettwin.readers"``.

    Raises
    ------
    InputError
        If a package's entry point cannot be loaded, or two packages enter the same name: names both.
    """
    from importlib.metadata import entry_points  # slow to import, and seldom needed

    points: dict[str, EntryPoint] = {}
    for point in entry_points(group=group):
        other = points.setdefault(point.name, point)
        if other.value != point.value:
            raise InputError(
                f"two packages enter the same name: {_package(other)} and {_package(point)}",
                field=f"entry point {group}",
                value=point.name,
                remedy="uninstall one of the two",
            )
    return {name: _loaded(point) for name, point in points.items()}


@cache
def load_all() -> None:
    """Load all that installed packages add, before anything is opened that a stranger may have named.

    Raises
    ------
    InputError
        As :func:`plugins` does.
    """
    from importlib.metadata import entry_points

    for group in entry_points().groups:
        if group.startswith("jackettwin."):
            plugins(group)


def plugins_of_type(group: str, kind: type[Kind]) -> dict[str, Kind]:
    """Load what installed packages enter in a group, whose entries are all of one type.

    Raises
    ------
    InputError
        As :func:`plugins` does, and if an entry is of another type.
    """
    found: dict[str, Kind] = {}
    for name, entry in plugins(group).items():
        if not isinstance(entry, kind):
            raise InputError(
                "is of the wrong type",
                field=f"entry point {group}: {name}",
                value=entry,
                allowed=f"an instance of {kind.__module__}.{kind.__qualname__}",
                remedy="tell the makers of the package that enters it, or uninstall it",
            )
        found[name] = entry
    return found


def _loaded(point: EntryPoint) -> object:
    try:
        return point.load()
    except Exception as error:  # a foreign module can raise anything while it is imported
        raise InputError(
            f"cannot be loaded from package {_package(point)} ({type(error).__name__}: {error})",
            field=f"entry point {point.group}: {point.name}",
            value=point.value,
            remedy="update or uninstall that package",
        ) from error


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else "unknown"
