"""Copy of one asset with what is known of it, without samples: a compressed file for another store."""

from __future__ import annotations

import json
import lzma
from typing import Any

from sqlalchemy import Column, Connection, Table, insert, select

from jackettwin.store import tables
from jackettwin.store.backup import plain_value, stored_value

_TABLES = (
    tables.assets,
    tables.versions,
    tables.records,
    tables.observations,
    tables.modes,
    tables.states,
    tables.knowledge,
    tables.findings,
)
"""Tables in the order of their references. Jobs, events and what people did belong to a store."""


Rows = dict[str, list[dict[str, Any]]]


_MADE = ("id", "frequency_relative_std")
"""Columns that a store makes: the number of a row, and what follows from others."""


def copy_out(connection: Connection, asset: str) -> Rows:
    """Return the rows of an asset by table."""
    found = {}
    for table in _TABLES:
        mine = table.c.name if table is tables.assets else table.c.asset
        query = select(*_columns(table)).where(mine == asset).order_by(*table.primary_key.columns)
        found[table.name] = [dict(row._mapping) for row in connection.execute(query)]
    return found


def write_copy(rows: Rows) -> bytes:
    """Return rows as compressed lines of JSON, the same bytes for the same rows."""
    lines = [json.dumps([name, *map(plain_value, row.values())]) for name in rows for row in rows[name]]
    return lzma.compress("\n".join(lines).encode(), preset=9)


def read_copy(copy: bytes) -> Rows:
    """Return the rows of a copy."""
    found: Rows = {}
    for line in lzma.decompress(copy).decode().splitlines():
        name, *values = json.loads(line)
        columns = _columns(tables.metadata.tables[name])
        row = {c.name: stored_value(c, value) for c, value in zip(columns, values, strict=True)}
        found.setdefault(name, []).append(row)
    return found


def copy_in(connection: Connection, rows: Rows) -> None:
    """Insert the rows of a copy, whose asset the store does not have."""
    for table in _TABLES:
        if of_table := rows.get(table.name):
            connection.execute(insert(table), of_table)


def _columns(table: Table) -> list[Column[Any]]:
    """Return the columns but those that a store makes."""
    return [column for column in table.c if column.name not in _MADE]
