"""Lines, values and tables of an OpenFAST input file.

Tables are found by the keyword of their count line and columns by their header, so the position of
neither matters (formats of SubDyn 0.4 to OpenFAST 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.errors import InputError
from jackettwin.files.yaml import read_text

Row = dict[str, str]


@dataclass(frozen=True)
class Deck:
    """The lines of a file and how to find things in them."""

    path: Path
    lines: tuple[str, ...]

    def find(self, *keywords: str, nth: int = 0) -> int | None:
        """Return the number of a line whose second word is one of the keywords: the nth after the first."""
        wanted = {keyword.lower() for keyword in keywords}
        words = (line.split() for line in self.lines)
        found = [at for at, word in enumerate(words) if len(word) > 1 and word[1].lower() in wanted]
        return found[nth] if nth < len(found) else None

    def scalar(self, keyword: str, default: str) -> str:
        """Return the value that stands before a keyword."""
        number = self.find(keyword)
        return default if number is None else self.lines[number].split()[0].strip('"')

    def numbers(self, keyword: str) -> tuple[float, ...]:
        """Return the numbers that stand before a keyword, however many; none if it is not there."""
        for at, line in enumerate(self.lines, start=1):
            words = line.replace(",", " ").split()
            lower = [word.lower() for word in words]
            if keyword.lower() in lower[1:]:
                before = words[: lower.index(keyword.lower(), 1)]
                return tuple(to_float(word, self.path, f"line {at}.{keyword}") for word in before)
        return ()

    def table(
        self, *keywords: str, required: bool = False, columns: tuple[str, ...] = (), nth: int = 0
    ) -> tuple[Row, ...]:
        """Return the rows of the table whose count line has one of the keywords; keys are the header's.

        ``columns`` are the first keys by position, for headers that name the first column only or name them
        otherwise: SubDyn itself reads by position. ``nth`` tells tables of one keyword apart.
        """
        number = self.find(*keywords, nth=nth)
        if number is None:
            if required:
                raise InputError(
                    "table is missing",
                    file=self.path,
                    field=keywords[0],
                    remedy="give a complete SubDyn input file",
                )
            return ()
        count = to_integer(self.lines[number].split()[0], self.path, keywords[0])
        header = self.lines[number + 1].lower().split() if number + 1 < len(self.lines) else []
        keys = header if len(header) > 1 else list(columns)
        if len(header) >= len(columns) and not set(columns) <= set(header):
            keys = [*columns, *header[len(columns) :]]
        return tuple(self._row(number + 3 + k, keys, keywords[0], count) for k in range(count))

    def _row(self, at: int, keys: list[str], keyword: str, count: int) -> Row:
        words = self.lines[at].split() if at < len(self.lines) else []
        if len(words) < min(len(keys), 2) or not words or words[0].startswith("---"):
            raise InputError(
                "table is shorter than its count",
                file=self.path,
                field=keyword,
                value=count,
                remedy="mend the count or the table",
            )
        return dict(zip(keys, words, strict=False)) | {"#": str(at + 1)}


def read_deck(path: Path) -> Deck:
    """Read an OpenFAST input file."""
    return Deck(path, tuple(read_text(path, what="SubDyn file").splitlines()))


def number(row: Row, key: str, path: Path) -> float:
    """Return the number in a column of a row."""
    if key not in row:
        raise InputError(
            "column is missing",
            file=path,
            field=f"line {row['#']}.{key}",
            remedy="give the row all its numbers and the table's header all its names",
        )
    return to_float(row[key], path, f"line {row['#']}.{key}")


def flag(row: Row, key: str, path: Path, *, default: bool) -> bool:
    """Return the 0 or 1 in a column of a row."""
    if key not in row:
        return default
    value = number(row, key, path)
    if value not in (0.0, 1.0):
        raise InputError(
            "not a flag", file=path, field=f"line {row['#']}.{key}", value=row[key], allowed="0, 1"
        )
    return value == 1.0


def to_float(word: str, path: Path, field: str) -> float:
    """Return a word as a finite number, Fortran's exponents included."""
    try:
        value = float(word.lower().replace("d", "e").rstrip(","))
    except ValueError:
        raise InputError("not a number", file=path, field=field, value=word) from None
    if not np.isfinite(value):
        raise InputError("not a finite number", file=path, field=field, value=word)
    return value


def to_integer(word: str, path: Path, field: str) -> int:
    """Return a word as a count."""
    value = to_float(word, path, field)
    if value != int(value) or value < 0:
        raise InputError("not a count", file=path, field=field, value=word, allowed="a whole number ≥ 0")
    return int(value)
