"""Parsing of lines, values and tables of OpenFAST input files (SubDyn, HydroDyn, ElastoDyn).

Tables are found by the keyword of their count line. SubDyn itself reads their columns by position, whatever
the header says, and so do we where the columns are known (formats of SubDyn 0.4 to OpenFAST 5); elsewhere the
header names them. Errors name line and column; a reader adds the file to them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.errors import InputError, require
from jackettwin.files import read_text

_TEXT = ("ssifile",)
"""Optional columns that hold no number."""


class DeckRow(dict[str, str]):
    """A row of a table, column by column; ``line`` is the number of its line in the file, from 1.

    A column that the row does not have is the file's fault, and named.
    """

    def __init__(self, values: Mapping[str, str], line: int) -> None:
        super().__init__(values)
        self.line = line

    def __missing__(self, key: str) -> str:
        """Refuse the row.

        Raises
        ------
        InputError
            Names line and column.
        """
        raise InputError(
            "column is missing",
            field=self.place(key),
            remedy="give the row all its numbers and the table's header all its names",
        )

    def place(self, key: str) -> str:
        """Return where a column of the row stands."""
        return f"line {self.line}.{key}"

    def numbers(self, *keys: str) -> list[float]:
        """Return the numbers in some columns."""
        return [to_float(self[key], self.place(key)) for key in keys]

    def number(self, key: str, default: float | None = None) -> float:
        """Return the number in a column; its default in a format without the column."""
        return default if default is not None and key not in self else self.numbers(key)[0]

    def flag(self, key: str, *, default: bool) -> bool:
        """Return the 0 or 1 in a column."""
        value = self.number(key, float(default))
        require(value in (0.0, 1.0), "not a flag", field=self.place(key), value=self.get(key), allowed="0, 1")
        return value == 1.0


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

    def number(self, keyword: str) -> float:
        """Return the number that stands before a keyword.

        Raises
        ------
        InputError
            If the keyword is missing, or no number stands there.
        """
        text = self.scalar(keyword, "")
        require(text, "keyword is missing", field=keyword, remedy="give an ElastoDyn input file")
        return to_float(text, keyword)

    def numbers(self, keyword: str) -> tuple[float, ...]:
        """Return the numbers that stand before a keyword, however many; none if it is not there."""
        for at, line in enumerate(self.lines, start=1):
            words = line.replace(",", " ").split()
            lower = [word.lower() for word in words]
            if keyword.lower() in lower[1:]:
                before = words[: lower.index(keyword.lower(), 1)]
                return tuple(to_float(word, f"line {at}.{keyword}") for word in before)
        return ()

    def table(
        self,
        *keywords: str,
        required: bool = False,
        columns: tuple[str, ...] = (),
        optional: tuple[str, ...] = (),
        nth: int = 0,
    ) -> tuple[DeckRow, ...]:
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
            remedy = "give a complete OpenFAST input file"
            require(not required, "table is missing", field=keywords[0], remedy=remedy)
            return ()
        count = to_integer(self.lines[number].split()[0], keywords[0])
        if count > len(self.lines):
            raise _short(keywords[0], count)
        header = self.lines[number + 1].lower().split() if number + 1 < len(self.lines) else []
        keys = [*columns, *optional] if columns else header
        rows = range(number + 3, number + 3 + count)
        return tuple(self._row(at, keys, len(columns), keywords[0], count) for at in rows)

    def table_below(self, word: str, count: int) -> tuple[DeckRow, ...]:
        """Return the rows of the table whose header begins with a word, wherever its count stands."""
        for at, line in enumerate(self.lines):
            header = line.lower().split()
            if header[:1] == [word.lower()]:
                rows = range(at + 2, min(at + 2 + count, len(self.lines)))
                return tuple(
                    DeckRow(dict(zip(header, self.lines[k].split(), strict=False)), k + 1) for k in rows
                )
        return ()

    def header(self, *keywords: str) -> tuple[str, ...]:
        """Return the words of a table's header in lower case; none without the table."""
        number = self.find(*keywords)
        if number is None or number + 1 >= len(self.lines):
            return ()
        return tuple(self.lines[number + 1].lower().split())

    def _row(self, at: int, keys: list[str], needed: int, keyword: str, count: int) -> DeckRow:
        words = self.lines[at].split() if at < len(self.lines) else []
        if len(words) < min(len(keys), 2) or not words or words[0].startswith("---"):
            raise _short(keyword, count)
        if needed:
            words = _without_remark(words, needed, keys)
        return DeckRow(dict(zip(keys, words, strict=False)), at + 1)


def _short(keyword: str, count: int) -> InputError:
    remedy = "mend the count or the table"
    return InputError("table is shorter than its count", field=keyword, value=count, remedy=remedy)


def _without_remark(words: list[str], needed: int, keys: list[str]) -> list[str]:
    """Return the words up to a remark: behind what every row has are numbers, and at most a file's name."""
    for at in range(needed, len(words)):
        names_file = at < len(keys) and keys[at] in _TEXT
        if words[at][0] in "!#" or words[at] == "-" or (words[at][0].isalpha() and not names_file):
            return words[:at]
    return words


def read_deck(path: Path, what: str = "SubDyn file") -> Deck:
    """Read an OpenFAST input file."""
    return Deck(path, tuple(read_text(path, what=what).splitlines()))


def to_float(word: str, field: str) -> float:
    """Return a word as a finite number, Fortran's exponents included."""
    try:
        value = float(word.lower().replace("d", "e").rstrip(","))
    except ValueError:
        raise InputError("not a number", field=field, value=word) from None
    require(np.isfinite(value), "not a finite number", field=field, value=word)
    return value


def to_integer(word: str, field: str) -> int:
    """Return a word as a count."""
    value = to_float(word, field)
    whole = value == int(value) and value >= 0
    require(whole, "not a count", field=field, value=word, allowed="a whole number ≥ 0")
    return int(value)
