"""Metrics for operators in the text format of Prometheus, read from the store at each request."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime
from typing import TYPE_CHECKING

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    disable_created_metrics,
    generate_latest,
)
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.service.web import catalogue
from jackettwin.service.web.schemas.assets import AssetOut
from jackettwin.service.web.schemas.server import Ready
from jackettwin.service.workers.failures import ROOM_BYTES
from jackettwin.store import alerts, reading, rights, work

if TYPE_CHECKING:
    from jackettwin.service.context import Service


LATE_S = 3600.0
"""Waiting time after which records are late; meanwhile each turbine sends six more."""


def readiness(service: Service) -> Ready:
    """Return whether records can be taken and observed now."""
    age = None
    try:
        with reading(service.database) as connection:
            oldest = work.oldest_queued(connection)
        age, database = 0.0 if oldest is None else max((service.now() - oldest).total_seconds(), 0.0), True
    except SQLAlchemyError:
        database = False
    scheduler, workers = service.cluster.reachable, service.cluster.workers
    broker, free = service.broker_connected(), service.free_bytes()
    able = database and scheduler and workers > 0 and service.turning()
    return Ready(
        ready=able and broker is not False and free >= ROOM_BYTES,
        database=database,
        scheduler=scheduler,
        workers=workers,
        broker=broker,
        free_bytes=free,
        queue_age_s=age,
    )


def problems(service: Service, found: Ready) -> list[str]:
    """Return sentences on the faults of a server."""
    late = found.queue_age_s is not None and found.queue_age_s > LATE_S
    said = {
        "the dispatcher hangs: restart the server": not service.turning(),
        "the database does not answer": not found.database,
        "the scheduler does not answer": not found.scheduler,
        "there is no worker": found.scheduler and found.workers == 0,
        "the broker does not answer": found.broker is False,
        "the disk is full, or read-only": found.free_bytes < ROOM_BYTES,
        f"records wait for more than {LATE_S / 3600.0:g} h": late,
    }
    return [words for words, holds in said.items() if holds]


class _Measures:
    """Metrics of one response."""

    def __init__(self) -> None:
        self.registry = CollectorRegistry()

    def gauge(self, name: str, text: str, value: float, **labels: str) -> None:
        """Add a present value, possibly with labels."""
        known = self.registry._names_to_collectors.get(f"jackettwin_{name}")
        made = known or Gauge(f"jackettwin_{name}", text, list(labels), registry=self.registry)
        assert isinstance(made, Gauge)
        (made.labels(**labels) if labels else made).set(value)

    def counter(self, name: str, text: str, value: float) -> None:
        """Add a count of events since the start of the server; ``_total`` is appended to its name."""
        Counter(f"jackettwin_{name}", text, registry=self.registry).inc(value)


def exposition(service: Service, seen: rights.Assets = None) -> bytes:
    """Return all metrics of the server and of the visible assets as text."""
    disable_created_metrics()  # type: ignore[no-untyped-call]  # made anew, counters began at no time
    measures, now = _Measures(), service.now()
    gauge, counter = measures.gauge, measures.counter
    with reading(service.database) as connection:
        for state, n in work.queue_sizes(connection, seen).items():
            gauge("work", "Jobs by state", n, state=state)
        _measure_assets(measures, catalogue.fleet(connection, service.fleet, seen), now)
        oldest = work.oldest_queued(connection)
        alerted = {} if seen is not None else alerts.count(connection)
    waited = 0.0 if oldest is None else max((now - oldest).total_seconds(), 0.0)
    gauge("queue_age_seconds", "Time since the oldest unobserved record was queued", waited)
    for state, n in alerted.items():
        gauge("alerts", "Alerts by state", n, state=state)
    gauge("workers", "Number of workers", service.cluster.workers)
    gauge("scheduler_reachable", "Whether the scheduler of the workers answers", service.cluster.reachable)
    counter("worker_restarts", "Workers that were replaced, for any reason", service.cluster.restarts)
    gauge("disk_free_bytes", "Free disk space of the store", service.free_bytes())
    broker = service.broker_connected()
    if broker is not None:
        gauge("broker_connected", "Whether the MQTT broker answers", float(broker))
        counter("packets_refused", "Packets that were rejected", service.packets_refused())
    return generate_latest(measures.registry) + generate_latest(service.latency.registry)


def _measure_assets(measures: _Measures, fleet: Iterable[AssetOut], now: datetime) -> None:
    gauge = measures.gauge
    for asset in fleet:
        name = asset.name
        for status, n in asset.records.items():
            gauge("records", "Records by asset and status", n, asset=name, status=status)
        for severity, n in asset.findings.items():
            gauge("findings", "Findings by asset and severity", n, asset=name, severity=severity)
        gauge("alarms_open", "Open alarms", asset.open_alarms, asset=name)
        if asset.last_record_utc is not None:
            age = (now - asset.last_record_utc).total_seconds()
            gauge("last_record_age_seconds", "Time since the latest record began", age, asset=name)
