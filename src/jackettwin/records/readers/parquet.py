"""Parquet: one column a channel, described by the JSON beside it.

The records that are shipped hold second differences of single-precision numbers, which take a fifth less room
and give back every bit: see :func:`restored`.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from jackettwin.records.readers.table import ReadTable, table_from_columns

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jackettwin.records.record import Record

ROWS = 32_768
"""Rows of a table when a file is read in pieces: a few megabytes."""
BUFFER_BYTES = 1 << 20
"""Read ahead of each column [bytes]."""
ENCODING = b"jackettwin.second_differences"
"""Key of a schema whose columns are second differences (*scripts/pack_records*)."""
MAGNITUDE = np.int32(0x7FFFFFFF)
"""All bits of a number but its sign."""


def read(path: Path) -> ReadTable:
    """Read every column; nulls are missing samples."""
    with pq.ParquetFile(path) as file:
        return _table(file.read())


def pieces(path: Path) -> Iterator[ReadTable]:
    """Yield the columns in tables of ``ROWS`` rows."""
    with pq.ParquetFile(path, pre_buffer=False, buffer_size=BUFFER_BYTES) as file:
        if ENCODING in (file.schema_arrow.metadata or {}):  # a difference needs all that is before it
            whole = _table(file.read())
            for start in range(0, whole.data.shape[1], ROWS):
                yield replace(whole, data=whole.data[:, start : start + ROWS])
            return
        for batch in file.iter_batches(batch_size=ROWS):
            yield _table(pa.Table.from_batches([batch]))


def write(record: Record, path: Path) -> None:
    """Write one float64 column a channel; missing samples as NaN."""
    columns = {channel.name: row for channel, row in zip(record.channels, record.data, strict=True)}
    pq.write_table(pa.table(columns), path)


def restored(stored: npt.NDArray[np.int32]) -> npt.NDArray[np.float32]:
    """Return single-precision numbers from their second differences, every bit of them.

    *scripts/pack_records* takes the differences of the bits, modulo 2³², with their sign in the lowest bit.
    """
    code = stored.view(np.uint32)
    second = (code >> np.uint32(1)) ^ (np.uint32(0) - (code & np.uint32(1)))
    ordered = np.cumsum(np.cumsum(second, dtype=np.uint32), dtype=np.uint32).view(np.int32)
    return np.where(ordered < 0, ordered ^ MAGNITUDE, ordered).view(np.float32)


def _table(stored: Any) -> ReadTable:
    # pandas calls an index without a name like this
    names = ["" if re.fullmatch(r"__index_level_\d+__", name) else name for name in stored.column_names]
    zoned = any(pa.types.is_timestamp(field.type) and field.type.tz is not None for field in stored.schema)
    known: dict[str, Any] = {"zone_said": True} if zoned else {}
    packed = ENCODING in (stored.schema.metadata or {})
    columns = (stored.column(i) for i in range(len(names)))
    values = [
        restored(_array(c.combine_chunks())).astype(np.float64) if packed else _values(c) for c in columns
    ]
    return table_from_columns(names, values, **known)


def _values(column: Any) -> npt.NDArray[Any]:
    if pa.types.is_timestamp(column.type):
        stamps: npt.NDArray[Any] = column.cast(pa.timestamp("ns")).to_numpy().astype("datetime64[ns]")
        return stamps
    if not (pa.types.is_floating(column.type) or pa.types.is_integer(column.type)):
        return np.full(len(column), "")  # not a signal
    if not column.null_count:
        return np.from_dlpack(column.combine_chunks()).astype(np.float64)
    numbers = column.cast(pa.float64(), safe=False).combine_chunks()  # loads pyarrow.compute
    return _array(numbers.fill_null(np.nan) if numbers.null_count else numbers)


def _array(numbers: Any) -> npt.NDArray[Any]:
    # ``to_numpy``, like ``read_table`` and a scalar to fill with, loads pandas: 0.2 s in every process
    return np.from_dlpack(numbers)
