"""National Instruments TDMS: segments of metadata and raw samples.

Layout after National Instruments' description "TDMS File Format Internal Structure". DAQmx raw
data and channels that still need a non-linear scale are refused, not misread.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.records.readers.source import Source
from jackettwin.records.readers.table import ReadTable, table_from_columns

if TYPE_CHECKING:
    from pathlib import Path

METADATA, NEW_LIST, RAW_DATA, INTERLEAVED, BIG_ENDIAN = 1 << 1, 1 << 2, 1 << 3, 1 << 5, 1 << 6
LEAD_IN_BYTES = 28
UNFINISHED = 0xFFFFFFFFFFFFFFFF
NO_DATA, AS_BEFORE = 0xFFFFFFFF, 0
DAQMX = (0x69120000, 0x69130000)
STRING, BOOLEAN, TIMESTAMP = 0x20, 0x21, 0x44
NUMBERS = {
    1: "i1", 2: "i2", 3: "i4", 4: "i8", 5: "u1", 6: "u2", 7: "u4", 8: "u8",
    9: "f4", 10: "f8", 0x19: "f4", 0x1A: "f8", BOOLEAN: "u1",
}  # fmt: skip
SAME_RATE = 1e-6
"""Relative difference of two sampling steps that are one."""
EPOCH = np.datetime64("1904-01-01T00:00:00", "ns")
_PART = re.compile(r"/'((?:[^']|'')*)'")


@dataclass(frozen=True)
class _Layout:
    """Layout of one channel in a chunk: type, number of values, and bytes if they are texts."""

    kind: int
    count: int
    text_bytes: int = 0

    @property
    def size(self) -> int:
        if self.kind == STRING:
            return self.text_bytes
        return self.count * (16 if self.kind == TIMESTAMP else np.dtype(NUMBERS[self.kind]).itemsize)


@dataclass
class _Contents:
    """Description of the channels by the segments read so far."""

    layouts: dict[str, _Layout] = field(default_factory=dict)
    active: list[str] = field(default_factory=list)
    properties: dict[str, dict[str, Any]] = field(default_factory=dict)
    pieces: dict[str, list[npt.NDArray[Any]]] = field(default_factory=dict)


def read(path: Path) -> ReadTable:
    """Read the channels of the highest rate; names get their group in front only if two groups share them."""
    contents = _Contents()
    raw = path.read_bytes()
    at = 0
    while at + LEAD_IN_BYTES <= len(raw):
        at = _read_segment(raw, at, contents)
    paths, remarks = _of_highest_rate([p for p, pieces in contents.pieces.items() if pieces], contents)
    short = [_parts(p)[-1] for p in paths]
    names = [s if short.count(s) == 1 else "/".join(_parts(p)) for s, p in zip(short, paths, strict=True)]
    columns = [_scaled(p, np.concatenate(contents.pieces[p]), contents.properties.get(p, {})) for p in paths]
    lengths = sorted({len(column) for column in columns})
    if len(lengths) > 1:
        raise InputError(
            "channels differ in length", field="data", value=lengths, remedy="store one rate a file"
        )
    known = [contents.properties.get(p, {}) for p in paths]
    units = {
        name: str(k["unit_string"]) for name, k in zip(names, known, strict=True) if k.get("unit_string")
    }
    root = {str(key): value for key, value in contents.properties.get("/", {}).items()}
    return table_from_columns(names, columns, units, **_waveform(known), metadata=root, remarks=remarks)


def _of_highest_rate(paths: list[str], contents: _Contents) -> tuple[list[str], tuple[str, ...]]:
    """Return the channels of the highest rate, and a remark that names the others, as of the weather."""
    steps = [float(contents.properties.get(p, {}).get("wf_increment") or 0.0) for p in paths]
    least = min((step for step in steps if step > 0.0), default=0.0)
    slower = [_parts(p)[-1] for p, step in zip(paths, steps, strict=True) if step > least * (1.0 + SAME_RATE)]
    if not slower or least == 0.0:
        return paths, ()
    kept = [p for p, step in zip(paths, steps, strict=True) if step <= least * (1.0 + SAME_RATE)]
    return kept, (f"channels at lower rates are left out: {', '.join(slower)}",)


def _read_segment(raw: bytes, at: int, contents: _Contents) -> int:
    """Read one segment and return where the next one starts."""
    source = Source(raw, at)
    if source.skip(4) != b"TDSm":
        raise InputError(
            "is not a TDMS segment", field=f"byte {at}", allowed="TDSm", remedy="the file is damaged"
        )
    flags, _ = (int(n) for n in source.take("<u4", 2))
    order = ">" if flags & BIG_ENDIAN else "<"
    next_offset, raw_offset = (int(n) for n in source.take(f"{order}u8", 2))
    start = at + LEAD_IN_BYTES
    end = len(raw) if next_offset == UNFINISHED else min(start + next_offset, len(raw))
    if flags & METADATA:
        if flags & NEW_LIST:
            contents.active = []
        for _ in range(int(source.take(f"{order}u4", 1)[0])):
            _read_object(source, order, contents)
    if flags & RAW_DATA:
        data = Source(raw[: max(end, 0)], start + raw_offset)
        _read_chunks(data, order, bool(flags & INTERLEAVED), contents)
    return end if end > at else len(raw)


def _read_object(source: Source, order: str, contents: _Contents) -> None:
    path = _string(source, order)
    index = int(source.take(f"{order}u4", 1)[0])
    if index in DAQMX:
        raise InputError(
            "holds DAQmx raw data", field=path, remedy="export it from the logger as plain TDMS or CSV"
        )
    if index not in (NO_DATA, AS_BEFORE):
        kind, _ = (int(n) for n in source.take(f"{order}u4", 2))
        count = int(source.take(f"{order}u8", 1)[0])
        text_bytes = int(source.take(f"{order}u8", 1)[0]) if kind == STRING else 0
        if kind not in NUMBERS and kind not in (STRING, TIMESTAMP):
            raise InputError("has an unknown data type", field=path, value=kind, remedy="export real numbers")
        contents.layouts[path] = _Layout(kind, count, text_bytes)
    if index != NO_DATA and path in contents.layouts and path not in contents.active:
        contents.active.append(path)
    properties = contents.properties.setdefault(path, {})
    for _ in range(int(source.take(f"{order}u4", 1)[0])):
        name = _string(source, order)
        properties[name] = _value(source, order)


def _read_chunks(source: Source, order: str, interleaved: bool, contents: _Contents) -> None:
    layouts = [(path, contents.layouts[path]) for path in contents.active]
    size = sum(layout.size for _, layout in layouts)
    if size <= 0:
        return
    # A logger that lost power leaves an incomplete last chunk: it is left out.
    for _ in range((len(source.raw) - source.at) // size):
        if interleaved:
            _take_interleaved(source, order, layouts, contents)
            continue
        for path, layout in layouts:
            values = _values(source, order, layout)
            if values is not None:
                contents.pieces.setdefault(path, []).append(values)


def _take_interleaved(
    source: Source, order: str, layouts: list[tuple[str, _Layout]], contents: _Contents
) -> None:
    if any(
        layout.kind in (STRING, TIMESTAMP) or layout.count != layouts[0][1].count for _, layout in layouts
    ):
        raise InputError("interleaves channels of different kind", field="data", remedy="export it again")
    row = np.dtype([(f"c{i}", f"{order}{NUMBERS[layout.kind]}") for i, (_, layout) in enumerate(layouts)])
    rows = np.frombuffer(source.skip(row.itemsize * layouts[0][1].count), dtype=row)
    for i, (path, _) in enumerate(layouts):
        contents.pieces.setdefault(path, []).append(rows[f"c{i}"].astype(np.float64))


def _values(source: Source, order: str, layout: _Layout) -> npt.NDArray[Any] | None:
    """Return the values of one channel in one chunk; None for texts."""
    if layout.kind == STRING:
        source.skip(layout.text_bytes)
        return None
    if layout.kind == TIMESTAMP:
        return _times(source, order, layout.count)
    return source.take(f"{order}{NUMBERS[layout.kind]}", layout.count).astype(np.float64)


def _times(source: Source, order: str, count: int) -> npt.NDArray[np.datetime64]:
    """Return times stored as fractions of 2^-64 s and seconds since 1904."""
    fields = [("fraction", f"{order}u8"), ("seconds", f"{order}i8")]
    names = fields if order == "<" else fields[::-1]
    stored = np.frombuffer(source.skip(16 * count), dtype=np.dtype(names))
    nanoseconds = (stored["fraction"].astype(np.float64) * 2.0**-64 * 1e9).astype(np.int64)
    times: npt.NDArray[np.datetime64] = EPOCH + stored["seconds"].astype("timedelta64[s]")
    times += nanoseconds.astype("timedelta64[ns]")
    return times


def _string(source: Source, order: str) -> str:
    return source.text(int(source.take(f"{order}u4", 1)[0]))


def _value(source: Source, order: str) -> Any:
    kind = int(source.take(f"{order}u4", 1)[0])
    if kind == STRING:
        return _string(source, order)
    if kind == TIMESTAMP:
        return str(_times(source, order, 1)[0])
    if kind not in NUMBERS:
        raise InputError(
            "property has an unknown type", field="properties", value=kind, remedy="the file is damaged"
        )
    return source.take(f"{order}{NUMBERS[kind]}", 1)[0].item()


def _parts(path: str) -> list[str]:
    return [part.replace("''", "'") for part in _PART.findall(path)] or [path]


def _scaled(path: str, values: npt.NDArray[Any], properties: dict[str, Any]) -> npt.NDArray[Any]:
    """Apply the linear scale of a channel that was stored unscaled."""
    if properties.get("NI_Scaling_Status") != "unscaled" or not properties.get("NI_Number_Of_Scales"):
        return values
    kinds = [
        properties.get(f"NI_Scale[{i}]_Scale_Type") for i in range(int(properties["NI_Number_Of_Scales"]))
    ]
    if kinds != ["Linear"]:
        raise InputError("needs a scale we do not know", field=path, value=kinds, remedy="export scaled data")
    slope, offset = (float(properties[f"NI_Scale[0]_Linear_{key}"]) for key in ("Slope", "Y_Intercept"))
    scaled: npt.NDArray[Any] = values * slope + offset
    return scaled


def _waveform(known: list[dict[str, Any]]) -> dict[str, Any]:
    """Return rate and start from the waveform properties."""
    found: dict[str, Any] = {}
    step = next((float(k["wf_increment"]) for k in known if k.get("wf_increment")), 0.0)
    if step > 0.0:
        found["sample_rate_hz"] = float(f"{1.0 / step:.9g}")
    start = next((k["wf_start_time"] for k in known if k.get("wf_start_time")), None)
    if start and not start.startswith("1904"):  # the epoch itself stands for "not known"
        found["start_utc"] = datetime.fromisoformat(start[:26]).replace(tzinfo=UTC)
    return found
