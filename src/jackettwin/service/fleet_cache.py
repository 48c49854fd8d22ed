"""List of turbines in memory: an event renews the row of its turbine, and no other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from threading import Lock
from typing import Generic, TypeVar

from sqlalchemy import Connection

from jackettwin.store import journal

Row = TypeVar("Row")
_MANY = 50
"""Number of changed turbines from which all rows are made by few large queries."""


@dataclass
class FleetCache(Generic[Row]):
    """Rows of all turbines by name, so that a list costs no count of everything that is stored.

    Every change of a row comes with an event of its turbine, in one transaction.
    """

    _rows: dict[str, Row] = field(default_factory=dict)
    _version: int | None = None
    _lock: Lock = field(default_factory=Lock)

    def rows(self, connection: Connection, make: Callable[[str | None], dict[str, Row]]) -> dict[str, Row]:
        """Return the rows in the order of names, after renewing those with new events.

        Parameters
        ----------
        make : returns the rows of all turbines, or the row of one, which is missing if it is not listed
        """
        version = journal.last_event(connection)  # before the rows, which may then be newer, never older
        with self._lock:
            if self._version is None or version > self._version:
                last = self._version
                changed = None if last is None else journal.assets_after(connection, last)
                self._rows = self._renewed(changed, make)
                self._version = version
            return self._rows

    def _renewed(
        self, changed: set[str] | None, make: Callable[[str | None], dict[str, Row]]
    ) -> dict[str, Row]:
        if changed is None or len(changed) > _MANY:
            return dict(sorted(make(None).items()))
        rows = {name: row for name, row in self._rows.items() if name not in changed}
        for name in changed:
            rows |= make(name)
        return dict(sorted(rows.items()))
