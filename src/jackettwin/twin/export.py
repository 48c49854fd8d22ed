"""Identified modes as files for other programs: JSON whole, CSV and NetCDF as one table of modes.

The table holds the modes of every set in the document: ``fused``, each group, each record.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import netcdf_file

from jackettwin.errors import InputError
from jackettwin.files import atomic_path, write_json

NUMBERS = {
    "frequency_hz": "Hz",
    "frequency_std_hz": "Hz",
    "frequency_low_95_hz": "Hz",
    "frequency_high_95_hz": "Hz",
    "damping_ratio": "1",
    "damping_ratio_std": "1",
    "damping_ratio_low_95": "1",
    "damping_ratio_high_95": "1",
}
"""Columns of numbers and their units; what is not known is empty in CSV, NaN in NetCDF."""

Row = dict[str, Any]


def export_modes(document: Mapping[str, Any], path: Path) -> None:
    """Write a document of ``jackettwin identify`` as the extension says: ``.json``, ``.csv`` or ``.nc``.

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
    """Yield one row a mode: its set, its number in it, its numbers and its shape by channel."""
    if "groups" not in document:
        yield from _rows(", ".join(document["records"]), document["modes"])
        return
    yield from _rows("fused", document["modes"])
    for group in document["groups"]:
        yield from _rows(_group_name(group), group["modes"])
    for record in document["records"]:
        yield from _rows(", ".join(record["records"]), record["modes"])


def _rows(name: str, modes: Sequence[Mapping[str, Any]]) -> Iterator[Row]:
    for number, mode in enumerate(modes, start=1):
        f_low, f_high = mode["frequency_interval_95"] or (None, None)
        low, high = mode["damping_ratio_interval_95"] or (None, None)
        row: Row = {"set": name, "mode": number}
        row |= {key: mode.get(key) for key in NUMBERS}
        row |= {"frequency_low_95_hz": f_low, "frequency_high_95_hz": f_high}
        row |= {"damping_ratio_low_95": low, "damping_ratio_high_95": high}
        yield {**row, "mode_shape": mode["mode_shape"]}


def _group_name(group: Mapping[str, Any]) -> str:
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
        table.writerow(["set", "mode", *NUMBERS, *shapes])
        for row in mode_rows(document):
            parts = [value for name in channels for value in row["mode_shape"].get(name, ("", ""))]
            numbers = ["" if row[key] is None else row[key] for key in NUMBERS]
            table.writerow([row["set"], row["mode"], *numbers, *parts])


def _write_netcdf(document: Mapping[str, Any], path: Path) -> None:
    """Write NetCDF-3: dimensions mode and channel, one variable a column."""
    channels = _channels(mode_rows(document))
    sets = [row["set"] for row in mode_rows(document)]
    with netcdf_file(str(path), "w") as file:
        file.createDimension("mode", len(sets))
        file.createDimension("channel", len(channels))
        _texts(file, "set", "mode", sets)
        _texts(file, "channel_name", "channel", channels)
        columns = {key: _column(file, key, ("mode",), unit) for key, unit in NUMBERS.items()}
        shapes = [_column(file, f"mode_shape_{part}", ("mode", "channel"), "1") for part in ("real", "imag")]
        for i, row in enumerate(mode_rows(document)):
            for key, column in columns.items():
                column[i] = np.nan if row[key] is None else row[key]
            parts = np.array([row["mode_shape"].get(name, (np.nan, np.nan)) for name in channels])
            for column, part in zip(shapes, parts.reshape(-1, 2).T, strict=True):
                column[i] = part


def _column(file: Any, name: str, dimensions: tuple[str, ...], unit: str) -> Any:
    column = file.createVariable(name, "f8", dimensions)
    column.units = unit.encode()
    return column


def _texts(file: Any, name: str, dimension: str, texts: Sequence[str]) -> None:
    """Store texts as NetCDF-3 can: a matrix of characters, padded with blanks."""
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
}
