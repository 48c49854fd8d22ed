"""HDF5 (and MATLAB 7.3, which is HDF5): datasets and attributes by the rules of named arrays.

A dataset's attribute ``unit``, ``units`` or ``unit_string`` is its unit; scalar attributes of the file, of a
group or of a dataset (the rate, the start) count as named scalars.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError, MissingExtra
from jackettwin.records.readers.arrays import STEP_KEYS, arrays_from_record, table_from_arrays
from jackettwin.records.readers.delimited import RATE_KEYS

if TYPE_CHECKING:
    from pathlib import Path

    from jackettwin.records.readers.table import Table
    from jackettwin.records.record import Record

UNIT_KEYS = ("unit", "units", "unit_string")
MOST_COMPRESSION = 1000
"""A damaged header announces any size; what deflate cannot have packed into the file is refused."""


def read(path: Path) -> Table:
    """Read every dataset.

    Raises
    ------
    MissingExtra
        If h5py is not installed.
    """
    h5py = _h5py()
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
            arrays[name] = _dataset(h5py, item)

    with h5py.File(path, "r") as file:
        collect("", file)
        file.visititems(collect)
    return table_from_arrays(arrays, units)


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


def _dataset(h5py: Any, item: Any) -> npt.NDArray[Any]:
    if item.dtype.itemsize * item.size > MOST_COMPRESSION * item.file.id.get_filesize():
        raise InputError(
            "announces more data than the file can hold",
            field=item.name,
            value=item.shape,
            remedy="the file is damaged: copy or export it again",
        )
    value = np.asarray(item[()])
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
