"""Compression of documents: numbers as a column of 32 bits each, words by a dictionary.

An observation has some hundred numbers, of fewer than six significant digits, and words that are common to
all observations. Numbers are rounded to 18 binary digits (:func:`rounded`), in 32-bit floats; packing of
rounded documents is lossless.
"""

from __future__ import annotations

import json
import zlib
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray

_PLAIN, _COLUMNS = b"{", (b"\x01", b"\x02")
"""First bytes of a document as text, and of one in columns with the words of ``words_1.txt`` or ``_2.txt``.

Documents are packed with the newest words.
"""
FORGOTTEN = ""
"""Content of a document that was deleted by the store's policy."""
_PLACE = "\x02"
"""Placeholder in the text for a number of the column."""
_HALF_STEP, _KEPT = 0x20, 0xFFFFFFC0
"""Half of the last binary digit that is stored of a 32-bit float, and a mask of those that are."""
_SMALL, _LARGE = 1e-30, 1e30
"""Range of magnitudes in the column; other numbers remain in the text, as 32 bits would lose digits."""


def rounded(document: str) -> str:
    """Return a document with numbers rounded by at most 2⁻¹⁸ of each; rounding twice changes nothing."""
    return json.dumps(json.loads(document, parse_float=_rounded), ensure_ascii=False, separators=(",", ":"))


def _rounded(text: str) -> float:
    import numpy as np

    exact = float(text)
    if not _SMALL < abs(exact) < _LARGE:
        return exact
    bits = np.float32(exact).view(np.uint32)
    return float(str(((bits + np.uint32(_HALF_STEP)) & np.uint32(_KEPT)).view(np.float32)))


def pack(document: str) -> bytes:
    """Return the stored bytes of a document: as text if columns would lose a digit."""
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
    squeezed = zlib.compressobj(9, zlib.DEFLATED, -15, 9, zdict=_words(_COLUMNS[-1]))
    body = len(words).to_bytes(4, "little") + words + _planes(column)
    return _COLUMNS[-1] + squeezed.compress(body) + squeezed.flush()


def unpack(packed: bytes) -> str:
    """Return the document of :func:`pack`, or of an older version's text."""
    if packed[:1] == _PLAIN or not packed:
        return packed.decode()
    if packed[:1] not in _COLUMNS:
        raise ValueError("packed by a newer version")
    import numpy as np

    body = zlib.decompressobj(-15, zdict=_words(packed[:1])).decompress(packed[1:])
    end = 4 + int.from_bytes(body[:4], "little")
    column = np.frombuffer(body[end:], dtype=np.uint8).reshape(4, -1).T.copy().view("<f4").ravel()
    parts = body[4:end].decode().split(_PLACE)
    return "".join(x for pair in zip(parts, [*_decimals(column), ""], strict=True) for x in pair)


def _planes(column: FloatArray) -> bytes:
    """Return all first bytes of numbers, then all second bytes and so on, which compress better."""
    import numpy as np

    return column.view(np.uint8).reshape(-1, 4).T.tobytes()


def _decimals(column: FloatArray) -> list[str]:
    """Return the shortest decimals that give these 32-bit numbers, as Python writes them."""
    return [repr(float(str(x))) for x in column]


@cache
def _words(first: bytes) -> bytes:
    """Return the words of observations by frequency; never edited, as stored documents depend on them."""
    return (files("jackettwin.store") / f"words_{first[0]}.txt").read_bytes()
