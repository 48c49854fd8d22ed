"""Backup of a whole store in one file: every table as lines of JSON, every waveform, one manifest.

The format is the same for SQLite and PostgreSQL, so that a backup of one can be restored into the other.
"""

from __future__ import annotations

import base64
import io
import json
import tarfile
import tempfile
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import Any

from sqlalchemy import (
    Connection,
    DateTime,
    Engine,
    LargeBinary,
    MetaData,
    Table,
    func,
    insert,
    select,
    text,
    type_coerce,
)

from jackettwin.errors import InputError
from jackettwin.files import atomic_path
from jackettwin.store import tables
from jackettwin.store.database import bring_to, check_schema, writing
from jackettwin.store.tables import SCHEMA_VERSION, Packed

_LEFT_OUT = ("servers", "alembic_version")
"""Tables without a backup: the list of servers, since leases are released after a restore, and the schema."""
_ROWS = 500
"""Number of rows that are inserted at once."""


def backup(database: Engine, store: Path, target: Path) -> dict[str, int]:
    """Write a store to a file, completely or not at all; return the number of rows of each table.

    Tables are read in one transaction, while the store may be served. Waveforms never change after writing,
    so that those in the tables are consistent.
    """
    counts: dict[str, int] = {}
    with (
        atomic_path(target, mode=0o600) as temporary,  # it contains hashes of passwords
        database.connect() as connection,
        tarfile.open(temporary, "w:gz") as out,
    ):
        if connection.dialect.name == "postgresql":
            connection.execution_options(isolation_level="REPEATABLE READ")
        for table in _tables():
            counts[table.name] = _add_table(out, connection, table)
        for place in connection.scalars(select(tables.records.c.waveform).execution_options(yield_per=_ROWS)):
            if place is not None and (store / place).exists():
                out.add(store / place, arcname=place, recursive=False)
        manifest = {"schema_version": SCHEMA_VERSION, "tables": counts}
        _add(out, "manifest.json", json.dumps(manifest).encode())
    return counts


def restore(source: Path, database: Engine, store: Path) -> dict[str, int]:
    """Fill an empty store from a backup, completely or not at all; return the number of rows of each table.

    Raises
    ------
    InputError
        If the file is not a backup, has another schema or is damaged, or the store is not empty.
    """
    counts: dict[str, int] = {}
    with writing(database) as connection:
        if connection.scalar(select(func.count()).select_from(tables.assets)):
            raise InputError(
                "the store is not empty", field="store", value=str(store), remedy="restore into a new folder"
            )
        try:
            with tarfile.open(source, "r:gz") as archive:
                schema = _schema(archive, source)
                bring_to(connection, schema)
                for table in _tables_of(connection):
                    counts[table.name] = _insert(connection, table, archive)
                bring_to(connection, SCHEMA_VERSION)
                for member in archive:
                    if member.name.startswith("records/"):
                        _extract(archive, member, store)
        except (tarfile.TarError, EOFError, OSError, KeyError, ValueError) as error:
            raise InputError(
                "not a complete backup", file=source, value=str(error)[:200], remedy="take another backup"
            ) from None
        _count_on(connection)
    return counts


def _tables() -> list[Table]:
    return [table for table in tables.metadata.sorted_tables if table.name not in _LEFT_OUT]


def _add_table(archive: tarfile.TarFile, connection: Connection, table: Table) -> int:
    """Write the rows of a table through a temporary file, since a table may not fit into memory."""
    count = 0
    with tempfile.TemporaryFile() as lines:
        for line in _lines(connection, table):
            lines.write(line)
            count += 1
        member = tarfile.TarInfo(f"tables/{table.name}.jsonl")
        member.size = lines.tell()
        lines.seek(0)
        archive.addfile(member, lines)
    return count


def _lines(connection: Connection, table: Table) -> Iterator[bytes]:
    stored = [type_coerce(c, LargeBinary).label(c.name) if isinstance(c.type, Packed) else c for c in table.c]
    rows = select(*stored).order_by(*table.primary_key.columns).execution_options(yield_per=_ROWS)
    for row in connection.execute(rows):
        plain = {name: _plain(value) for name, value in row._mapping.items()}
        yield json.dumps(plain, ensure_ascii=False).encode() + b"\n"


def _plain(value: Any) -> Any:
    if isinstance(value, datetime):
        return value.isoformat()
    return base64.b64encode(value).decode() if isinstance(value, bytes) else value


def _value(table: Table, name: str, plain: Any) -> Any:
    kind = table.c[name].type
    if plain is not None and isinstance(kind, DateTime):
        return datetime.fromisoformat(plain).astimezone(UTC).replace(tzinfo=None)
    return base64.b64decode(plain) if plain is not None and isinstance(kind, LargeBinary) else plain


def _add(archive: tarfile.TarFile, name: str, content: bytes) -> None:
    member = tarfile.TarInfo(name)
    member.size = len(content)
    archive.addfile(member, io.BytesIO(content))


def _schema(archive: tarfile.TarFile, source: Path) -> str:
    """Return the schema of a backup: that of this version, or an older one."""
    stream = archive.extractfile("manifest.json")
    manifest: Mapping[str, Any] = json.load(stream) if stream is not None else {}
    found = str(manifest.get("schema_version"))
    check_schema(found, "schema_version", source)
    return found


def _tables_of(connection: Connection) -> list[Table]:
    """Return the tables of the database, which may have an older schema."""
    there = MetaData()
    there.reflect(connection, only=lambda name, _: name not in _LEFT_OUT)
    return there.sorted_tables


def _insert(connection: Connection, table: Table, archive: tarfile.TarFile) -> int:
    stream = archive.extractfile(f"tables/{table.name}.jsonl")
    rows, count = (json.loads(line) for line in stream or ()), 0
    while part := [{k: _value(table, k, v) for k, v in row.items()} for row in islice(rows, _ROWS)]:
        connection.execute(insert(table), part)
        count += len(part)
    return count


def _extract(archive: tarfile.TarFile, member: tarfile.TarInfo, store: Path) -> None:
    """Write one waveform; raise an error on a name that leads outside the folder."""
    place = PurePosixPath(member.name)
    if not member.isfile() or place.is_absolute() or ".." in place.parts:
        raise ValueError(f"{member.name} does not belong in a backup")
    stream = archive.extractfile(member)
    assert stream is not None
    with atomic_path(store / place) as temporary:
        temporary.write_bytes(stream.read())


def _count_on(connection: Connection) -> None:
    """Set the database's counters of row numbers after the restored ones."""
    if connection.dialect.name != "postgresql":
        return
    for table in _tables():
        if "id" in table.c and table.c.id.primary_key:
            last = connection.scalar(select(func.max(table.c.id))) or 0
            sequence = f"select setval(pg_get_serial_sequence('{table.name}', 'id'), :last, :called)"
            connection.execute(text(sequence), {"last": max(last, 1), "called": last > 0})
