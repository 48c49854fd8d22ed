"""Options of all commands on a store."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from jackettwin.errors import MissingExtra, require

if TYPE_CHECKING:
    from sqlalchemy import Engine

R = TypeVar("R")

database_option = click.option(
    "--database", envvar="JACKETTWIN_DATABASE", help="URL of PostgreSQL; default: SQLite in the store."
)
"""Option for a database outside the store."""


@dataclass(frozen=True)
class StorePlace:
    """Folder of a store, and the URL of its database if that is elsewhere."""

    folder: Path
    database: str | None

    def open(self, *, make: bool = False) -> Engine:
        """Return the database.

        Raises
        ------
        InputError
            If there is no store, and ``make`` is false.
        """
        needs_service()
        require(
            make or self.folder.is_dir(),
            "there is no store",
            field="store",
            value=str(self.folder),
            remedy="create it by `jackettwin asset add NAME TWIN --store STORE` or `jackettwin serve STORE`",
        )
        from jackettwin.store import open_database, private_folder, sqlite_url

        private_folder(self.folder)
        return open_database(self.database or sqlite_url(self.folder))


def store_options(function: Callable[..., R]) -> Callable[..., R]:
    """Add ``--store`` and ``--database``, and pass them as the argument ``at``."""

    @wraps(function)
    def command(*args: Any, store: Path, database: str | None, **kwargs: Any) -> R:
        return function(*args, **kwargs, at=StorePlace(store, database))

    return click.option(
        "--store",
        required=True,
        envvar="JACKETTWIN_STORE",
        type=click.Path(path_type=Path, file_okay=False),
        help="Folder of the store.",
    )(database_option(command))


def needs_service() -> None:
    """Raise an error if the extra ``service`` is not installed."""
    for library in ("distributed", "fastapi", "sqlalchemy"):  # none is imported, which would take a second
        if find_spec(library) is None:
            raise MissingExtra(f"the living twin needs {library}", remedy="pip install 'jackettwin[service]'")
