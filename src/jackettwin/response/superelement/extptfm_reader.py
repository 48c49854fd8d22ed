"""Reader of superelement files of OpenFAST's module ExtPtfm.

The module's input file names the file of the matrices, in which keywords begin with ``!``. For OpenFAST 5 a
matrix follows its keyword directly, and the self-weight is given as blocks. For earlier versions (FlexASCII,
format 1) a row of dimensions stands between, and the self-weight is a table over time. Format 0 (Guyan) has
six coordinates, read by line number.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, require
from jackettwin.files import read_text
from jackettwin.response.superelement.craig_bampton import INTERFACE, Superelement

MATRICES = ("mass", "stiffness", "damping")
"""First words of the matrices' headers."""
_GUYAN_LINES = {"mass": 2, "damping": 9, "stiffness": 16, "loads": 25}
"""Number of lines before each matrix and before the table of loads in format 0."""


def is_extptfm(path: Path) -> bool:
    """Return whether a file is an input file of ExtPtfm or a superelement in one of its formats."""
    return _kind(read_text(path).splitlines()) is not None


def read_extptfm(path: Path) -> Superelement:
    """Read a superelement, given its file or the module's input file that names it.

    Raises
    ------
    InputError
        If a file is missing or incomplete.
    """
    text = read_text(path, what="superelement file")
    lines = text.splitlines()
    kind = _kind(lines)
    if kind != "input":
        return _whole(text, path, guyan=kind == "guyan")
    named = path.parent / _value(lines, "Red_FileName", path).strip("\"' ").replace("\\", "/")
    # OpenFAST 5 has no format switch: its file has keywords
    form = "1" if _has(lines, "RBMod") else _value(lines, "FileFormat", path).strip()
    if form not in ("0", "1"):
        raise InputError(
            "unknown format",
            file=path,
            field="FileFormat",
            value=form,
            allowed="0 (Guyan), 1 (FlexASCII)",
            remedy="write the superelement in one of these",
        )
    whole = _whole(read_text(named, what="superelement file"), named, guyan=form == "0")
    return _active(whole, lines, path)


def _whole(text: str, path: Path, *, guyan: bool) -> Superelement:
    return _guyan(text.splitlines(), path) if guyan else parse_keywords(text, path)


def _kind(lines: list[str]) -> str | None:
    first, second, third = [*(line.lower() for line in lines[:3]), "", "", ""][:3]
    if "extptfm" in first and "input" in first:
        return "input"
    words = [line.lower() for line in lines]
    if "flex 5 format" in second or all(_at(words, key) is not None for key in ("!dimension", "!mass")):
        return "keywords"
    return "guyan" if "mass" in second and _are_numbers(third.split()[:INTERFACE]) else None


def _are_numbers(words: list[str]) -> bool:
    return len(words) == INTERFACE and all(re.fullmatch(r"[-+.\deEdD]+", word) for word in words)


def _has(lines: list[str], key: str) -> bool:
    return any(re.search(rf"\s{key}\b", line) for line in lines)


def _value(lines: list[str], key: str, path: Path) -> str:
    """Return the text before a keyword: a quoted text, a word, or numbers."""
    value = r"""(".*?"|'.*?'|[^\s,]+(?:[\s,]+[-+.\d]+)*)"""
    for line in lines:
        found = re.match(rf"\s*{value},?\s+{key}\b", line)
        if found:
            return found[1]
    raise InputError("keyword is missing", file=path, field=key, remedy="is it ExtPtfm's input file?")


def _active(whole: Superelement, lines: list[str], path: Path) -> Superelement:
    """Return the superelement with the internal coordinates that are active in the input file."""
    number, given = (_value(lines, key, path) for key in ("NActiveDOFList", "ActiveDOFList"))
    try:
        count = int(number)
        wanted = [int(word) for word in given.replace(",", " ").split()[: max(count, 0)]]
    except ValueError:
        raise InputError(
            "not whole numbers", file=path, field="ActiveDOFList", value=given, remedy="write e.g. 1, 2, 3"
        ) from None
    inner = whole.n - INTERFACE
    if count < 0:
        return whole
    if len(wanted) < count or any(not 1 <= k <= inner for k in wanted):
        raise InputError(
            "no such internal coordinates",
            file=path,
            field="ActiveDOFList",
            value=wanted,
            allowed=f"{count} numbers from 1 to {inner}",
            remedy="correct the list, or use all with NActiveDOFList -1",
        )
    at = [*range(INTERFACE), *(INTERFACE - 1 + k for k in wanted)]
    M, C, K = (matrix[np.ix_(at, at)] for matrix in (whole.M, whole.C, whole.K))
    return Superelement(M, C, K, whole.reference_m, whole.weight_n[at], whole.basis[:, at])


def _guyan(lines: list[str], path: Path) -> Superelement:
    """Return the superelement of a text in format 0: six coordinates, read by line number."""
    M, C, K = (
        _matrix(lines[(at := _GUYAN_LINES[name]) : at + INTERFACE], INTERFACE, path, name, rows=INTERFACE)
        for name in ("mass", "damping", "stiffness")
    )
    first = lines[_GUYAN_LINES["loads"] : _GUYAN_LINES["loads"] + 1]
    weight = np.zeros(INTERFACE)
    if first and first[0].strip():
        weight = _matrix(first, INTERFACE + 1, path, "loads", rows=1)[0, 1:]
    return Superelement(M, C, K, (0.0, 0.0, 0.0), weight, np.empty((0, INTERFACE)))


def parse_keywords(text: str, path: Path) -> Superelement:
    """Return the superelement of a text with keywords, by the rules of OpenFAST 5 or of earlier versions.

    Raises
    ------
    InputError
        If the dimension or a matrix is missing, or a row is too short.
    """
    lines = text.splitlines()
    words = [line.lower() for line in lines]
    dimension = next((m for line in words if (m := re.match(r"!dimension:?\s*(\d+)", line))), None)
    if dimension is None or _at(words, "!mass") is None:
        raise InputError(
            "not a superelement of ExtPtfm",
            file=path,
            field="!Dimension",
            remedy="give the matrices' file, or ExtPtfm's input file that names it",
        )
    n = int(dimension[1])
    if n < INTERFACE:
        raise InputError(
            "fewer coordinates than an interface has",
            file=path,
            field="!Dimension",
            value=n,
            allowed="≥ 6",
            remedy="check the file",
        )
    M, K, C = (_block(lines, words, name, n, path) for name in MATRICES)
    softened = (
        0.0 if _at(words, "!weight stiffness") is None else _block(lines, words, "weight stiffness", n, path)
    )
    weight = _weight(lines, words, n, path)
    return Superelement(M, C, K + softened, (0.0, 0.0, 0.0), weight, np.empty((0, n)))


def _at(words: list[str], keyword: str) -> int | None:
    """Return the line that starts with a keyword."""
    return next((number for number, line in enumerate(words) if line.startswith(keyword)), None)


def _block(lines: list[str], words: list[str], name: str, n: int, path: Path, *, rows: int = 0) -> FloatArray:
    """Return the rows below a header and an optional row of dimensions; n × n unless ``rows`` is given."""
    at = _at(words, f"!{name}")
    if at is None:
        raise InputError(
            "matrix is missing", file=path, field=f"!{name}", remedy="add it, or write the file anew"
        )
    first = at + 2 if words[at + 1 : at + 2] and words[at + 1].startswith("!") else at + 1
    return _matrix(lines[first : first + (rows or n)], n, path, name, rows=rows or n)


def _weight(lines: list[str], words: list[str], n: int, path: Path) -> FloatArray:
    """Return the constant load: the block of OpenFAST 5, or the first row of the table over time."""
    if _at(words, "!weight constant") is not None:
        return np.asarray(_block(lines, words, "weight constant", n, path, rows=1)[0])
    at = _at(words, "!loading")
    if at is None or len(lines) <= at + 2:
        return np.zeros(n)
    return np.asarray(_matrix(lines[at + 2 : at + 3], n + 1, path, "loading", rows=1)[0, 1:])


def _matrix(lines: list[str], n: int, path: Path, name: str, *, rows: int) -> FloatArray:
    try:
        matrix = np.array([[float(word.replace("D", "E")) for word in row.split()[:n]] for row in lines])
    except ValueError:
        raise InputError(
            "rows are not numbers, or differ in length", file=path, field=name, remedy="check the file"
        ) from None
    if matrix.shape != (rows, n):
        raise InputError(
            "matrix has the wrong shape",
            file=path,
            field=name,
            value=matrix.shape,
            allowed=f"{n} columns",
            remedy="check the file",
        )
    require(np.isfinite(matrix).all(), "not finite", file=path, field=name, remedy="check the file")
    return np.asarray(matrix)
