"""Lines, values and tables of an OpenFAST input file.

Tables are found by the keyword of their count line. SubDyn itself reads their columns by position, whatever
the header says, and so do we where the columns are known (formats of SubDyn 0.4 to OpenFAST 5); elsewhere the
header names them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.errors import InputError
from jackettwin.files.yaml import read_text


class SubdynRow(dict[str, str]):
    """A row of a table, column by column; ``#`` is the number of its line.

    A column that the row does not have is the file's fault, and named.
    """

    def __init__(self, values: Mapping[str, str], path: Path) -> None:
        super().__init__(values)
        self.path = path

    def __missing__(self, key: str) -> str:
        """Refuse the row.

        Raises
        ------
        InputError
            Names file, line and column.
        """
        raise InputError(
            "column is missing",
            file=self.path,
            field=f"line {self.get('#', '?')}.{key}",
            remedy="give the row all its numbers and the table's header all its names",
        )


_TEXT = ("ssifile",)
"""Optional columns that hold no number."""


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
        self,
        *keywords: str,
        required: bool = False,
        columns: tuple[str, ...] = (),
        optional: tuple[str, ...] = (),
        nth: int = 0,
    ) -> tuple[SubdynRow, ...]:
        """Return the rows of the table whose count line has one of the keywords.

        Parameters
        ----------
        columns, optional : keys by position
            What every row must have, and what follows in some formats; none: the header's words are the keys.
        nth : int
            Tells tables of one keyword apart.
        """
        number = self.find(*keywords, nth=nth)
        if number is None:
            if required:
                raise InputError(
                    "table is missing",
                    file=self.path,
                    field=keywords[0],
                    remedy="give a complete OpenFAST input file",
                )
            return ()
        count = to_integer(self.lines[number].split()[0], self.path, keywords[0])
        if count > len(self.lines):
            raise _short(self.path, keywords[0], count)
        header = self.lines[number + 1].lower().split() if number + 1 < len(self.lines) else []
        keys = [*columns, *optional] if columns else header
        rows = range(number + 3, number + 3 + count)
        return tuple(self._row(at, keys, len(columns), keywords[0], count) for at in rows)

    def header(self, *keywords: str) -> tuple[str, ...]:
        """Return the words of a table's header in lower case; none without the table."""
        number = self.find(*keywords)
        if number is None or number + 1 >= len(self.lines):
            return ()
        return tuple(self.lines[number + 1].lower().split())

    def _row(self, at: int, keys: list[str], needed: int, keyword: str, count: int) -> SubdynRow:
        words = self.lines[at].split() if at < len(self.lines) else []
        if len(words) < min(len(keys), 2) or not words or words[0].startswith("---"):
            raise _short(self.path, keyword, count)
        if needed:
            words = _without_remark(words, needed, keys)
        return SubdynRow(dict(zip(keys, words, strict=False)) | {"#": str(at + 1)}, self.path)


def _short(path: Path, keyword: str, count: int) -> InputError:
    return InputError(
        "table is shorter than its count",
        file=path,
        field=keyword,
        value=count,
        remedy="mend the count or the table",
    )


def _without_remark(words: list[str], needed: int, keys: list[str]) -> list[str]:
    """Return the words up to a remark: behind what every row has are numbers, and at most a file's name."""
    for at in range(needed, len(words)):
        names_file = at < len(keys) and keys[at] in _TEXT
        if words[at][0] in "!#" or words[at] == "-" or (words[at][0].isalpha() and not names_file):
            return words[:at]
    return words


def read_deck(path: Path) -> Deck:
    """Read an OpenFAST input file."""
    return Deck(path, tuple(read_text(path, what="SubDyn file").splitlines()))


def number(row: SubdynRow, key: str, path: Path) -> float:
    """Return the number in a column of a row."""
    return to_float(row[key], path, f"line {row['#']}.{key}")


def flag(row: SubdynRow, key: str, path: Path, *, default: bool) -> bool:
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
