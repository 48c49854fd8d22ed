"""Stores of a living twin as its qualification needs them: new, full, with long queues, by another clock."""

from __future__ import annotations

import http.client
import json
import random
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Engine
from tests.service.conftest import Here
from tests.service.servers import opened
from tests.support.observations import estimate, observation

from jackettwin.service import ServiceSettings, add_twin
from jackettwin.service.context import Service
from jackettwin.service.intake.files import take_file
from jackettwin.service.work.dispatch import Dispatcher
from jackettwin.service.workers import engine
from jackettwin.service.workers.tasks import read_file
from jackettwin.store import assets, open_database, reading, results, sqlite_url, tables, work, writing
from jackettwin.twin import OBSERVATION

TWIN = "structure: jacket15\n"
DAY = datetime(2025, 3, 1, tzinfo=UTC)
PATHS = (
    "/assets",
    "/assets/wtg_{k:02d}",
    "/assets/wtg_{k:02d}/twin",
    "/assets/wtg_{k:02d}/modes?limit=200",
    "/assets/wtg_{k:02d}/records?limit=50",
    "/assets/wtg_{k:02d}/findings",
)
"""What the pages of a browser ask for."""


def new_store(folder: Path, twin: str, database: str | None = None, *others: str) -> Path:
    """Return a store with the turbine ``wtg`` and others of the same twin."""
    store = folder / "store"
    store.mkdir(parents=True)
    path = folder / "twin.yaml"
    path.write_text(twin)
    with opened(database or sqlite_url(store)) as made:
        for name in ("wtg", *others):
            add_twin(made, store, name, path)
    return store


def fill(store: Path, *, turbines: int, days: int = 1) -> None:
    """Give a store many turbines, each with 143 records a day, their modes, findings and states."""
    with opened(sqlite_url(store)) as made, writing(made) as connection:
        like = assets.found_version(connection, "wtg")
        files = assets.unpack(assets.bundle_of(connection, "wtg", 1))
        state = _state_of_a_day(like.model_hash)
        for k in range(turbines):
            name = f"wtg_{k:02d}"
            hashes = {"model_hash": like.model_hash, "settings_hash": like.settings_hash}
            assets.add_version(connection, name, files, **hashes, by="fill", now=DAY)
            key = {"asset": name, "model_hash": like.model_hash}
            for day in (DAY - timedelta(days=before) for before in range(days)):
                connection.execute(tables.records.insert(), [_record(name, day, i) for i in range(143)])
                connection.execute(tables.modes.insert(), [_mode(key, day, i) for i in range(3 * 143)])
                connection.execute(tables.findings.insert(), [_finding(key, day, i) for i in range(15)])
                results.put_state(connection, results.StoredState(**key, day=f"{day:%Y-%m-%d}", **state))


def asked_at(ports: list[int], n: int, turbines: int, during: Callable[[], None]) -> dict[str, Any]:
    """Have ``n`` readers ask, each once a second, while something happens; return what answers took."""
    delays: list[float] = []
    wrong: list[int] = []
    stop = threading.Event()

    def read(i: int) -> None:
        rng = random.Random(i)
        connection = http.client.HTTPConnection("127.0.0.1", ports[i % len(ports)], timeout=60)
        stop.wait(rng.random())
        while not stop.is_set():
            path = f"/api/v1{rng.choice(PATHS).format(k=rng.randrange(turbines))}"
            before = time.perf_counter()
            connection.request("GET", path, headers={"Accept-Encoding": "gzip"})
            answer = connection.getresponse()
            answer.read()
            delays.append(time.perf_counter() - before)
            wrong.extend([answer.status] * (answer.status != 200))
            stop.wait(max(1.0 - delays[-1], 0.0))
        connection.close()

    readers = [threading.Thread(target=read, args=(i,), daemon=True) for i in range(n)]
    for reader in readers:
        reader.start()
    during()
    stop.set()
    for reader in readers:
        reader.join()
    p50, p95 = np.quantile(delays or [0.0], [0.5, 0.95]) * 1e3
    return {"answers": len(delays), "p50_ms": p50, "p95_ms": p95, "wrong": len(wrong)}


def fill_with_versions(made: Engine, turbines: int) -> None:
    """Give a store many turbines of the twin of ``wtg`` without records."""
    with writing(made) as connection:
        like = assets.found_version(connection, "wtg")
        contents = assets.unpack(assets.bundle_of(connection, "wtg", 1))
        hashes = {"model_hash": like.model_hash, "settings_hash": like.settings_hash}
        for k in range(turbines):
            assets.add_version(connection, f"wtg_{k:02d}", contents, **hashes, by="fill", now=DAY)


def _state_of_a_day(model_hash: str) -> dict[str, Any]:
    seen = []
    for i in range(143):
        modes = {
            1: estimate(0.18 + 1e-5 * i, 0.012, 4e-3, 0.2),
            2: estimate(0.181, 0.012, 4e-3, 0.2),
            3: estimate(0.55, 0.01, 4e-3, 0.2),
        }
        made = observation(modes, DAY + timedelta(minutes=10 * i), name=f"r{i}")
        seen.append(replace(made, model_hash=model_hash))
    model = _Bare(model_hash)
    documents = [json.dumps(OBSERVATION.dump(one)) for one in seen]
    folded = engine.advance_day(model, f"{DAY:%Y-%m-%d}", None, documents)  # type: ignore[arg-type]
    return {"n_records": folded.n_records, "document": folded.document}


class _Bare:
    """As much of a model as advancing needs."""

    by_wind = with_shapes = False

    def __init__(self, model_hash: str) -> None:
        self.model_hash = model_hash


def _number(asset: str, day: datetime, i: int) -> str:
    return f"{asset[-2:]}{day:%Y%m%d}{i:014x}"


def _record(asset: str, day: datetime, i: int) -> dict[str, Any]:
    return {
        "asset": asset,
        "record_id": _number(asset, day, i),
        "status": "observed",
        "start_utc": day + timedelta(minutes=10 * i),
        "duration_s": 600.0,
        "sample_rate_hz": 20.0,
        "channels": [{"name": name, "quantity": "acceleration"} for name in ("x", "y")],
        "conditions": {"mean_wind_speed_m_s": 8.0, "state": "operating"},
        "source_name": f"r{i}.parquet",
        "received_utc": day + timedelta(minutes=10 * i),
        "size_bytes": 48_000,
    }


def _mode(key: dict[str, Any], day: datetime, i: int) -> dict[str, Any]:
    return {
        **key,
        "model_version": 1,
        "record_id": _number(key["asset"], day, i // 3),
        "time_utc": day + timedelta(minutes=10 * (i // 3)),
        "label": ("fore_aft_1", "side_side_1", "fore_aft_2")[i % 3],
        "frequency_hz": 0.18,
        "frequency_std_hz": 1e-4,
        "damping_ratio": 0.01,
        "damping_ratio_std": 2e-3,
        "damping_ratio_low_90": 0.007,
        "damping_ratio_high_90": 0.014,
        "status": "ok",
    }


def _finding(key: dict[str, Any], day: datetime, i: int) -> dict[str, Any]:
    return {
        **key,
        "record_id": _number(key["asset"], day, i),
        "origin": "observe",
        "time_utc": day + timedelta(minutes=10 * i),
        "day": f"{day:%Y-%m-%d}",
        "code": "rotor_order_removed",
        "severity": "warning",
        "subject": "3P",
        "params": {},
        "text": "a multiple of the rotor's speed was removed",
    }


def queue_many(made: Engine, version: assets.Version, n: int) -> float:
    """Queue work on many records; return the CPU milliseconds of each."""
    before = time.process_time()
    for i in range(0, n, 1000):
        with writing(made) as connection:
            for k in range(i, i + 1000):
                work.enqueue(connection, version, f"{k:024x}", DAY, priority=10 * (k % 3 == 0))
    return (time.process_time() - before) / n * 1e3


def with_wandering_clock(
    folder: Path, twin: str, sent: list[tuple[str, bytes, str]]
) -> dict[str, int | float]:
    """Observe records by a clock that jumps by up to a day, and by one that does not; compare."""
    rng = random.Random(1)
    steady = _observed(folder / "steady", twin, sent, lambda: DAY)
    jumping = _observed(folder / "jumping", twin, sent, lambda: DAY + timedelta(hours=rng.uniform(-24, 24)))
    days = {*steady[0], *jumping[0]}
    return {
        "records": len(sent),
        "lost": len(sent) - jumping[1],
        "doubled": jumping[2] - jumping[1],
        "days": len(days),
        "different": sum(steady[0].get(day) != jumping[0].get(day) for day in days),
    }


def _observed(
    folder: Path, twin: str, sent: list[tuple[str, bytes, str]], now: Callable[[], datetime]
) -> tuple[dict[str, str], int, int]:
    """Return states, records observed and rows of observations of a store whose server has this clock."""
    store = new_store(folder, twin)
    settings = ServiceSettings(store=store)
    for place in (settings.spool, settings.models):
        place.mkdir(exist_ok=True)
    made = open_database(settings.database_url)
    service = Service(settings, made, Here(), "clock", now=now)  # type: ignore[arg-type]
    dispatcher = Dispatcher(service)
    for name, content, beside in sent:
        path = folder / name
        path.write_bytes(content)
        path.with_suffix(".json").write_text(beside)
        take_file(service, read_file, "wtg", path, name)
        dispatcher._turn()
    for _ in range(2 * len(sent)):
        dispatcher._turn()
    with reading(made) as connection:
        version = assets.found_version(connection, "wtg")
        states = results.state_hashes(connection, "wtg", version.model_hash)
        statuses = connection.scalars(tables.records.select().with_only_columns(tables.records.c.status))
        observed = sum(status == "observed" for status in statuses)
        rows = len(connection.execute(tables.observations.select()).all())
    made.dispose()
    return states, observed, rows
