"""Documents in few bytes: their numbers as a column of 32 bits each, their words against a dictionary.

An observation is some hundred numbers, none of them known to seven digits, among words that are the same in
every other observation. Nine decimal digits at most are kept of a number (:func:`rounded`); packing what is
rounded loses nothing.
"""

from __future__ import annotations

import json
import zlib
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray

_PLAIN, _COLUMNS = b"{", b"\x01"
"""First bytes of a document as text, and of one in columns whose words are those of ``words_1.txt``."""
FORGOTTEN = ""
"""Stands for a document that was kept for as long as the store's policy says."""
_PLACE = "\x02"
"""Stands in the text for a number of the column."""
_SMALL, _LARGE = 1e-30, 1e30
"""Numbers beyond these are left in the text: 32 bits would not hold their digits."""


def rounded(document: str) -> str:
    """Return a document whose numbers have the digits that 32 bits hold: twice is as once."""
    return json.dumps(json.loads(document, parse_float=_rounded), ensure_ascii=False, separators=(",", ":"))


def _rounded(text: str) -> float:
    import numpy as np

    exact = float(text)
    return float(str(np.float32(exact))) if _SMALL < abs(exact) < _LARGE else exact


def pack(document: str) -> bytes:
    """Return the bytes that are kept of a document: as text, if columns would lose a digit of it."""
    if document == FORGOTTEN:
        return b""
    import numpy as np

    numbers: list[float] = []

    def placed(text: str) -> str | float:
        exact = float(text)
        if len(text) < 4 or not _SMALL < abs(exact) < _LARGE:
            return exact
        numbers.append(exact)
        return _PLACE

    skeleton = json.dumps(
        json.loads(document, parse_float=placed), ensure_ascii=False, separators=(",", ":")
    ).replace(json.dumps(_PLACE), _PLACE)
    column = np.array(numbers, dtype="<f4")
    if skeleton.count(_PLACE) != column.size or _decimals(column) != [repr(x) for x in numbers]:
        return document.encode()
    words = skeleton.encode()
    squeezed = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zdict=_words())
    body = len(words).to_bytes(4, "little") + words + _planes(column)
    return _COLUMNS + squeezed.compress(body) + squeezed.flush()


def unpack(packed: bytes) -> str:
    """Return the document that :func:`pack` was given, or that an older version kept as text."""
    if packed[:1] == _PLAIN or not packed:
        return packed.decode()
    if packed[:1] != _COLUMNS:
        raise ValueError("packed by a newer version")
    import numpy as np

    body = zlib.decompressobj(-15, zdict=_words()).decompress(packed[1:])
    end = 4 + int.from_bytes(body[:4], "little")
    column = np.frombuffer(body[end:], dtype=np.uint8).reshape(4, -1).T.copy().view("<f4").ravel()
    parts = body[4:end].decode().split(_PLACE)
    return "".join(x for pair in zip(parts, [*_decimals(column), ""], strict=True) for x in pair)


def _planes(column: FloatArray) -> bytes:
    """Return first bytes, then second bytes, ... of numbers: their exponents are alike."""
    import numpy as np

    return column.view(np.uint8).reshape(-1, 4).T.tobytes()


def _decimals(column: FloatArray) -> list[str]:
    """Return the shortest decimals that are these numbers in 32 bits, as Python writes them."""
    return [repr(float(str(x))) for x in column]


@cache
def _words() -> bytes:
    """Return the words of observations, most frequent last; never edited, since what is stored needs them."""
    return (files("jackettwin.store") / "words_1.txt").read_bytes()
