"""Cache of responses with the version of the store that they were made from."""

from __future__ import annotations

import gzip
import hashlib
from collections import OrderedDict
from dataclasses import dataclass, field
from threading import Lock

_MOST_BYTES = 32 * 2**20
"""Memory of the cache, for the compressed pages of some hundred turbines."""
_ENTRY_BYTES = 1024
"""Memory assumed for an entry besides its body, which also bounds many small ones."""


@dataclass(frozen=True)
class Answer:
    """Compressed body of a response, and the version of the store that it was made from."""

    version: int
    compressed: bytes

    @classmethod
    def of(cls, version: int, body: bytes) -> Answer:
        """Return an entry, whose bytes depend on the body only."""
        return cls(version, gzip.compress(body, compresslevel=1, mtime=0))

    @property
    def body(self) -> bytes:
        """The body, uncompressed."""
        return gzip.decompress(self.compressed)

    @property
    def size(self) -> int:
        """Memory of the entry in bytes."""
        return len(self.compressed) + _ENTRY_BYTES


def content_tag(body: bytes) -> str:
    """Return the entity tag of a body without a version."""
    return f'W/"{hashlib.sha256(body).hexdigest()[:32]}"'


def has_tag(header: str | None, tag: str) -> bool:
    """Return whether ``If-None-Match`` contains a tag, by weak comparison (RFC 9110, 13.1.2)."""
    return header is not None and tag.removeprefix("W/") in (
        t.strip().removeprefix("W/") for t in header.split(",")
    )


@dataclass
class AnswerCache:
    """Cache of the most recently used responses, as many as the memory allows."""

    _answers: OrderedDict[str, Answer] = field(default_factory=OrderedDict)
    _bytes: int = 0
    _lock: Lock = field(default_factory=Lock)

    def find(self, asked: str, version: int) -> Answer | None:
        """Return the stored response to a request if the store has not changed since."""
        with self._lock:
            found = self._answers.get(asked)
            if found is None or found.version != version:
                return None
            self._answers.move_to_end(asked)
            return found

    def keep(self, asked: str, answer: Answer) -> None:
        """Store a response, replacing an earlier one to the same request."""
        with self._lock:
            self._forget(asked)
            self._answers[asked] = answer
            self._bytes += answer.size + len(asked)
            while self._bytes > _MOST_BYTES:
                self._forget(next(iter(self._answers)))

    def _forget(self, asked: str) -> None:
        gone = self._answers.pop(asked, None)
        self._bytes -= 0 if gone is None else gone.size + len(asked)
