"""JSON as users read it: ``null`` for what is not known, never NaN; long lists written as they are made."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jackettwin.files.atomic import atomic_path


@dataclass(frozen=True)
class Streamed:
    """A list of a document that is made anew, item by item, whenever it is read: it need not fit in memory.

    Examples
    --------
    >>> list(Streamed(lambda: (k * k for k in range(3))))
    [0, 1, 4]
    """

    items: Callable[[], Iterable[Any]]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.items())


def write_json(data: object, path: Path | str) -> None:
    """Write JSON with ``null`` for what is not known; never NaN. A mapping may hold ``Streamed`` lists."""
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8") as file:
        file.writelines(json_pieces(data))


def json_pieces(data: object) -> Iterator[str]:
    r"""Yield the text of a document, ending in a new line, a ``Streamed`` list item by item.

    >>> "".join(json_pieces({"a": Streamed(lambda: [1, float("nan")])}))
    '{\n "a": [\n1,\nnull]\n}\n'
    """
    if not isinstance(data, Mapping) or not any(isinstance(v, Streamed) for v in data.values()):
        yield _text(data) + "\n"
        return
    before = "{\n "
    for key, value in data.items():
        yield f"{before}{_text(str(key))}: "
        if isinstance(value, Streamed):
            yield from _listed(value)
        else:
            yield _text(value)
        before = ",\n "
    yield "\n}\n"


def null_for_nan(value: Any) -> Any:
    """Return plain JSON data: arrays to lists, NumPy numbers to Python's, NaN and infinity to None."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, complex):
        return [null_for_nan(value.real), null_for_nan(value.imag)]
    if isinstance(value, dict):
        return {str(key): null_for_nan(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [null_for_nan(item) for item in value]
    return value


def _listed(items: Iterable[Any]) -> Iterator[str]:
    before = "[\n"
    for item in items:
        yield before + _text(item)
        before = ",\n"
    yield "[]" if before == "[\n" else "]"


def _text(data: object) -> str:
    return json.dumps(null_for_nan(data), indent=1, ensure_ascii=False, allow_nan=False)
