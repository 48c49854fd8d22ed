"""Open the database of a store: SQLite in its folder, or PostgreSQL; migrate it if it is older."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from sqlalchemy import Connection, Engine, create_engine, event, make_url, text
from sqlalchemy.exc import ArgumentError, NoSuchModuleError, OperationalError

from jackettwin.errors import InputError
from jackettwin.store.tables import SCHEMA_VERSION

_BUSY_S = 30.0
"""How long a writer of SQLite waits for another one."""
_MIGRATIONS = Path(__file__).with_name("migrations")


def sqlite_url(store: Path) -> str:
    """Return the URL of the database that lives in a store's folder."""
    return f"sqlite:///{store / 'jackettwin.sqlite'}"


def open_database(url: str, *, migrate: bool = True) -> Engine:
    """Return an engine on the database, brought to the newest schema.

    Raises
    ------
    InputError
        If the URL is not of SQLite or PostgreSQL, the server does not answer, or its schema is newer.
    """
    try:
        parsed = make_url(url)
        if parsed.get_backend_name() == "sqlite":
            engine = _sqlite(url)
        else:
            engine = create_engine(url, pool_size=8, max_overflow=24, pool_pre_ping=True)
        with engine.connect() as connection:
            connection.execute(text("select 1"))
    except (ArgumentError, NoSuchModuleError, ModuleNotFoundError, OperationalError) as error:
        raise InputError(
            "the database cannot be opened",
            field="database",
            value=_without_password(url),
            allowed="sqlite:///FILE or postgresql+psycopg://USER@HOST/NAME",
            remedy=f"see that it runs and may be reached ({str(error).splitlines()[0][:200]})",
        ) from None
    if migrate:
        _migrate(engine, url)
    return engine


@contextmanager
def writing(engine: Engine) -> Iterator[Connection]:
    """Give a connection in a transaction that writes: all of it is kept, or nothing.

    SQLite takes its lock at once, since a reader that turns writer half-way may be refused.
    """
    with engine.execution_options(writes=True).begin() as connection:
        yield connection


@contextmanager
def reading(engine: Engine) -> Iterator[Connection]:
    """Give a connection that sees the database as it was at one moment."""
    with engine.connect() as connection:
        yield connection


def _sqlite(url: str) -> Engine:
    engine = create_engine(url, connect_args={"timeout": _BUSY_S}, pool_size=8, max_overflow=24)

    @event.listens_for(engine, "connect")
    def _prepare(connection: sqlite3.Connection, _: Any) -> None:
        connection.isolation_level = None  # transactions begin where we say so
        for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        writes = connection.get_execution_options().get("writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


def _migrate(engine: Engine, url: str) -> None:
    """Bring the schema up to date; a SQLite file of an older schema is copied beside itself before."""
    with engine.connect() as connection:
        current = MigrationContext.configure(connection).get_current_revision()
    if current == SCHEMA_VERSION:
        return
    if current is not None and current > SCHEMA_VERSION:
        raise InputError(
            "the database was written by a newer version",
            field="schema version",
            value=current,
            allowed=f"up to {SCHEMA_VERSION}",
            remedy="install the newer jackettwin, or restore a backup of this one",
        )
    if current is not None and engine.dialect.name == "sqlite":
        _copy_sqlite(Path(str(make_url(url).database)), current)
    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS))
    with engine.connect() as connection:
        if engine.dialect.name == "postgresql":  # two servers starting at once migrate one after the other
            connection.execute(text("select pg_advisory_lock(740113)"))
        try:
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
            connection.commit()
        finally:
            if engine.dialect.name == "postgresql":
                connection.execute(text("select pg_advisory_unlock(740113)"))
                connection.commit()


def _copy_sqlite(path: Path, version: str) -> None:
    """Copy a database whole, whatever is being written to it."""
    target = path.with_name(f"{path.stem}.schema-{version}{path.suffix}")
    with sqlite3.connect(path) as source, sqlite3.connect(target) as copy:
        source.backup(copy)


def _without_password(url: str) -> str:
    try:
        return make_url(url).render_as_string(hide_password=True)
    except ArgumentError:
        return url
