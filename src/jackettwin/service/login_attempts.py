"""Recent failed logins, which are limited to prevent guessing of passwords."""

from __future__ import annotations

import ipaddress
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from threading import Lock

_MOST_KEYS = 10_000
"""Largest number of counted names and addresses, which bounds the memory."""


@dataclass
class LoginAttempts:
    """Times of recent login attempts, by user name and address."""

    within_s: float = 60.0
    _tried: dict[str, list[float]] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock)

    def wait_s(self, limits: Mapping[str, int]) -> float:
        """Count an attempt and return 0, or return the waiting time without counting it.

        ``limits`` are the allowed numbers of attempts for each key in ``within_s``. An attempt is counted
        before it is made, so that simultaneous attempts cannot exceed the limits.
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
        """Remove an attempt that succeeded."""
        with self._lock:
            for key in keys:
                if self._tried.get(key):
                    self._tried[key].pop()

    @staticmethod
    def place(host: str) -> str:
        """Return the address counted as one place: for IPv6 the network of one subscriber."""
        try:
            address = ipaddress.ip_address(host)
        except ValueError:
            return host
        return host if address.version == 4 else str(ipaddress.ip_network(f"{host}/64", strict=False))
