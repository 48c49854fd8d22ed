"""Cache of sums over the past days of turbines."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from datetime import date, timedelta
from threading import Lock

from sqlalchemy import Connection

from jackettwin.service import workers
from jackettwin.store import assets, results

_MOST = 2048
"""Number of turbines in the cache, of some kilobytes each: more than a farm has."""

RECENT_DAYS = 30
"""Days up to the last record whose mean is what a turbine does now; a change is whole in it after these."""

Hashes = tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class SummedDays:
    """Summary of a turbine's days, their number, and the identity of their states."""

    sums: workers.engine.Sums
    days: int
    state_hash: str


class DayCache:
    """Cache of the sums of all days but the last, which still grows, for recently requested turbines."""

    def __init__(self) -> None:
        self._past: OrderedDict[tuple[str, str], tuple[Hashes, workers.engine.Sums]] = OrderedDict()
        self._lock = Lock()

    def told(
        self,
        connection: Connection,
        version: assets.Version,
        model: workers.engine.TwinProfile,
        day: str | None = None,
    ) -> SummedDays:
        """Return the summary of all days, or those up to one; only new or changed days are read."""
        key = (version.asset, version.model_hash)
        by_day = results.state_hashes(connection, *key, day)
        hashes = tuple(by_day.items())
        with self._lock:
            known, sums = self._past.get(key, ((), workers.engine.no_days(model)))
        if hashes[: len(known)] != known:
            known, sums = (), workers.engine.no_days(model)
        states = results.states_until(connection, *key, day, after=known[-1][0] if known else None)
        for state in states[:-1]:
            sums = workers.engine.with_day(sums, state.day, state.document)
            known = (*known, (state.day, state.document_hash))
        if day is None:
            self._keep(key, known, sums)
        for state in states[-1:]:
            sums = workers.engine.with_day(sums, state.day, state.document)
        return SummedDays(sums, len(hashes), results.identity_of(by_day))

    def recent(
        self,
        connection: Connection,
        version: assets.Version,
        model: workers.engine.TwinProfile,
        day: str | None = None,
    ) -> workers.engine.Sums:
        """Return the sums over the last :data:`RECENT_DAYS` until the last day with records, or until one."""
        key = (version.asset, version.model_hash)
        last = max(results.state_hashes(connection, *key, day), default="")
        # days without a date come before all others: they count only where there are no others
        after = f"{date.fromisoformat(last) - timedelta(days=RECENT_DAYS)}" if last else None
        sums = workers.engine.no_days(model)
        for state in results.states_until(connection, *key, last, after=after):
            sums = workers.engine.with_day(sums, state.day, state.document)
        return sums

    def _keep(self, key: tuple[str, str], known: Hashes, sums: workers.engine.Sums) -> None:
        with self._lock:
            self._past[key] = (known, sums)
            self._past.move_to_end(key)
            while len(self._past) > _MOST:
                self._past.popitem(last=False)
