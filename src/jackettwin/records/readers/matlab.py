"""MATLAB files: version 5 through SciPy, version 7.3 as the HDF5 file it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.records.readers import hdf5
from jackettwin.records.readers.arrays import arrays_from_record, table_from_arrays

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jackettwin.records.readers.table import ReadTable
    from jackettwin.records.record import Record

HDF5_MARK = b"\x89HDF\r\n\x1a\n"


def read(path: Path) -> ReadTable:
    """Read arrays and fields of structs; MATLAB 7.3 files need the hdf5 extra."""
    with path.open("rb") as stream:
        stream.seek(512)  # 7.3 puts HDF5 behind a text block of this size
        if stream.read(8) == HDF5_MARK:
            return hdf5.read(path)
    from scipy import io  # a tenth of a second that few records need

    content = io.loadmat(path, chars_as_strings=True)
    arrays: dict[str, npt.NDArray[Any]] = {}
    for key, value in content.items():
        if not key.startswith("__"):
            arrays.update(_fields(key, np.asarray(value)))
    return table_from_arrays(arrays)


def write(record: Record, path: Path) -> None:
    """Write a version 5 file."""
    arrays = arrays_from_record(record)
    arrays["channel_names"] = np.array(record.channel_names, dtype=object)  # a cell array of texts
    from scipy import io  # a tenth of a second that few records need

    io.savemat(str(path), arrays, appendmat=False, do_compression=True)


def _fields(key: str, value: npt.NDArray[Any]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Yield an array, or the fields of a struct under dotted names."""
    if value.dtype.names is None:
        yield key, value
    elif value.size == 1:
        for name in value.dtype.names:
            yield from _fields(f"{key}.{name}", np.asarray(value.ravel()[0][name]))
