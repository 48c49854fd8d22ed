"""Text as careless hands and other programs leave it: mutated words, columns, lines, headers, encodings."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

WORDS = (
    *("", "nan", "-inf", "1e400", "-1", "0", "1e-300", "999999999999999999999", "abc", "ü", "1,5", "true"),
    *("null", "[1, 2]", "{a: b}", "'", '"', "-", "---", "!", "&a", "*a", "0x1F", "1.5 m", "2025-13-45", "~"),
    *("\x00", "::"),
)


def mutated(text: str, rng: random.Random) -> bytes:
    """Return the text after one to three mutations, in some encoding."""
    for _ in range(rng.randint(1, 3)):
        text = rng.choice(MUTATIONS)(text, rng)
    encoding = rng.choice(("utf-8",) * 6 + ("utf-8-sig", "utf-16", "latin-1", "cp1252"))
    raw = text.encode(encoding, errors="replace")
    if rng.random() < 0.1:
        raw = raw.replace(b"\n", b"\r\n")
    return raw[: rng.randrange(len(raw) + 1)] if rng.random() < 0.1 else raw


def _word(text: str, rng: random.Random) -> str:
    found = list(re.finditer(r"[^\s,:;]+", text))
    if not found:
        return text
    at = rng.choice(found)
    return text[: at.start()] + rng.choice(WORDS) + text[at.end() :]


def _word_away(text: str, rng: random.Random) -> str:
    found = list(re.finditer(r"[^\s,;]+[\s,;]*", text))
    at = rng.choice(found) if found else None
    return text if at is None else text[: at.start()] + text[at.end() :]


def _lines(change: Callable[[list[str], int, int], None]) -> Callable[[str, random.Random], str]:
    def mutation(text: str, rng: random.Random) -> str:
        lines = text.splitlines(keepends=True) or [""]
        change(lines, rng.randrange(len(lines)), rng.randrange(len(lines)))
        return "".join(lines)

    return mutation


def _swap(lines: list[str], i: int, j: int) -> None:
    lines[i], lines[j] = lines[j], lines[i]


def _column_away(text: str, rng: random.Random) -> str:
    """Leave out the same column of ten lines in a row."""
    lines = text.splitlines(keepends=True) or [""]
    first, column = rng.randrange(len(lines)), rng.randrange(4)
    for k in range(first, min(first + 10, len(lines))):
        parts = re.split(r"([\s,;]+)", lines[k])
        lines[k] = "".join(parts[: 2 * column] + parts[2 * column + 2 :])
    return "".join(lines)


MUTATIONS: tuple[Callable[[str, random.Random], str], ...] = (
    *(_word,) * 5,
    _word_away,
    _column_away,
    _lines(lambda lines, i, j: lines.pop(i) and None),
    _lines(lambda lines, i, j: lines.insert(i, lines[j])),
    _lines(lambda lines, i, j: lines.__setitem__(i, lines[i].upper())),
    _lines(lambda lines, i, j: lines.__setitem__(i, " " * (j % 5) + lines[i])),
    _lines(_swap),
    lambda text, rng: text.replace(rng.choice((",", ";", "\t", ": ", "  ", ".")), rng.choice(";\t ")),
)
