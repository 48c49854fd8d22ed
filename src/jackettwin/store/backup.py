"""Backup of a whole store in one file: every table as lines of JSON, every waveform, one manifest.

The format is the same for SQLite and PostgreSQL, so that one restores into the other. A backup
since an earlier one leaves out what that one has of what is large: waveforms, and the observations of days
that have not changed. What there is in all stands in ``contents.txt``, in order, at the head of each.
"""

from __future__ import annotations

import base64
import io
import json
import tarfile
import tempfile
from collections.abc import Iterator, Mapping, Sequence, Set
from datetime import UTC, datetime
from itertools import groupby, islice
from pathlib import Path, PurePosixPath
from typing import IO, Any

from sqlalchemy import (
    Column,
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
from jackettwin.store.backup_chain import CONTENTS, checked_chain, earlier_contents, identity_of, lines_not_in
from jackettwin.store.database import bring_to, check_schema, writing
from jackettwin.store.tables import SCHEMA_VERSION, Packed

_LEFT_OUT = ("servers", "alembic_version")
"""Tables without a backup: the list of servers, since leases are released after a restore, and the schema."""
_DAY, _WAVEFORM = b"o\t", b"w\t"
"""Prefixes of lines of the contents: a day of observations with its hash, a waveform."""
_ROWS = 500
"""Number of rows that are inserted at once."""


def backup(database: Engine, store: Path, target: Path, since: Path | None = None) -> dict[str, int]:
    """Write a store to a file, completely or not at all; return the number of rows of each table.

    Tables are read in one transaction, while the store may be served. Waveforms never change after writing,
    so that those in the tables are consistent. No table is in memory as a whole.

    Parameters
    ----------
    since : an earlier backup, which is needed, too, to restore this one

    Raises
    ------
    InputError
        If the earlier file is no backup that another one can follow.
    """
    counts: dict[str, int] = {}
    with (
        atomic_path(target, mode=0o600) as temporary,  # it contains hashes of passwords
        database.connect() as connection,
        tarfile.open(temporary, "w:gz", compresslevel=6) as out,
        tempfile.TemporaryFile() as contents,
        tempfile.TemporaryFile() as new,
    ):
        if connection.dialect.name == "postgresql":
            connection.execution_options(isolation_level="REPEATABLE READ")
        contents.writelines(_contents(connection))
        _add_stream(out, CONTENTS, contents)
        contents.seek(0)
        identity = identity_of(contents)
        contents.seek(0)
        with earlier_contents(since) as (before, of):
            new.writelines(lines_not_in(contents, before))
        new.seek(0)
        days = {line.split(b"\t")[1].decode() for line in new if line.startswith(_DAY)}
        for table in _tables():
            only = days if table is tables.observations else None
            counts[table.name] = _add_table(out, connection, table, only)
        new.seek(0)
        for line in new:
            place = line.rstrip(b"\n").split(b"\t")[1].decode()
            if line.startswith(_WAVEFORM) and (store / place).exists():
                out.add(store / place, arcname=place, recursive=False)
        manifest = {"schema_version": SCHEMA_VERSION, "tables": counts, "contents": identity, "since": of}
        _add(out, "manifest.json", json.dumps(manifest).encode())
    return counts


def restore(source: Path, database: Engine, store: Path, earlier: Sequence[Path] = ()) -> dict[str, int]:
    """Fill an empty store from a backup, completely or not at all; return the number of rows of each table.

    Parameters
    ----------
    earlier : the backups that it follows, oldest first, the first of them a whole one

    Raises
    ------
    InputError
        If the file is no backup, of another schema, damaged, does not follow the earlier ones, or the store
        holds something already.
    """
    counts: dict[str, int] = {}
    with writing(database) as connection:
        if connection.scalar(select(func.count()).select_from(tables.assets)):
            raise InputError(
                "the store is not empty", field="store", value=str(store), remedy="restore into a new folder"
            )
        try:
            days = checked_chain([*earlier, source])
            with tarfile.open(source, "r:gz") as archive:
                schema = _schema(archive, source)
                bring_to(connection, schema)
                for table in _tables_of(connection):
                    counts[table.name] = _insert(connection, table, archive, days.get(source))
                seen = tables.observations.name
                for file in earlier:
                    with tarfile.open(file, "r:gz") as older:
                        observations = next(t for t in _tables_of(connection) if t.name == seen)
                        counts[seen] += _insert(connection, observations, older, days[file])
                bring_to(connection, SCHEMA_VERSION)
                _extract_all(archive, connection, store)
            for file in earlier:
                with tarfile.open(file, "r:gz") as older:
                    _extract_all(older, connection, store)
        except (tarfile.TarError, EOFError, OSError, KeyError, ValueError) as error:
            raise InputError(
                "not a complete backup", file=source, value=str(error)[:200], remedy="take another backup"
            ) from None
        _count_on(connection)
    return counts


def _tables() -> list[Table]:
    return [table for table in tables.metadata.sorted_tables if table.name not in _LEFT_OUT]


def _contents(connection: Connection) -> Iterator[bytes]:
    """Yield what is large, a line each, in order: days of observations with their hash, then waveforms."""
    lines = _lines(connection, tables.observations, (*_DAY_KEY, tables.observations.c.record_id))
    days = []
    for day, of_day in groupby(lines, lambda found: found[0]):
        days.append(_DAY + f"{day}\t{identity_of(line for _, line in of_day)}\n".encode())
    yield from sorted(days)
    kept = tables.records.c.waveform
    in_order = kept.collate("C") if connection.dialect.name == "postgresql" else kept  # as bytes are
    places = select(kept).where(kept.is_not(None)).order_by(in_order).execution_options(yield_per=_ROWS)
    for place in connection.scalars(places):
        yield _WAVEFORM + f"{place}\n".encode()


_DAY_KEY = (
    tables.observations.c.asset,
    tables.observations.c.model_hash,
    tables.observations.c.start_utc,
)


def _day_of(row: Mapping[str, Any]) -> str:
    """Return which day of whom an observation is of, under which model."""
    return f"{row['asset']} {row['model_hash']} {row['start_utc'][:10]}"


def _add_table(archive: tarfile.TarFile, connection: Connection, table: Table, only: Set[str] | None) -> int:
    """Write the rows of a table by way of a file of their own; of observations those of some days."""
    with tempfile.TemporaryFile() as lines:
        count = 0
        for day, line in _lines(connection, table, tuple(table.primary_key.columns)):
            if only is None or day in only:
                lines.write(line)
                count += 1
        _add_stream(archive, f"tables/{table.name}.jsonl", lines)
    return count


def _add_stream(archive: tarfile.TarFile, name: str, stream: IO[bytes]) -> None:
    member = tarfile.TarInfo(name)
    member.size = stream.tell()
    stream.seek(0)
    archive.addfile(member, stream)


def _lines(
    connection: Connection, table: Table, order: tuple[Column[Any], ...]
) -> Iterator[tuple[str, bytes]]:
    """Yield the rows of a table as lines, each with the day that it is of if they are observations."""
    stored = [type_coerce(c, LargeBinary).label(c.name) if isinstance(c.type, Packed) else c for c in table.c]
    rows = select(*stored).order_by(*order).execution_options(yield_per=_ROWS)
    for row in connection.execute(rows):
        plain = {name: plain_value(value) for name, value in row._mapping.items()}
        day = _day_of(plain) if table is tables.observations else ""
        yield day, json.dumps(plain, ensure_ascii=False).encode() + b"\n"


def plain_value(value: Any) -> Any:
    """Return a stored value as JSON has it: times as text, bytes in base64."""
    if isinstance(value, datetime):
        return value.isoformat()
    return base64.b64encode(value).decode() if isinstance(value, bytes) else value


def stored_value(column: Column[Any], plain: Any) -> Any:
    """Return a value for a column from what :func:`plain_value` made of it."""
    if plain is None:
        return None
    if isinstance(column.type, tables.Utc):
        return datetime.fromisoformat(plain)
    if isinstance(column.type, DateTime):  # of a table as the database describes it, which knows no zones
        return datetime.fromisoformat(plain).astimezone(UTC).replace(tzinfo=None)
    return base64.b64decode(plain) if isinstance(column.type, LargeBinary) else plain


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


def _insert(connection: Connection, table: Table, archive: tarfile.TarFile, days: Set[str] | None) -> int:
    """Insert the rows of a table; of observations those of some days, None for all."""
    stream = archive.extractfile(f"tables/{table.name}.jsonl")
    rows, count = (json.loads(line) for line in stream or ()), 0
    if table.name == tables.observations.name and days is not None:
        rows = (row for row in rows if _day_of(row) in days)
    while part := [{k: stored_value(table.c[k], v) for k, v in row.items()} for row in islice(rows, _ROWS)]:
        connection.execute(insert(table), part)
        count += len(part)
    return count


def _extract_all(archive: tarfile.TarFile, connection: Connection, store: Path) -> None:
    """Write the waveforms that a restored record names, each once."""
    for member in archive:
        if member.name.startswith("records/"):
            number = PurePosixPath(member.name).stem
            named = select(tables.records.c.waveform).where(tables.records.c.record_id == number)
            if member.name in connection.scalars(named).all() and not (store / member.name).exists():
                _extract(archive, member, store)


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
