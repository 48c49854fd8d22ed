"""Duration of requests and queries, measured by a server while it runs."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from prometheus_client import CollectorRegistry, Counter, Histogram
from sqlalchemy import Engine, event

if TYPE_CHECKING:
    from collections.abc import MutableMapping

log = logging.getLogger(__name__)
_BUCKETS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.2, 0.5, 1.0, 2.5, 5.0, 10.0, 60.0)
"""Seconds; 0.2 is what half a hundred readers are promised."""
_STATEMENT = 300
"""Characters of a slow statement that the log is told."""
UNKNOWN = "none"
"""The route of what is answered before there is one: paths of strangers are no labels."""


class Latency:
    """Latency of requests by route, and queries that took longer than they should."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()
        self.requests = Histogram(
            "jackettwin_request_seconds",
            "Time from a request to the end of its answer",
            ["method", "route", "status"],
            buckets=_BUCKETS,
            registry=self.registry,
        )
        self.slow_queries = Counter(
            "jackettwin_slow_queries", "Queries that took too long", registry=self.registry
        )

    @contextmanager
    def request(self, scope: MutableMapping[str, Any]) -> Iterator[dict[str, Any]]:
        """Measure a request; its answer's ``status`` is put into what is given."""
        began, said = time.perf_counter(), {"status": 500}
        try:
            yield said
        finally:
            took, status = time.perf_counter() - began, str(said["status"])
            self.requests.labels(scope["method"], _route(scope), status).observe(took)

    def watch(self, database: Engine, slow_s: float) -> None:
        """Count queries that take longer than so many seconds; the log says which, and not of whom."""

        @event.listens_for(database, "before_cursor_execute")
        def _begin(_c: Any, _cursor: Any, _statement: str, _p: Any, context: Any, _many: bool) -> None:
            context.jackettwin_began = time.perf_counter()

        @event.listens_for(database, "after_cursor_execute")
        def _end(_c: Any, _cursor: Any, statement: str, _p: Any, context: Any, _many: bool) -> None:
            took = time.perf_counter() - context.jackettwin_began
            if took >= slow_s:
                self.slow_queries.inc()
                log.warning("a query took %.2f s: %s", took, " ".join(statement.split())[:_STATEMENT])


def _route(scope: Mapping[str, Any]) -> str:
    """Return the template of the path that was asked for: that of its route, behind where its router is."""
    template: str | None = getattr(scope.get("route"), "path", None)
    if template is None:
        return UNKNOWN
    return "/".join(scope["path"].split("/")[: -template.count("/")]) + template
