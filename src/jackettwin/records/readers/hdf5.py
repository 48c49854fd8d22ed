"""HDF5 (and MATLAB 7.3, which is HDF5): datasets and attributes by the rules of named arrays.

A dataset's attribute ``unit``, ``units`` or ``unit_string`` is its unit; scalar attributes of the file, of a
group or of a dataset (the rate, the start) count as named scalars.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError, MissingExtra
from jackettwin.records.readers.arrays import STEP_KEYS, arrays_from_record, table_from_arrays
from jackettwin.records.readers.delimited import RATE_KEYS

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jackettwin.records.readers.table import ReadTable
    from jackettwin.records.record import Record

UNIT_KEYS = ("unit", "units", "unit_string")
ROWS = 32_768
"""Rows of a table when a file is read in pieces."""
MOST_COMPRESSION = 1000
"""A damaged header announces any size; what deflate cannot have packed into the file is refused."""


def read(path: Path) -> ReadTable:
    """Read every dataset.

    Raises
    ------
    MissingExtra
        If h5py is not installed.
    """
    h5py = _h5py()
    with h5py.File(path, "r") as file:
        arrays, units = _collected(h5py, file, None)
    return table_from_arrays(arrays, units)


def pieces(path: Path) -> Iterator[ReadTable]:
    """Yield tables of ``ROWS`` rows: of every dataset as long as the longest only these are read.

    Raises
    ------
    MissingExtra
        If h5py is not installed.
    """
    h5py = _h5py()
    with h5py.File(path, "r") as file:
        sizes: list[int] = []
        file.visititems(lambda _, item: sizes.extend(getattr(item, "shape", ())))
        length = max(sizes, default=1)
        # even parts: a short last one could have fewer rows than there are channels
        edges = np.linspace(0, length, -(-length // ROWS) + 1).astype(int).tolist()
        for start, stop in pairwise(edges):
            yield table_from_arrays(*_collected(h5py, file, _Window(length, start, stop)))


@dataclass(frozen=True)
class _Window:
    """Rows ``start`` to ``stop`` of the datasets that have ``length`` of them."""

    length: int
    start: int
    stop: int

    def of(self, item: Any) -> Any:
        """Return these rows of a dataset; a shorter one whole."""
        if self.length not in item.shape:
            return item[()]
        axis = item.shape.index(self.length)
        return item[(slice(None),) * axis + (slice(self.start, self.stop),)]


def _collected(
    h5py: Any, file: Any, window: _Window | None
) -> tuple[dict[str, npt.NDArray[Any]], dict[str, str]]:
    """Return every dataset and scalar attribute by name, and the units of datasets."""
    arrays: dict[str, npt.NDArray[Any]] = {}
    units: dict[str, str] = {}

    def collect(name: str, item: Any) -> None:
        if name.startswith("#"):  # MATLAB's own bookkeeping
            return
        for key, value in item.attrs.items():
            if isinstance(item, h5py.Dataset) and key in UNIT_KEYS:
                units[name] = str(_array(value).ravel()[0])
            elif isinstance(item, h5py.Group) or key.lower() in (*RATE_KEYS, *STEP_KEYS):
                arrays[f"{name}.{key}".lstrip(".")] = _array(value)
        if isinstance(item, h5py.Dataset):
            arrays[name] = _dataset(h5py, item, window)

    collect("", file)
    file.visititems(collect)
    return arrays, units


def write(record: Record, path: Path) -> None:
    """Write the named arrays as datasets.

    Raises
    ------
    MissingExtra
        If h5py is not installed.
    """
    h5py = _h5py()
    with h5py.File(path, "w") as file:
        for key, value in arrays_from_record(record).items():
            # texts of fixed length: readable everywhere, and no heap that damage could blow up
            file[key] = np.char.encode(value, "utf-8") if value.dtype.kind == "U" else value


def _h5py() -> Any:
    try:
        return import_module("h5py")
    except ImportError:
        raise MissingExtra(
            "needs the optional package h5py", remedy="pip install 'jackettwin[hdf5]'"
        ) from None


def _dataset(h5py: Any, item: Any, window: _Window | None) -> npt.NDArray[Any]:
    if item.dtype.itemsize * item.size > MOST_COMPRESSION * item.file.id.get_filesize():
        raise InputError(
            "announces more data than the file can hold",
            field=item.name,
            value=item.shape,
            remedy="the file is damaged: copy or export it again",
        )
    value = np.asarray(item[()] if window is None else window.of(item))
    if h5py.check_ref_dtype(item.dtype) is not None:  # MATLAB's cell array: one reference a cell
        return np.array([_matlab_text(np.asarray(item.file[cell][()])) for cell in value.ravel()])
    if _attribute(item, "MATLAB_class") == "char":
        return np.array(_matlab_text(value))
    return _array(value)


def _attribute(item: Any, key: str) -> str:
    return str(_array(item.attrs[key]).ravel()[0]) if key in item.attrs else ""


def _array(value: Any) -> npt.NDArray[Any]:
    """Return an array whose texts are str, not bytes or objects."""
    array = np.asarray(value)
    if array.dtype.kind not in "SO":
        return array
    texts = [
        text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text) for text in array.ravel()
    ]
    return np.array(texts, dtype=np.str_).reshape(array.shape)


def _matlab_text(codes: npt.NDArray[Any]) -> str:
    return "".join(chr(int(code)) for code in codes.ravel()) if codes.dtype.kind in "ui" else ""
