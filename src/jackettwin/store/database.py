"""Opening of a store's database, SQLite in its folder or PostgreSQL, with migration if it is older."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, Table, create_engine, event, inspect, make_url, text
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import ArgumentError, NoSuchModuleError, OperationalError

from jackettwin.errors import InputError, require
from jackettwin.store.tables import FIRST_SCHEMA, SCHEMA_VERSION

_BUSY_S = 30.0
"""Time that a writer of SQLite waits for another one [s]."""
_POOL = {"pool_size": 16, "max_overflow": 32}
"""Numbers of connections, enough for all threads."""
_MIGRATIONS = Path(__file__).with_name("migrations")


def sqlite_url(store: Path) -> str:
    """Return the URL of the database in a store's folder."""
    return f"sqlite:///{store / 'jackettwin.sqlite'}"


def private_folder(folder: Path) -> None:
    """Create the folder of a store with access for its owner only, or restrict an existing one."""
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700, parents=True)
        return
    is_store = any((folder / known).exists() for known in ("jackettwin.sqlite", "models"))
    if is_store and folder.stat().st_mode & 0o077:
        with suppress(PermissionError):  # the folder has another owner, who gave access
            folder.chmod(0o700)


def private_file(path: Path) -> None:
    """Create a file with access for its owner only, or restrict an existing one, for secrets."""
    path.touch(mode=0o600)
    if path.stat().st_mode & 0o077:
        with suppress(PermissionError):
            path.chmod(0o600)


def open_database(url: str, *, migrate: bool = True) -> Engine:
    """Return an engine on the database, migrated to the newest schema.

    Raises
    ------
    InputError
        If the URL is not of SQLite or PostgreSQL, the server does not answer, or its schema is newer or older
        than 0.1.0.
    """
    try:
        parsed = make_url(url)
        if parsed.get_backend_name() == "sqlite":
            engine = _sqlite(url)
        else:
            engine = create_engine(url, **_POOL, pool_pre_ping=True)
        with engine.connect() as connection:
            connection.execute(text("select 1"))
    except (ArgumentError, NoSuchModuleError, ModuleNotFoundError, OperationalError) as error:
        raise InputError(
            "the database cannot be opened",
            field="database",
            value=_without_password(url),
            allowed="sqlite:///FILE or postgresql+psycopg://USER@HOST/NAME",
            remedy=f"check that it runs and can be reached ({str(error).splitlines()[0][:200]})",
        ) from None
    try:
        if migrate:
            _migrate(engine, url)
    except BaseException:
        engine.dispose()
        raise
    return engine


@contextmanager
def writing(engine: Engine) -> Iterator[Connection]:
    """Yield a connection in a writing transaction, which is committed as a whole or not at all.

    SQLite locks at once, since a reader that starts to write later may be refused.
    """
    with engine.execution_options(writes=True).begin() as connection:
        yield connection


@contextmanager
def reading(engine: Engine) -> Iterator[Connection]:
    """Yield a connection with a snapshot of the database."""
    with engine.connect() as connection:
        yield connection


def insert_new(connection: Connection, table: Table, row: Mapping[str, Any]) -> bool:
    """Insert a row unless its key exists; return whether it is new, also with concurrent writers."""
    dialect = postgresql if connection.dialect.name == "postgresql" else sqlite
    new = dialect.insert(table).values(**row).on_conflict_do_nothing()
    # drivers give no count of rows if the database assigns the row's number
    return connection.execute(new.returning(*table.primary_key.columns)).first() is not None


def _sqlite(url: str) -> Engine:
    name = make_url(url).database
    if name and name != ":memory:":
        with suppress(OSError):  # the database reports errors of its path
            private_file(Path(name))  # SQLite's further files have the same access
    engine = create_engine(url, connect_args={"timeout": _BUSY_S}, **_POOL)

    @event.listens_for(engine, "connect")
    def _prepare(connection: sqlite3.Connection, _: Any) -> None:
        connection.isolation_level = None  # transactions are begun explicitly
        for pragma in ("journal_mode=WAL", "synchronous=FULL", "foreign_keys=ON"):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        writes = connection.get_execution_options().get("writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


def _migrate(engine: Engine, url: str) -> None:
    """Migrate the schema after a copy, only once if several servers start."""
    with engine.connect() as connection:
        current = _schema(connection)
    if current == SCHEMA_VERSION:
        return
    if current is not None:
        check_schema(current, "schema version")
    with writing(engine) as connection:
        if engine.dialect.name == "postgresql":
            connection.execute(text("select pg_advisory_xact_lock(740113)"))
        current = _schema(connection)
        if current == SCHEMA_VERSION:  # another server has migrated it
            return
        if current is not None:
            _copy(connection, url, current)
        bring_to(connection, SCHEMA_VERSION)


def _schema(connection: Connection) -> str | None:
    """Return the newest migration of a database, without importing Alembic."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.scalar(text("select version_num from alembic_version"))
    return found


def check_schema(found: str, field: str, file: Path | None = None) -> None:
    """Raise an error on a schema that this version cannot migrate.

    Raises
    ------
    InputError
        If a version before 0.1.0 made it, or a later version than this one.
    """
    known = f"{FIRST_SCHEMA} to {SCHEMA_VERSION}"
    require(
        found >= FIRST_SCHEMA,
        "made by a version before 0.1.0, whose stores no release can open",
        file=file,
        field=field,
        value=found,
        allowed=known,
        remedy="create a new store with `jackettwin asset add`; carry the records over with `jackettwin "
        "intake OLD/records/NAME --asset NAME --store NEW`; a backup is a tar file that contains the same "
        "folder",
    )
    require(
        found <= SCHEMA_VERSION,
        "written by a newer version",
        file=file,
        field=field,
        value=found,
        allowed=known,
        remedy="install the newer jackettwin, or restore a backup of this one",
    )


def bring_to(connection: Connection, schema: str) -> None:
    """Migrate the tables to a newer or older schema within the transaction."""
    current = _schema(connection)
    if current == schema:
        return
    from alembic import command
    from alembic.config import Config

    config = Config()
    config.set_main_option("script_location", str(_MIGRATIONS))
    config.attributes["connection"] = connection
    move = command.upgrade if current is None or current < schema else command.downgrade
    move(config, schema)


def _copy(connection: Connection, url: str, version: str) -> None:
    """Copy the database: to a file next to SQLite's, or to a separate schema in PostgreSQL."""
    if connection.dialect.name == "sqlite":
        path = Path(str(make_url(url).database))
        target = path.with_name(f"{path.stem}.schema-{version}{path.suffix}")
        private_file(target)
        with closing(sqlite3.connect(path)) as source, closing(sqlite3.connect(target)) as copy:
            source.backup(copy)
        return
    schema = f"schema_{version}"
    names = inspect(connection).get_table_names()
    connection.execute(text(f"drop schema if exists {schema} cascade"))
    connection.execute(text(f"create schema {schema}"))
    for name in names:
        connection.execute(text(f'create table {schema}."{name}" as table "{name}"'))


def _without_password(url: str) -> str:
    try:
        return make_url(url).render_as_string(hide_password=True)
    except ArgumentError:
        return url
