"""What an operator can alarm on, in Prometheus' text form, read from the store at the moment of asking."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prometheus_client import CollectorRegistry, Gauge, generate_latest
from sqlalchemy.exc import SQLAlchemyError

from jackettwin.service.web.schemas import Ready
from jackettwin.store import assets, reading, records, results, rights, work

if TYPE_CHECKING:
    from jackettwin.service.context import Service


ROOM_BYTES = 256 * 2**20
"""Room that must be left on the disk: the database needs it to finish what it began."""
LATE_S = 3600.0
"""A record that waits for so long is not observed: an hour of six records of every turbine is behind it."""


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
    """Return in words what keeps a server from doing all that it should."""
    late = found.queue_age_s is not None and found.queue_age_s > LATE_S
    said = {
        "the dispatcher hangs: start the server anew": not service.turning(),
        "the database does not answer": not found.database,
        "the scheduler does not answer": not found.scheduler,
        "there is no worker": found.scheduler and found.workers == 0,
        "the broker does not answer": found.broker is False,
        "the disk is full, or read-only": found.free_bytes < ROOM_BYTES,
        f"records wait for more than {LATE_S / 3600.0:g} h": late,
    }
    return [words for words, holds in said.items() if holds]


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
