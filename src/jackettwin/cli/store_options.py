"""Options that every command on a store shares."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from jackettwin.errors import InputError, MissingExtra

if TYPE_CHECKING:
    from sqlalchemy import Engine

F = TypeVar("F", bound=Callable[..., Any])


database_option = click.option(
    "--database", envvar="JACKETTWIN_DATABASE", help="URL of PostgreSQL; default: SQLite in the store."
)
"""Where the database of a store is, if not in it."""


def store_options(function: F) -> F:
    """Add ``--store`` and ``--database``."""
    function = database_option(function)
    return click.option(
        "--store",
        required=True,
        envvar="JACKETTWIN_STORE",
        type=click.Path(path_type=Path, file_okay=False),
        help="Folder of the living twin.",
    )(function)


def opened(store: Path, database: str | None, *, make: bool = False) -> Engine:
    """Return the database of a store.

    Raises
    ------
    InputError
        If there is no store.
    """
    needs_service()
    if not make and not store.is_dir():
        raise InputError(
            "there is no store",
            field="store",
            value=str(store),
            remedy="begin with `jackettwin asset add NAME TWIN --store STORE` or `jackettwin serve STORE`",
        )
    from jackettwin.store import open_database, sqlite_url

    store.mkdir(parents=True, exist_ok=True)
    return open_database(database or sqlite_url(store))


def needs_service() -> None:
    """Refuse to go on without the extra ``service``."""
    for library in ("distributed", "fastapi", "sqlalchemy"):  # none is read: that takes a second
        if find_spec(library) is None:
            raise MissingExtra(f"the living twin needs {library}", remedy="pip install 'jackettwin[service]'")
