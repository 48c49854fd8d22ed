"""Named arrays (npz, MATLAB, HDF5): one set of rules for what they mean; NumPy's own files.

A scalar named like a rate is the rate; a vector named like a time holds the stamps; a text named
``description`` is the JSON of a record. A matrix holds one channel along its shorter side, named
by the list beside it (``channel_names``, ``names``, ``channels``, ``labels``), in the unit or units
beside it (``units``, ``unit``); a single vector takes its name from such a list as well. Further vectors
of the common length are channels under their own names, others are left out with a remark.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.records.readers.delimited import RATE_KEYS
from jackettwin.records.readers.description import ChannelEntry, description_text, parse_description
from jackettwin.records.readers.stamps import parse_time
from jackettwin.records.readers.table import ReadTable, is_time, seconds, time_unit

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jackettwin.records.readers.table import ReadTable
    from jackettwin.records.record import Record


Arrays = dict[str, npt.NDArray[Any]]

NAME_LISTS = ("channel_names", "channelnames", "names", "channels", "labels")
UNIT_LISTS = ("units", "unit", "channel_units", "unit_string")
MUCH_SHORTER = 0.1
"""A vector shorter than this share of the channel's length is no channel of another length."""
STEP_KEYS = ("dt", "time_step", "step_s", "wf_increment")


def table_from_arrays(
    arrays: Mapping[str, npt.NDArray[Any]], units: Mapping[str, str] | None = None
) -> ReadTable:
    """Return the table that named arrays hold; names are matched on their last dotted part.

    Raises
    ------
    InputError
        If there is no numeric array, or several matrices.
    """
    texts = {key: _texts(value) for key, value in arrays.items() if value.dtype.kind in "USO"}
    numbers = {key: np.squeeze(value) for key, value in arrays.items() if value.dtype.kind in "fiub"}
    scalars = {_last(key): float(value) for key, value in numbers.items() if value.ndim == 0}
    named = {_last(key): text for key, text in texts.items()}
    times = [key for key, value in numbers.items() if value.ndim == 1 and is_time(_last(key))]
    vectors = {key: value for key, value in numbers.items() if value.ndim == 1 and key not in times}
    matrix_key, rows = _matrix_rows(numbers, named)
    vectors, left = _common_length(vectors, len(next(iter(rows.values()))) if rows else None)
    if not rows:
        matrix_key, vectors = _one_named(vectors, named)
    rows = rows | vectors
    if not rows:
        raise InputError(
            "holds no channels",
            field="data",
            value=", ".join(arrays),
            allowed="a matrix or vectors",
            remedy="export the samples as numbers",
        )
    times_s, start = (None, None)
    if times:
        _refuse_other_length(times[0], numbers[times[0]], next(iter(rows.values())))
        times_s, start = seconds(numbers[times[0]].astype(np.float64), time_unit(_last(times[0])))
    listed = [name for name in rows if name not in vectors or matrix_key]
    found, unit = _units(dict(units or {}), matrix_key, listed, named)
    return ReadTable(
        names=tuple(rows),
        data=np.vstack([np.asarray(row, dtype=np.float64) for row in rows.values()]),
        channels={name: ChannelEntry(unit=unit) for name, unit in found.items() if unit},
        sample_rate_hz=_rate(scalars),
        times_s=times_s,
        times_unit_said=not times or time_unit(_last(times[0])) is not None,
        start_utc=parse_time(named["start_utc"][0]) if named.get("start_utc") else start,
        description=parse_description(named["description"][0]) if named.get("description") else None,
        unit=unit,
        remarks=left,
    )


def arrays_from_record(record: Record) -> Arrays:
    """Return the arrays that ``table_from_arrays`` reads back."""
    return {
        "data": record.data,
        "sample_rate_hz": np.array(record.sample_rate_hz),
        "channel_names": np.array(record.channel_names, dtype=np.str_),
        "description": np.array(description_text(record), dtype=np.str_),
    }


def _last(key: str) -> str:
    return key.replace("/", ".").rsplit(".", 1)[-1].lower()


def _texts(value: npt.NDArray[Any]) -> list[str]:
    """Return texts from an array of texts, bytes or (MATLAB's cell) arrays of one text each."""
    out = []
    for item in value.ravel().tolist():
        inner = item.ravel().tolist() if isinstance(item, np.ndarray) else [item]
        text = inner[0] if len(inner) == 1 else ""
        out.append((text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)).strip())
    return out


def _matrix_rows(numbers: Arrays, named: dict[str, list[str]]) -> tuple[str, Arrays]:
    """Return the name of the one matrix and its rows, by the names listed beside it."""
    matrices = [(key, value) for key, value in numbers.items() if value.ndim == 2 and value.size]
    if not matrices:
        return "", {}
    if len(matrices) > 1:
        raise InputError(
            "holds several matrices",
            field="data",
            value=", ".join(key for key, _ in matrices),
            allowed="one matrix of channels",
            remedy="store one record a file",
        )
    key, matrix = matrices[0]
    rows = matrix if matrix.shape[0] <= matrix.shape[1] else matrix.T
    names = next((named[name] for name in NAME_LISTS if named.get(name)), None)
    names = names or [f"{_last(key)}_{i + 1}" for i in range(len(rows))]
    if len(names) != len(rows) or len(set(names)) != len(names):
        raise InputError(
            "names and channels disagree",
            field=key,
            value=names,
            allowed=f"{len(rows)} different names",
            remedy="list one name a channel",
        )
    return key, dict(zip(names, rows, strict=True))


def _one_named(vectors: Arrays, named: dict[str, list[str]]) -> tuple[str, Arrays]:
    """Return the array of a single channel, (n, 1) or (n,), under the one name listed beside it."""
    names = next((named[name] for name in NAME_LISTS if named.get(name)), None)
    if names is None or len(names) != 1 or len(vectors) != 1:
        return "", vectors
    key, vector = next(iter(vectors.items()))
    return key, {names[0]: vector}


def _units(
    own: dict[str, str], matrix: str, rows: list[str], named: dict[str, list[str]]
) -> tuple[dict[str, str], str | None]:
    """Return units by channel, of a matrix one for all or one a row, and that of channels without one.

    One unit beside vectors holds for those that measure a vibration and have none of their own: beside an
    acceleration may stand a wind speed.
    """
    listed = next((named[key] for key in UNIT_LISTS if named.get(key)), None)
    listed = listed or ([own[matrix]] if own.get(matrix) else [])
    if not listed:
        return own, None
    if not rows:
        return own, listed[0] if len(listed) == 1 else None
    if len(listed) not in (1, len(rows)):
        raise InputError(
            "units and channels disagree",
            field="units",
            value=listed,
            allowed=f"one unit, or {len(rows)}",
            remedy="list one unit a channel",
        )
    units = listed if len(listed) == len(rows) else listed * len(rows)
    return own | dict(zip(rows, units, strict=True)), None


def _common_length(vectors: Arrays, length: int | None) -> tuple[Arrays, tuple[str, ...]]:
    """Return the vectors of the matrix's length, else of the most frequent one, and a remark on the others.

    Raises
    ------
    InputError
        If no length is more frequent, and another is not much shorter.
    """
    lengths = Counter(len(vector) for vector in vectors.values() if len(vector) > 1)
    if not lengths:
        return {}, ()
    usual = length or max(lengths, key=lambda n: (lengths[n], n))
    others = {key: len(vector) for key, vector in vectors.items() if len(vector) not in (1, usual)}
    told = ", ".join(f"{key} ({n})" for key, n in others.items())
    if length is None and lengths[usual] == 1 and any(n > MUCH_SHORTER * usual for n in others.values()):
        raise InputError(
            "vectors differ in length",
            field="data",
            value=", ".join(f"{key} ({len(vector)})" for key, vector in vectors.items()),
            allowed="one length a file",
            remedy="store one rate a file, all channels over the same time",
        )
    kept = {key: vector for key, vector in vectors.items() if len(vector) == usual}
    return kept, (f"vectors of another length than {usual} are left out: {told}",) if told else ()


def _refuse_other_length(name: str, times: npt.NDArray[Any], row: npt.NDArray[Any]) -> None:
    if len(times) != len(row):
        raise InputError(
            "times and channels differ in length",
            field=name,
            value=len(times),
            allowed=str(len(row)),
            remedy="store one time a sample, or remove the times and state sample_rate_hz",
        )


def _rate(scalars: dict[str, float]) -> float | None:
    rate = next((scalars[key] for key in RATE_KEYS if key in scalars), None)
    step = next((scalars[key] for key in STEP_KEYS if key in scalars), None)
    if rate is None and step:
        rate = 1.0 / step
    if rate is not None and not 0.0 < rate < float("inf"):
        raise InputError(
            "is not a rate", field="sample_rate_hz", value=rate, allowed="> 0 Hz", remedy="correct it"
        )
    return rate


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
