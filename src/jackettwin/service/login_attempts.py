"""Logins that have not succeeded lately, so that passwords cannot be guessed by trying."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from threading import Lock

_MOST_KEYS = 10_000
"""Names and addresses that are counted: a flood of them must not fill the memory."""


@dataclass
class LoginAttempts:
    """The times of recent attempts to log in, by who was tried and from where."""

    within_s: float = 60.0
    _tried: dict[str, list[float]] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock)

    def wait_s(self, key: str, most: int) -> float:
        """Count an attempt; return 0 if it is allowed, else how long to wait; ``most`` are, in ``within_s``.

        It is counted before it is made, so that many at once are not more.
        """
        with self._lock:
            now = time.monotonic()
            if len(self._tried) > _MOST_KEYS:
                self._tried.clear()
            recent = self._tried[key] = [t for t in self._tried.get(key, []) if now - t < self.within_s]
            if len(recent) >= most:
                return recent[-most] + self.within_s - now
            recent.append(now)
            return 0.0

    def succeeded(self, key: str) -> None:
        """Take an attempt back."""
        with self._lock:
            if self._tried.get(key):
                self._tried[key].pop()
