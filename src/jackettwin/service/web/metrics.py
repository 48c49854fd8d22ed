"""What an operator can alarm on, in Prometheus' text form, read from the store at the moment of asking."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prometheus_client import CollectorRegistry, Gauge, generate_latest
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.service.web.schemas import Ready
from jackettwin.store import assets, reading, records, results, rights, work

if TYPE_CHECKING:
    from jackettwin.service.context import Service


def readiness(service: Service) -> Ready:
    """Return whether records can be taken and observed now."""
    try:
        with reading(service.database) as connection:
            work.any_queued(connection, work.OBSERVE)
        database = True
    except SQLAlchemyError:
        database = False
    workers, broker = service.cluster.workers, service.broker_connected()
    free = service.free_bytes()
    ready = database and workers > 0 and broker is not False and free > 0
    return Ready(ready=ready, database=database, workers=workers, broker=broker, free_bytes=free)


def exposition(service: Service, seen: rights.Assets = None) -> bytes:
    """Return all measures of the server, and of the assets that somebody may see, as text."""
    registry, now = CollectorRegistry(), service.now()

    def gauge(name: str, text: str, value: float, **labels: str) -> None:
        known = registry._names_to_collectors.get(f"jackettwin_{name}")
        made = known or Gauge(f"jackettwin_{name}", text, list(labels), registry=registry)
        assert isinstance(made, Gauge)
        (made.labels(**labels) if labels else made).set(value)

    with reading(service.database) as connection:
        for state, n in work.queue_sizes(connection, seen).items():
            gauge("work", "Pieces of work by state", n, state=state)
        oldest = work.oldest_queued(connection)
        for name, counts in _seen(records.count_by_status(connection), seen):
            for status, n in counts.items():
                gauge("records", "Records by asset and status", n, asset=name, status=status)
        for name, said in _seen(results.count_findings(connection), seen):
            for severity, n in said.items():
                gauge("findings", "Findings by asset and severity", n, asset=name, severity=severity)
        for asset in assets.summaries(connection):
            if asset.last_record_utc is not None and (seen is None or asset.name in seen):
                age = (now - asset.last_record_utc).total_seconds()
                gauge("last_record_age_seconds", "Time since the latest record began", age, asset=asset.name)
    waited = 0.0 if oldest is None else max((now - oldest).total_seconds(), 0.0)
    gauge("queue_age_seconds", "Time since the oldest record that is not observed yet was asked for", waited)
    gauge("workers", "Workers there are", service.cluster.workers)
    gauge(
        "worker_restarts_total",
        "Workers that were replaced, whatever they ended of",
        service.cluster.restarts,
    )
    gauge("disk_free_bytes", "Room left where the store is", service.free_bytes())
    broker = service.broker_connected()
    if broker is not None:
        gauge("broker_connected", "Whether the MQTT broker answers", float(broker))
        gauge("packets_refused_total", "Packets that could not be kept", service.packets_refused())
    return generate_latest(registry)


def _seen(counts: dict[str, dict[str, int]], seen: rights.Assets) -> list[tuple[str, dict[str, int]]]:
    return [(name, of) for name, of in counts.items() if seen is None or name in seen]
