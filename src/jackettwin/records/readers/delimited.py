"""Delimited text (CSV): header row, optional units row, numbers; the dialect is found, not asked.

``#`` lines before the header, and whatever a logger writes above its table, may hold ``key: value``:
the rate, the start, the zone of the clock.
Comma, semicolon, tab, bar or blanks separate; a decimal comma is understood wherever the comma does not
separate. Units may stand in a row of their own or in brackets behind the names. Empty cells, ``nan``,
``NA``, ``null`` and the like are missing samples. Columns without names are numbered; the four lines on
top of a TOA5 table (Campbell) are understood.
"""

from __future__ import annotations

import csv
import io
import re
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError
from jackettwin.records.readers.stamps import (
    has_zone,
    is_stamp,
    parse_time,
    read_zone,
    stamps,
    with_one_stamp,
)
from jackettwin.records.readers.table import ReadTable, climbs_evenly, table_from_columns

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jackettwin.records.record import Record

MISSING = {
    "",
    "nan",
    "na",
    "n/a",
    "null",
    "none",
    "-",
    "--",
    "–",
    "#n/a",
    "n.a.",
    "k.a.",
    "inf",
    "-inf",
    "+inf",
}
RATE_KEYS = (
    "sample_rate_hz",
    "sample_rate",
    "samplerate",
    "sampling_rate",
    "samplingrate",
    "sampling_frequency",
    "samplingfrequency",
    "fs",
    "fsamp",
    "abtastrate",
)
ZONE_KEYS = ("timezone", "zone", "tz", "clock", "zeitzone")
ROWS = 15_000
"""Lines of a table when a file is read in pieces: as texts some ten megabytes."""
MOST_LINES_ON_TOP = 200
"""Lines looked at for comments, names and units."""
ROWS_OF_A_TABLE = 3
"""Rows of numbers, equally long and one below the other, by which a table is known below other text."""
SNIFFED_BYTES = 1 << 16
"""Of a text file, read to tell its encoding."""
_BRACKETED = re.compile(r"^(?P<name>.*\S)\s*[\[(](?P<unit>[^\[\]()]*(?:\([^()]*\))?)[\])]$")
_DECIMAL_COMMA = re.compile(r"^[+-]?\d+,\d+([eE][+-]?\d+)?$")


def read(path: Path) -> ReadTable:
    """Read names, units and numbers.

    Raises
    ------
    InputError
        Names the line and the cell that is not understood.
    """
    return _table(decoded(path.read_bytes()).splitlines())


def pieces(path: Path) -> Iterator[ReadTable]:
    """Yield tables of ``ROWS`` lines; each is read with the lines on top of the file above it.

    Raises
    ------
    InputError
        Names the line and the cell that is not understood.
    """
    with path.open(encoding=_encoding(path), errors="replace", newline=None) as stream:
        top = [line.rstrip("\n") for line in islice(stream, MOST_LINES_ON_TOP)]
        head = _lines_on_top(top)
        lines, above = top[head:], 0
        while lines or above == 0:
            lines += [line.rstrip("\n") for line in islice(stream, max(ROWS - len(lines), 0))]
            if above == 0 or any(line.strip() for line in lines):
                yield _table(top[:head] + lines, above)
            above += max(len(lines), 1)
            lines = [line.rstrip("\n") for line in islice(stream, 1)]


def _lines_on_top(lines: list[str]) -> int:
    """Return how many lines stand above the numbers: comments, names, units."""
    further = len(lines) - len(_without_toa5(lines))
    lines = _without_toa5(lines)
    _, start, delimiter = _preamble(lines)
    for count, line in enumerate(lines[start:]):
        cells = _cells(line, delimiter)
        if cells and _is_data(cells[0], delimiter):
            return further + start + count
    return further + len(lines)


def _encoding(path: Path) -> str:
    """Return the encoding of a text file: by its mark, else UTF-8 if its beginning is, else cp1252."""
    with path.open("rb") as stream:
        raw = stream.read(SNIFFED_BYTES)
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        raw[: raw.rfind(b"\n") + 1].decode("utf-8-sig")
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def _table(lines: list[str], above: int = 0) -> ReadTable:
    """Return what lines hold; ``above`` lines of numbers were left out between the top and the others."""
    lines = _without_toa5(lines)
    comments, start, delimiter = _preamble(lines)
    rows = [row for row in _cells("\n".join(lines[start:]), delimiter) if any(cell.strip() for cell in row)]
    if not rows:
        raise InputError(
            "holds no rows", field="data", allowed="names and numbers", remedy="export the file again"
        )
    bare = _is_data(rows[0], delimiter)
    names, units = _numbered(rows[0]) if bare else _names_and_units(rows[0])
    body = rows if bare else rows[1:]
    if body and not _is_data(body[0], delimiter):
        units = {name: cell.strip() for name, cell in zip(names, body[0], strict=False) if cell.strip()}
        body = body[1:]
    first_line = start + len(rows) - len(body) + 1 + above
    _refuse_further_cells(names, body, delimiter, first_line)
    names, body = with_one_stamp(names, body)
    columns = [_column(i, name, body, delimiter, first_line) for i, name in enumerate(names)]
    if bare and climbs_evenly(columns[0]):
        names[0] = ""  # a count or a time, as an index without a name is
    known = _known(comments)
    if "start_utc" not in known and any(has_zone(cell) for cell in (body[0] if body else ())):
        known["zone_said"] = True
    return table_from_columns(names, columns, units, **known)


def write(record: Record, path: Path) -> None:
    """Write names, a units row and the numbers to full precision; missing samples as empty cells."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(record.channel_names)
        writer.writerow([channel.unit for channel in record.channels])
        writer.writerows(["" if x != x else repr(x) for x in row] for row in record.data.T.tolist())


def decoded(raw: bytes) -> str:
    """Return the text of a file: in the encoding its mark tells, else UTF-8, else that of spreadsheets."""
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")  # what spreadsheets write for ² and µ


@dataclass(frozen=True)
class TextTable:
    """The cells of a delimited text, without comments and empty lines, and what separates them."""

    delimiter: str
    rows: list[list[str]]


def text_table(raw: bytes) -> TextTable:
    r"""Return the cells of a table of words and numbers, whatever its encoding and separator.

    Lines that begin with ``#`` are comments. Cells stay text: a decimal comma is for the caller to read.

    Examples
    --------
    >>> text_table("# a jacket\nmode; f [Hz]\n1st bending; 0,312\n".encode("cp1252"))
    TextTable(delimiter=';', rows=[['mode', 'f [Hz]'], ['1st bending', '0,312']])
    """
    lines = [line for line in decoded(raw).splitlines() if line.strip() and not line.lstrip().startswith("#")]
    delimiter = _delimiter(lines[:MOST_LINES_ON_TOP])
    rows = _cells("\n".join(lines), delimiter)
    return TextTable(delimiter, [[cell.strip() for cell in row] for row in rows])


def _preamble(lines: list[str]) -> tuple[dict[str, str], int, str]:
    """Return what the lines above a table say by their keys, how many they are, and the table's separator."""
    start = next((i for i, line in enumerate(lines) if not line.lstrip().startswith("#")), len(lines))
    delimiter = _delimiter(lines[start : start + MOST_LINES_ON_TOP])
    start += _text_above(lines[start : start + MOST_LINES_ON_TOP], delimiter)
    comments: dict[str, str] = {}
    for line in lines[:start]:
        key, value, *_ = [
            *re.split(f"[:={re.escape(delimiter.strip())}]", line.lstrip("# \t"), maxsplit=1),
            "",
        ]
        if value.strip():
            comments[key.strip()] = value.strip().strip('"')
    return comments, start, delimiter


def _text_above(lines: list[str], delimiter: str) -> int:
    """Return how many lines of other text stand above the names of a table.

    Where the first line is as long as the rows of numbers, or no line above these is, there are none.
    """
    rows = [_cells(line, delimiter) for line in lines]
    lengths = [len(row[0]) if row else 0 for row in rows]
    for i in range(1, len(rows) - ROWS_OF_A_TABLE + 1):
        block = range(i, i + ROWS_OF_A_TABLE)
        if lengths[i] > 1 and all(
            lengths[k] == lengths[i] and _is_data(rows[k][0], delimiter) for k in block
        ):
            top = i
            while top > 0 and lengths[top - 1] == lengths[i] and not _is_data(rows[top - 1][0], delimiter):
                top -= 1
            return top if top < i and lengths[0] != lengths[i] else 0
    return 0


def _without_toa5(lines: list[str]) -> list[str]:
    """Return the lines without what Campbell's TOA5 tables put above the names and below the units."""
    if not lines or not lines[0].lstrip('"').startswith("TOA5"):
        return lines
    return [*lines[1:3], *lines[4:]]


def _numbered(row: list[str]) -> tuple[list[str], dict[str, str]]:
    """Return names for columns that have none."""
    return [f"column_{i + 1}" for i in range(len(row))], {}


def _known(comments: dict[str, str]) -> dict[str, Any]:
    known: dict[str, Any] = {}
    rate = next((key for key in comments if re.sub(r"[ _]+", "_", key.lower()) in RATE_KEYS), None)
    if rate is not None:
        known["sample_rate_hz"] = _rate(rate, comments.pop(rate))
    if "start_utc" in comments:
        known["start_utc"] = parse_time(comments.pop("start_utc"))
    said = [text for key, text in comments.items() if re.sub(r"[ _-]+", "", key.lower()) in ZONE_KEYS]
    known["clock"] = next((zone for text in said for zone in _zones(text)), None)
    return {**known, "metadata": comments}


def _zones(text: str) -> Iterator[str]:
    """Yield the zones that a comment names: ``Europe/Berlin (local time)``, ``(UTC+01:00) Berlin``."""
    for part in (text, text.split("(")[0], *re.findall(r"\((.*?)\)", text)):
        try:
            read_zone(part)
        except InputError:
            continue
        yield part.strip()


def _rate(key: str, text: str) -> float:
    try:
        rate = float(text.lower().removesuffix("hz").replace(",", "."))
    except ValueError:
        rate = float("nan")
    if not 0.0 < rate < float("inf"):
        raise InputError(
            "is not a rate", field=key, value=text, allowed="> 0 Hz", remedy="state the rate in Hz"
        )
    return rate


def _delimiter(lines: list[str]) -> str:
    """Return the separator that splits most of the first lines into the same number of cells.

    Blanks separate where nothing else does, but not in a single column with a blank in its name.
    """
    in_last = len(lines[-1].split()) if lines else 0
    best, most = "\t" if in_last == 1 else " ", 0
    for candidate in ";\t|,":
        counts = [line.count(candidate) for line in lines if line.strip()]
        usual = max(set(counts), key=counts.count) if counts else 0
        agreeing = counts.count(usual) if usual else 0
        if agreeing > most:
            best, most = candidate, agreeing
    return best


def _cells(text: str, delimiter: str) -> list[list[str]]:
    if delimiter == " ":
        return [line.split() for line in text.splitlines()]
    try:
        return list(csv.reader(io.StringIO(text), delimiter=delimiter, skipinitialspace=True))
    except csv.Error as error:
        raise InputError(
            f"is not delimited text: {error}",
            field="data",
            allowed="rows of cells with one separator",
            remedy="export the file again",
        ) from error


def _is_data(row: list[str], delimiter: str) -> bool:
    """Tell whether half of the cells are numbers or times: names and units are neither."""
    known = [text for cell in row if (text := cell.strip()).lower() not in MISSING]
    return 0 < len(known) <= 2 * sum(_is_value(text, delimiter) for text in known)


def _is_value(cell: str, delimiter: str) -> bool:
    try:
        return not isnan(float(_with_point(cell, delimiter)))
    except ValueError:
        return is_stamp(cell)


def _names_and_units(row: list[str]) -> tuple[list[str], dict[str, str]]:
    names, units = [], {}
    for cell in row:
        match = _BRACKETED.match(cell.strip())
        name = match["name"].rstrip("_ ") if match else cell.strip()
        if match:
            units[name] = match["unit"]
        names.append(name)
    while names and not names[-1]:  # a separator at the end of the line
        names.pop()
    if not all(names[1:]):  # the first may be an index
        number = names.index("", 1) + 1
        raise InputError(
            "a column has no name",
            field=f"column {number}",
            value=", ".join(names),
            allowed="one name a column",
            remedy="name every column",
        )
    return names, units


def _refuse_further_cells(names: list[str], rows: list[list[str]], delimiter: str, line: int) -> None:
    """Refuse rows with more cells than there are names: nobody knows which cell belongs to which name."""
    for k, row in enumerate(rows):
        if not any(cell.strip() for cell in row[len(names) :]):
            continue
        if delimiter == "," and len(row) > 2 * len(names) - 2:
            problem, remedy = (
                "decimal commas and commas between the columns",
                "a semicolon between the columns",
            )
        else:
            problem, remedy = "row has more cells than there are names", "one name a column"
        raise InputError(
            problem,
            field=f"line {line + k}",
            value=delimiter.join(row),
            allowed=f"{len(names)} cells: {', '.join(names)}",
            remedy=f"export the file again with {remedy}",
        )


def _column(i: int, name: str, rows: list[list[str]], delimiter: str, line: int) -> npt.NDArray[Any]:
    cells = [row[i] if i < len(row) else "" for row in rows]
    with suppress(ValueError):  # all at once; what is not so plain is read cell by cell
        return np.array(cells if delimiter == "," else [cell.replace(",", ".") for cell in cells], np.float64)
    if cells and is_stamp(cells[0]):
        return stamps(cells, line)
    known = [cell for cell in cells if cell.strip().lower() not in MISSING]
    if known and not any(_is_value(cell.strip(), delimiter) for cell in known):
        return np.array(cells)  # words: not a signal
    return np.array([_number(cell, delimiter, name, line + k) for k, cell in enumerate(cells)])


def _with_point(cell: str, delimiter: str) -> str:
    return cell.replace(",", ".") if delimiter != "," and _DECIMAL_COMMA.match(cell) else cell


def _number(cell: str, delimiter: str, name: str, line: int) -> float:
    text = _with_point(cell.strip(), delimiter)
    if text.lower() in MISSING:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise InputError(
            "is not a number",
            field=f"line {line}, channel {name}",
            value=cell,
            allowed="a number or an empty cell",
            remedy="mend the cell; write times as 2025-01-01T13:00:00Z",
        ) from None
