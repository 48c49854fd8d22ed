"""OpenFAST outputs: text (``.out``) and binary (``.outb``, file identifiers 1 to 4, through v5).

The binary layout follows ``WrBinFAST`` of the NWTC library: an int16 identifier, in identifier 4
the length of names, counts, time and scales, a description, names and units of the time and every
channel, then rows of int16 (or, in identifier 3, float64) samples.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.quantities import guess_quantity, plain_unit
from jackettwin.records.readers.description import ChannelEntry
from jackettwin.records.readers.source import Source
from jackettwin.records.readers.table import ReadTable

if TYPE_CHECKING:
    from pathlib import Path

WITH_TIME, WITHOUT_TIME, UNCOMPRESSED, NAME_LENGTH_IN_FILE = 1, 2, 3, 4
DEFAULT_NAME_LENGTH = 10
MOST_HEADER_LINES = 50
# ElastoDyn's accelerations end in the axis and the letter of their frame: YawBrTAxp, TwHt1ALxt, and
# NcIMUTAxs, which turns with the nacelle.
_MOTION = re.compile(r"(?:TV|vel)", re.IGNORECASE)
_AXIS = re.compile(r"(?:TA|AL)([xyz])([a-z]?)$")


def read_text(path: Path) -> ReadTable:
    """Read a ``.out``: names follow the first line that starts with Time, units in the next."""
    raw = path.read_bytes()
    if raw[:2] in (b"\x01\x00", b"\x02\x00", b"\x03\x00", b"\x04\x00"):  # a binary file by a text name
        return read_binary(path)
    lines = raw.decode("utf-8", errors="replace").splitlines()
    head = next(
        (i for i, line in enumerate(lines[:MOST_HEADER_LINES]) if line.lower().split()[:1] == ["time"]), None
    )
    if head is None or head + 2 >= len(lines):
        raise InputError(
            "has no line of names starting with Time", field="header", remedy="is this an OpenFAST output?"
        )
    names, units = lines[head].split(), lines[head + 1].split()
    rows = [line.split() for line in lines[head + 2 :] if line.strip()]
    whole = [row for row in rows if len(row) == len(names)]
    if len(rows) - len(whole) > 1 or len(units) != len(names):  # the last row may be cut off
        raise InputError(
            "rows, names and units differ in number",
            field=f"line {head + 1}",
            value=(len(names), len(units)),
            allowed="one name, unit and value a column",
            remedy="the file is damaged",
        )
    values = np.array([[_number(cell) for cell in row] for row in whole], dtype=np.float64)
    description = " ".join(line.strip() for line in lines[:head] if line.strip())
    return _table(names, units, values.T.reshape(len(names), -1), description)


def read_binary(path: Path) -> ReadTable:
    """Read a ``.outb``."""
    source = Source(path.read_bytes())
    identifier = int(source.take("<i2", 1)[0])
    if identifier not in (WITH_TIME, WITHOUT_TIME, UNCOMPRESSED, NAME_LENGTH_IN_FILE):
        raise InputError(
            "is not an OpenFAST binary",
            field="identifier",
            value=identifier,
            allowed="1 to 4",
            remedy="check what wrote the file; text output is .out",
        )
    width = int(source.take("<i2", 1)[0]) if identifier == NAME_LENGTH_IN_FILE else DEFAULT_NAME_LENGTH
    n_channels, n_samples = (int(n) for n in source.take("<i4", 2))
    first, second = (float(x) for x in source.take("<f8", 2))
    scaled = identifier != UNCOMPRESSED
    slope = source.take("<f4", n_channels).astype(np.float64) if scaled else np.ones(n_channels)
    offset = source.take("<f4", n_channels).astype(np.float64) if scaled else np.zeros(n_channels)
    description = source.text(int(source.take("<i4", 1)[0]))
    names = [source.text(width) for _ in range(n_channels + 1)]
    units = [source.text(width) for _ in range(n_channels + 1)]
    stamps = source.take("<i4", n_samples) if identifier == WITH_TIME else None
    packed = source.take("<i2" if scaled else "<f8", n_samples * n_channels).reshape(n_samples, n_channels)
    if stamps is not None:  # packed like a channel, the slope first
        times = np.asarray((stamps - second) / first, dtype=np.float64)
    else:
        times = np.linspace(first, first + second * (n_samples - 1), n_samples)
    # Older versions write a constant channel with the scale 0/0.
    known = np.isfinite(slope) & np.isfinite(offset) & (slope != 0.0)
    values = np.where(
        known, (packed - offset) / np.where(known, slope, 1.0), np.where(slope == 0.0, np.nan, 0.0)
    )
    return _table(names, units, np.vstack([times, values.T]), description)


def _table(names: list[str], units: list[str], values: FloatArray, description: str) -> ReadTable:
    channels = {name: _entry(name, unit) for name, unit in zip(names[1:], units[1:], strict=True)}
    return ReadTable(
        names=tuple(names[1:]),
        data=values[1:],
        channels=channels,
        times_s=values[0],
        metadata={"source": description} if description else {},
    )


def _entry(name: str, unit: str) -> ChannelEntry:
    match = _AXIS.search(name)
    axis = "xyz".index(match[1]) if match else None
    direction = None if axis is None else (float(axis == 0), float(axis == 1), float(axis == 2))
    turns = match is not None and match[2] == "s"
    # most speeds among the outputs are those of air and water
    foreign = plain_unit(unit) == "m/s" and not _MOTION.search(name)
    quantity = "other" if foreign and guess_quantity(name, plain_unit(unit)) == "velocity" else None
    return ChannelEntry(quantity=quantity, unit=unit, direction=direction, frame="nacelle" if turns else None)


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return float("nan")  # Fortran prints stars where a number does not fit its field
