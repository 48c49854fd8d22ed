"""NumPy files: archives of named arrays, and single arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jackettwin.records.readers.arrays import arrays_from_record, table_from_arrays

if TYPE_CHECKING:
    from pathlib import Path

    from jackettwin.records.readers.table import ReadTable
    from jackettwin.records.record import Record


def read(path: Path) -> ReadTable:
    """Read the archive; pickled objects are refused."""
    # np.load leaves a file open that it opened itself and could not read.
    with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
        return table_from_arrays({key: archive[key] for key in archive.files})


def read_single(path: Path) -> ReadTable:
    """Read a single array: a matrix of channels, a vector, or the named fields of a structured array."""
    with path.open("rb") as stream:
        array = np.load(stream, allow_pickle=False)
    if array.dtype.names:
        return table_from_arrays({name: array[name] for name in array.dtype.names})
    return table_from_arrays({"channel": array})


def write(record: Record, path: Path) -> None:
    """Write data, rate, names and the description."""
    with path.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays_from_record(record))
