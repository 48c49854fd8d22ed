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
    """Summary of a turbine's days and of its last month, their number, and the identity of their states."""

    sums: workers.engine.Sums
    recent: workers.engine.Sums
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
        """Return the summary of all days, or those up to one; only new, changed and recent days are read."""
        key = (version.asset, version.model_hash)
        by_day = results.state_hashes(connection, *key, day)
        hashes = tuple(by_day.items())
        with self._lock:
            known, sums = self._past.get(key, ((), workers.engine.no_days(model)))
        if hashes[: len(known)] != known:
            known, sums = (), workers.engine.no_days(model)
        summed, before = known[-1][0] if known else None, _month_before(max(by_day, default=""))
        after = None if summed is None or before is None else min(summed, before)
        states = results.states_until(connection, *key, day, after=after)
        recent = workers.engine.no_days(model)
        for state in states:
            if before is None or state.day > before:
                recent = workers.engine.with_day(recent, state.day, state.document)
        states = [state for state in states if summed is None or state.day > summed]
        for state in states[:-1]:
            sums = workers.engine.with_day(sums, state.day, state.document)
            known = (*known, (state.day, state.document_hash))
        if day is None:
            self._keep(key, known, sums)
        for state in states[-1:]:
            sums = workers.engine.with_day(sums, state.day, state.document)
        return SummedDays(sums, recent, len(hashes), results.identity_of(by_day))

    def _keep(self, key: tuple[str, str], known: Hashes, sums: workers.engine.Sums) -> None:
        with self._lock:
            self._past[key] = (known, sums)
            self._past.move_to_end(key)
            while len(self._past) > _MOST:
                self._past.popitem(last=False)


def _month_before(day: str) -> str | None:
    """Return the day before the last :data:`RECENT_DAYS`; none where days have no date."""
    return f"{date.fromisoformat(day) - timedelta(days=RECENT_DAYS)}" if day else None
