"""Logins that have not succeeded lately, so that passwords cannot be guessed by trying."""

from __future__ import annotations

import ipaddress
import time
from collections.abc import Iterable, Mapping
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

    def wait_s(self, limits: Mapping[str, int]) -> float:
        """Count an attempt, unless it must wait; return how long, 0 if it need not.

        ``limits`` are how many of each key are allowed in ``within_s``. It is counted before it is made, so
        that many at once are not more; one that must wait is not counted, and takes no room.
        """
        with self._lock:
            now = time.monotonic()
            recent = {key: [t for t in self._tried.get(key, []) if now - t < self.within_s] for key in limits}
            waits = [recent[k][-n] + self.within_s - now for k, n in limits.items() if len(recent[k]) >= n]
            if waits:
                return max(waits)
            for key, times in recent.items():
                self._tried.pop(key, None)
                self._tried[key] = [*times, now]
            while len(self._tried) > _MOST_KEYS:
                del self._tried[next(iter(self._tried))]
            return 0.0

    def succeeded(self, keys: Iterable[str]) -> None:
        """Take an attempt back."""
        with self._lock:
            for key in keys:
                if self._tried.get(key):
                    self._tried[key].pop()

    @staticmethod
    def place(host: str) -> str:
        """Return what is counted as one place: an address, of IPv6 the network that one subscriber has."""
        try:
            address = ipaddress.ip_address(host)
        except ValueError:
            return host
        return host if address.version == 4 else str(ipaddress.ip_network(f"{host}/64", strict=False))
