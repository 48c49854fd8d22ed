"""Universal file format, data set 58 (time responses), text and binary (58b).

Layout after the SDRC description of data set 58: eleven header records of fixed format, then the
ordinates. Even abscissa in seconds only; one data set a channel.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError
from jackettwin.records.clocks import shortest_decimal
from jackettwin.records.readers.description import ChannelEntry, describe
from jackettwin.records.readers.stamps import parse_time
from jackettwin.records.readers.table import ReadTable

if TYPE_CHECKING:
    from pathlib import Path

    from jackettwin.records.record import Record


TIME_RESPONSE = 1
# Record 9, field 1: specific data type ↔ quantity.
QUANTITIES = {8: "displacement", 11: "velocity", 12: "acceleration"}
# Record 6, field 9: response direction.
AXES = {1: (1.0, 0.0, 0.0), 2: (0.0, 1.0, 0.0), 3: (0.0, 0.0, 1.0)}
SINGLE, DOUBLE = 2, 4
_OPENING = re.compile(rb"^ {4}-1[ \r]*\n {4}(58b?(?![0-9])[^\n]*)\n", re.MULTILINE)
_CLOSING = re.compile(rb"^ {4}-1[ \r]*$", re.MULTILINE)


@dataclass(frozen=True)
class _Set:
    """One data set 58."""

    name: str
    entry: ChannelEntry
    sample_rate_hz: float
    start: str
    values: FloatArray


def read(path: Path) -> ReadTable:
    """Read every time response of the file; other data sets are passed over.

    Raises
    ------
    InputError
        If there is none, or their rates or lengths differ.
    """
    sets = [s for header, body, binary in _blocks(path.read_bytes()) if (s := _parse(header, body, binary))]
    if not sets:
        raise InputError(
            "holds no time response",
            field="data set 58",
            allowed="function type 1",
            remedy="export time data",
        )
    shapes = sorted({(len(s.values), s.sample_rate_hz) for s in sets})
    if len(shapes) > 1:
        raise InputError(
            "channels differ in length or rate",
            field="data set 58",
            value=shapes[:3],
            allowed="one length and rate a file",
            remedy="export one group of channels a file",
        )
    titles = [s.name for s in sets]
    names = _unique(titles)
    return ReadTable(
        names=names,
        data=np.vstack([s.values for s in sets]),
        channels={name: s.entry for name, s in zip(names, sets, strict=True)},
        sample_rate_hz=sets[0].sample_rate_hz,
        start_utc=parse_time(sets[0].start) if sets[0].start else None,
        remarks=tuple(
            f"{count} data sets are called {title!r}: numbered {title}_1 to {title}_{count} in their order"
            for title, count in Counter(titles).items()
            if count > 1
        ),
    )


def write(record: Record, path: Path) -> None:
    """Write one double-precision binary data set a channel; the JSON beside it keeps the rest."""
    start = describe(record)["start_utc"] or "NONE"
    axes = {vector: code for code, vector in AXES.items()}
    kinds = {name: code for code, name in QUANTITIES.items()}
    with path.open("wb") as stream:
        for number, (channel, row) in enumerate(zip(record.channels, record.data, strict=True), start=1):
            kind = kinds.get(channel.quantity, 0)
            node, direction = number, axes.get(channel.direction, 0)
            header = [
                channel.name[:80],
                "NONE",
                start,
                "NONE",
                "NONE",
                f"{TIME_RESPONSE:5d}{number:10d}{0:5d}{0:10d} {'NONE':<10}{node:10d}{direction:4d}"
                f" {'NONE':<10}{0:10d}{0:4d}",
                f"{DOUBLE:10d}{len(row):10d}{1:10d}{0.0:13.5e}{1.0 / record.sample_rate_hz:13.5e}{0.0:13.5e}",
                _axis(17, "Time", "s"),
                _axis(kind, channel.quantity, channel.unit),
                _axis(0, "NONE", "NONE"),
                _axis(0, "NONE", "NONE"),
            ]
            stream.write(b"    -1\n")
            stream.write(
                f"    58b{1:6d}{2:6d}{11:12d}{8 * len(row):12d}{0:6d}{0:6d}{0:12d}{0:12d}\n".encode()
            )
            stream.write("".join(f"{line:<80}\n" for line in header).encode("utf-8"))
            stream.write(row.astype("<f8").tobytes())
            stream.write(b"\n    -1\n")


def _axis(kind: int, label: str, unit: str) -> str:
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {label[:20]:<20} {unit[:20]:<20}"


def _blocks(raw: bytes) -> list[tuple[list[str], bytes, str]]:
    """Return (header lines, body, id line) of every data set 58; others are passed over."""
    blocks = []
    match = _OPENING.search(raw)
    while match is not None:
        id_line = match[1].decode("ascii", errors="replace")
        *encoded, rest = raw[match.end() :].split(b"\n", 11)
        if len(encoded) < 11:
            raise InputError("ends inside a header", field="data set 58", remedy="the file is cut off")
        at = len(raw) - len(rest)
        end = at + _integer(id_line[27:39]) if id_line.startswith("58b") else _closing(raw, at)
        if not at <= end <= len(raw):
            raise InputError("ends inside the data", field="data set 58", remedy="the file is cut off")
        lines = [line.decode("utf-8", errors="replace").rstrip("\r") for line in encoded]
        blocks.append((lines, raw[at:end], id_line))
        match = _OPENING.search(raw, end)
    return blocks


def _closing(raw: bytes, at: int) -> int:
    match = _CLOSING.search(raw, at)
    if match is None:
        raise InputError("data set is not closed", field="data set 58", remedy="the file is cut off")
    return match.start()


def _parse(lines: list[str], body: bytes, id_line: str) -> _Set | None:
    """Return a time response, or None for another kind of function."""
    if _integer(lines[5][:5]) != TIME_RESPONSE:
        return None
    number, node, direction = _integer(lines[5][5:15]), _integer(lines[5][41:51]), _integer(lines[5][51:55])
    kind, n_values = _integer(lines[6][:10]), _integer(lines[6][10:20])
    even, step = _integer(lines[6][20:30]), _real(lines[6][43:56])
    if kind not in (SINGLE, DOUBLE) or even != 1 or not 0.0 < step < np.inf:
        raise InputError(
            "is not an evenly sampled real signal",
            field="data set 58, record 7",
            value=lines[6].strip(),
            allowed="data type 2 or 4, even spacing, step > 0",
            remedy="export evenly sampled time data",
        )
    sign = -1.0 if direction < 0 else 1.0  # −0 + 0 is 0
    axis = AXES.get(abs(direction))
    unit = lines[8][47:67].strip()
    entry = ChannelEntry(
        quantity=QUANTITIES.get(_integer(lines[8][:10])),
        unit=None if unit.upper() == "NONE" else unit,
        node=str(node) if node else None,
        direction=None
        if axis is None
        else (sign * axis[0] + 0.0, sign * axis[1] + 0.0, sign * axis[2] + 0.0),
    )
    name = lines[0].strip()
    return _Set(
        name=name if name and name.upper() != "NONE" else f"channel_{number}",
        entry=entry,
        sample_rate_hz=shortest_decimal(1.0 / step, 1e-5),  # the step has five decimals
        start=lines[2].strip() if lines[2].strip()[:2] == "20" else "",
        values=_values(body, id_line, kind, n_values),
    )


def _values(body: bytes, id_line: str, kind: int, n_values: int) -> FloatArray:
    if id_line.startswith("58b"):
        order = "<" if _integer(id_line[3:9]) == 1 else ">"
        values = np.frombuffer(body, dtype=f"{order}f{4 if kind == SINGLE else 8}").astype(np.float64)
    else:
        # Fields are 13 or 20 wide and may touch; where blanks part them, blanks are enough.
        width = 13 if kind == SINGLE else 20
        text = body.decode("ascii", errors="replace").replace("D", "E")
        fields = [
            line[i : i + width] for line in text.splitlines() for i in range(0, len(line.rstrip()), width)
        ]
        values = np.array([_real(field) for field in fields])
    if len(values) < n_values:
        raise InputError(
            "holds fewer values than it announces",
            field="data set 58",
            value=len(values),
            allowed=n_values if isinstance(n_values, str) else str(n_values),
            remedy="the file is cut off",
        )
    return values[:n_values]


def _integer(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise InputError(
            "is not a whole number", field="data set 58 header", value=text, remedy="the header is damaged"
        ) from None


def _real(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")


def _unique(names: list[str]) -> tuple[str, ...]:
    """Number names that occur more than once: loggers write the same title into every data set."""
    return tuple(
        name if names.count(name) == 1 else f"{name}_{names[: i + 1].count(name)}"
        for i, name in enumerate(names)
    )
