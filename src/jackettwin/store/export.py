"""Export of a store's tables as Parquet or an Arrow stream, in batches of rows."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal, get_args

from sqlalchemy import JSON, BigInteger, Boolean, Column, Engine, Float, Integer, LargeBinary, Table, select

from jackettwin.store import tables
from jackettwin.store.database import reading
from jackettwin.store.rights import Assets, among
from jackettwin.store.tables import Packed, Utc

if TYPE_CHECKING:
    import pyarrow as pa

Exported = Literal[
    "modes",
    "mode_days",
    "findings",
    "records",
    "observations",
    "states",
    "conditions",
    "knowledge",
    "versions",
    "assets",
    "work",
    "handling",
    "events",
    "packets",
    "windows",
    "alerts",
    "asset_groups",
    "audit",
    "posts",
    "servers",
    "settings",
    "tokens",
    "users",
]
"""Every table of a store; the first is requested most."""
EXPORTED: tuple[Exported, ...] = get_args(Exported)
ADMINS: frozenset[Exported] = frozenset(EXPORTED[EXPORTED.index("alerts") :])
"""Tables of who may and of the servers, which an admin alone may export; the rows of others have an asset."""
_SECRETS = {"users": ("password_hash",), "tokens": ("hash", "csrf")}
_ROWS = 5000
"""Number of rows in memory at once, and in a row group of the file."""


def exported(database: Engine, name: Exported, seen: Assets, *, arrow: bool = False) -> Iterator[bytes]:
    """Yield a table of the visible assets in pieces of a file.

    Parameters
    ----------
    name : of the table; times are UTC, nested values JSON; secrets and what is no text or number (bundles,
        pages, samples of packets) are omitted
    arrow : as a stream of Arrow (IPC) instead of a Parquet file
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = tables.metadata.tables[name]
    omitted = _SECRETS.get(name, ())
    columns = [c for c in table.columns if c.name not in omitted and not isinstance(c.type, LargeBinary)]
    schema = pa.schema([(c.name, _arrow_type(c)) for c in columns])
    sink = _Pieces()
    make = pa.ipc.new_stream if arrow else pq.ParquetWriter
    with reading(database) as connection, make(sink, schema) as writer:
        order = table.primary_key.columns
        query = select(*columns).order_by(*order)
        if name not in ADMINS:
            query = query.where(among(_asset_of(table), seen))
        found = connection.execute(query.execution_options(yield_per=_ROWS))
        for part in found.partitions():
            rows = [{k: _plain(v) for k, v in row._mapping.items()} for row in part]
            writer.write_table(pa.Table.from_pylist(rows, schema=schema))
            yield sink.taken()
    yield sink.taken()


class _Pieces(io.RawIOBase):
    """A file that is written sequentially and passed on in pieces."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []
        self._at = 0

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, piece: Any) -> int:
        """Write a piece."""
        self._pieces.append(bytes(piece))
        self._at += len(self._pieces[-1])
        return len(self._pieces[-1])

    def tell(self) -> int:
        """Return the number of bytes written."""
        return self._at

    def taken(self) -> bytes:
        """Return the bytes written since the last call."""
        pieces, self._pieces = self._pieces, []
        return b"".join(pieces)


def _asset_of(table: Table) -> Column[str]:
    return table.c.name if table.name == "assets" else table.c.asset


def _plain(value: Any) -> Any:
    return json.dumps(value, ensure_ascii=False) if isinstance(value, dict | list) else value


def _arrow_type(column: Column[Any]) -> pa.DataType:
    """Return the Arrow type of a column, which does not depend on its rows."""
    import pyarrow as pa

    kind = column.type
    if isinstance(kind, Utc):
        return pa.timestamp("us", tz="UTC")
    if isinstance(kind, Float):
        return pa.float64()
    if isinstance(kind, Boolean):
        return pa.bool_()
    if isinstance(kind, BigInteger | Integer):
        return pa.int64()
    assert isinstance(kind, JSON | Packed) or kind.python_type is str
    return pa.string()
