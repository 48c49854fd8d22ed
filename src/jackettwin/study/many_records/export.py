"""Export of identified modes: the whole document as JSON, a table as CSV or NetCDF, shapes as UFF.

The table holds the modes of every set in the document: ``fused``, each group, each record.
"""

from __future__ import annotations

import csv
import os
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy  # scipy.io is loaded where it is used

from jackettwin.errors import InputError
from jackettwin.files import atomic_path, write_json
from jackettwin.study.many_records.shapes_uff import write_shapes_uff

NUMBERS = {
    "frequency_hz": "Hz",
    "frequency_std_hz": "Hz",
    "frequency_low_90_hz": "Hz",
    "frequency_high_90_hz": "Hz",
    "damping_ratio": "1",
    "damping_ratio_std": "1",
    "damping_ratio_low_90": "1",
    "damping_ratio_high_90": "1",
}
"""Columns of numbers and their units; unknown values are empty in CSV and NaN in NetCDF."""

SHAPES = ("mode_shape_real", "mode_shape_imag")
STATUS_LENGTH = 24
"""Characters of a status: the longest has 22, and rows of NetCDF-3 are padded to four bytes."""
ROWS_AT = 4
"""Byte offset of the number of rows in a NetCDF-3 file."""

Row = dict[str, Any]


def export_modes(document: Mapping[str, Any], path: Path) -> None:
    """Write a document of ``jackettwin identify`` in the format of its extension, one of ``WRITERS``.

    Raises
    ------
    InputError
        If the extension is another.
    """
    writer = WRITERS.get(path.suffix.lower())
    if writer is None:
        raise InputError(
            "cannot export to this format",
            file=path,
            field="--out",
            value=path.suffix,
            allowed=", ".join(WRITERS),
            remedy="choose one of these, or a folder for all of them",
        )
    with atomic_path(path) as temporary:
        writer(document, temporary)


def mode_rows(document: Mapping[str, Any]) -> Iterator[Row]:
    """Yield a row for each mode: its set, its number in the set, its values and its shape by channel."""
    if "groups" not in document:
        yield from _rows(", ".join(document["records"]), document["modes"])
        return
    yield from _rows("fused", document["modes"])
    for group in document["groups"]:
        yield from _rows(group_name(group), group["modes"])
    for record in document["records"]:
        yield from _rows(", ".join(record["records"]), record["modes"])


def _rows(name: str, modes: Sequence[Mapping[str, Any]]) -> Iterator[Row]:
    for number, mode in enumerate(modes, start=1):
        f_low, f_high = mode["frequency_interval_90"] or (None, None)
        low, high = mode["damping_ratio_interval_90"] or (None, None)
        row: Row = {"set": name, "mode": number, "status": mode["status"]}
        row |= {key: mode.get(key) for key in NUMBERS}
        row |= {"frequency_low_90_hz": f_low, "frequency_high_90_hz": f_high}
        row |= {"damping_ratio_low_90": low, "damping_ratio_high_90": high}
        yield {**row, "mode_shape": mode["mode_shape"]}


def group_name(group: Mapping[str, Any]) -> str:
    """Return the name of a group of records, from its conditions."""
    wind, yaw = group["wind_speed_m_s"], group["yaw_deg"]
    parts = [
        "" if wind is None else f"wind {wind[0]:g} to {wind[1]:g} m/s",
        "" if yaw is None else f"yaw {yaw[0]:g} to {yaw[1]:g} deg",
        group["state"] or "",
    ]
    return ", ".join(part for part in parts if part) or "no conditions"


def _channels(rows: Iterable[Row]) -> list[str]:
    return list(dict.fromkeys(name for row in rows for name in row["mode_shape"]))


def _write_csv(document: Mapping[str, Any], path: Path) -> None:
    channels = _channels(mode_rows(document))
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        shapes = [f"shape_{part}_{name}" for name in channels for part in ("real", "imag")]
        table.writerow(["set", "mode", "status", *NUMBERS, *shapes])
        for row in mode_rows(document):
            parts = [value for name in channels for value in row["mode_shape"].get(name, ("", ""))]
            numbers = ["" if row[key] is None else row[key] for key in NUMBERS]
            table.writerow([row["set"], row["mode"], row["status"], *numbers, *parts])


def _write_netcdf(document: Mapping[str, Any], path: Path) -> None:
    """Write NetCDF-3: dimensions mode (unlimited) and channel, one variable for each column.

    Variables along the unlimited dimension are stored row by row at the file's end: SciPy writes the header
    and the fixed variables, and the rows are appended one by one, so that only one is in memory.
    """
    channels = _channels(mode_rows(document)) or [""]  # a length of zero would mean unlimited
    width = max([1, *(len(row["set"].encode()) for row in mode_rows(document))])
    layout = _row_layout(width, len(channels))
    with scipy.io.netcdf_file(str(path), "w", version=2) as file:
        file.createDimension("mode", None)
        file.createDimension("channel", len(channels))
        file.createDimension("set_length", width)
        file.createDimension("status_length", STATUS_LENGTH)
        _texts(file, "channel_name", "channel", channels)
        rows = [file.createVariable(name, "c", ("mode", f"{name}_length")) for name in ("set", "status")]
        rows += [_column(file, name, ("mode",), unit) for name, unit in NUMBERS.items()]
        rows += [_column(file, part, ("mode", "channel"), "1") for part in SHAPES]
        for column in rows:  # a first row gives SciPy the sizes; it is overwritten
            column[0] = b" " if column.typecode() == "c" else 0.0
    with path.open("r+b") as stream:
        stream.seek(-layout.itemsize, os.SEEK_END)
        count = 0
        for row in mode_rows(document):
            stream.write(_packed(row, channels, layout).tobytes())
            count += 1
        stream.truncate()
        stream.seek(ROWS_AT)
        stream.write(struct.pack(">i", count))


def _column(file: Any, name: str, dimensions: tuple[str, ...], unit: str) -> Any:
    column = file.createVariable(name, "f8", dimensions)
    column.units = unit.encode()
    return column


def _row_layout(width: int, n_channels: int) -> np.dtype[np.void]:
    """Return the layout of a row in the file: variables in order, each padded to four bytes."""
    numbers = [(name, ">f8") for name in NUMBERS]
    shapes = [(part, ">f8", (n_channels,)) for part in SHAPES]
    texts = [("set", f"S{width}"), ("padding", f"V{-width % 4}"), ("status", f"S{STATUS_LENGTH}")]
    return np.dtype([*texts, *numbers, *shapes])


def _packed(row: Row, channels: Sequence[str], layout: np.dtype[np.void]) -> np.ndarray[Any, Any]:
    out = np.zeros((), dtype=layout)
    for name in ("set", "status"):
        out[name] = row[name].encode().ljust(layout[name].itemsize)
    for name in NUMBERS:
        out[name] = np.nan if row[name] is None else row[name]
    shape = np.array([row["mode_shape"].get(name, (np.nan, np.nan)) for name in channels]).reshape(-1, 2)
    for part, values in zip(SHAPES, shape.T, strict=True):
        out[part] = values
    return out


def _texts(file: Any, name: str, dimension: str, texts: Sequence[str]) -> None:
    """Store texts as a matrix of characters padded with blanks, since NetCDF-3 has no strings."""
    raw = [text.encode() for text in texts]
    width = max([1, *map(len, raw)])
    file.createDimension(f"{name}_length", width)
    column = file.createVariable(name, "c", (dimension, f"{name}_length"))
    for i, text in enumerate(raw):
        column[i] = np.frombuffer(text.ljust(width), dtype="S1")


WRITERS: dict[str, Callable[[Mapping[str, Any], Path], None]] = {
    ".json": write_json,
    ".csv": _write_csv,
    ".nc": _write_netcdf,
    ".uff": write_shapes_uff,
}
ALWAYS = (".json", ".csv", ".nc")
"""Files of an exported folder; shapes in UFF need channels with directions."""
