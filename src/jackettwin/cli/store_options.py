"""Options that every command on a store shares."""

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
"""Where the database of a store is, if not in it."""


@dataclass(frozen=True)
class StorePlace:
    """The folder of a living twin, and the URL of its database if that is elsewhere."""

    folder: Path
    database: str | None

    def open(self, *, make: bool = False) -> Engine:
        """Return the database.

        Raises
        ------
        InputError
            If there is no store, and none is to be made.
        """
        needs_service()
        require(
            make or self.folder.is_dir(),
            "there is no store",
            field="store",
            value=str(self.folder),
            remedy="begin with `jackettwin asset add NAME TWIN --store STORE` or `jackettwin serve STORE`",
        )
        from jackettwin.store import open_database, private_folder, sqlite_url

        private_folder(self.folder)
        return open_database(self.database or sqlite_url(self.folder))


def store_options(function: Callable[..., R]) -> Callable[..., R]:
    """Add ``--store`` and ``--database``, and hand them over as the argument ``at``."""

    @wraps(function)
    def command(*args: Any, store: Path, database: str | None, **kwargs: Any) -> R:
        return function(*args, **kwargs, at=StorePlace(store, database))

    return click.option(
        "--store",
        required=True,
        envvar="JACKETTWIN_STORE",
        type=click.Path(path_type=Path, file_okay=False),
        help="Folder of the living twin.",
    )(database_option(command))


def needs_service() -> None:
    """Refuse to go on without the extra ``service``."""
    for library in ("distributed", "fastapi", "sqlalchemy"):  # none is read: that takes a second
        if find_spec(library) is None:
            raise MissingExtra(f"the living twin needs {library}", remedy="pip install 'jackettwin[service]'")
