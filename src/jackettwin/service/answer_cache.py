"""Answers that were given, kept with the version of the store they were made of: none is made twice."""

from __future__ import annotations

import gzip
import hashlib
from collections import OrderedDict
from dataclasses import dataclass, field
from threading import Lock

_MOST_BYTES = 32 * 2**20
"""Memory for answers: those of some hundred turbines' pages, compressed."""
_ENTRY_BYTES = 1024
"""What an answer takes beside its bytes: many small ones must not fill the memory either."""


@dataclass(frozen=True)
class Answer:
    """The body of an answer, compressed, and the version of the store that it was made of."""

    version: int
    compressed: bytes

    @classmethod
    def of(cls, version: int, body: bytes) -> Answer:
        """Return an answer to keep; its bytes depend on the body alone."""
        return cls(version, gzip.compress(body, compresslevel=1, mtime=0))

    @property
    def body(self) -> bytes:
        """What was compressed."""
        return gzip.decompress(self.compressed)

    @property
    def size(self) -> int:
        """Bytes that keeping it takes."""
        return len(self.compressed) + _ENTRY_BYTES


def content_tag(body: bytes) -> str:
    """Return the entity tag of a body that has no version."""
    return f'W/"{hashlib.sha256(body).hexdigest()[:32]}"'


def has_tag(header: str | None, tag: str) -> bool:
    """Tell whether ``If-None-Match`` names a tag; strong and weak ones are compared (RFC 9110, 13.1.2)."""
    return header is not None and tag.removeprefix("W/") in (
        t.strip().removeprefix("W/") for t in header.split(",")
    )


@dataclass
class AnswerCache:
    """The answers to the questions asked last, as many as there is memory for."""

    _answers: OrderedDict[str, Answer] = field(default_factory=OrderedDict)
    _bytes: int = 0
    _lock: Lock = field(default_factory=Lock)

    def find(self, asked: str, version: int) -> Answer | None:
        """Return the answer to a question if nothing has changed since it was given."""
        with self._lock:
            found = self._answers.get(asked)
            if found is None or found.version != version:
                return None
            self._answers.move_to_end(asked)
            return found

    def keep(self, asked: str, answer: Answer) -> None:
        """Keep an answer in place of an earlier one to the same question."""
        with self._lock:
            self._forget(asked)
            self._answers[asked] = answer
            self._bytes += answer.size + len(asked)
            while self._bytes > _MOST_BYTES:
                self._forget(next(iter(self._answers)))

    def _forget(self, asked: str) -> None:
        gone = self._answers.pop(asked, None)
        self._bytes -= 0 if gone is None else gone.size + len(asked)
