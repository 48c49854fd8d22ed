"""A farm of turbines on one PostgreSQL, its records replayed: what each costs, and what breaks first."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from datetime import UTC, datetime, timedelta
from importlib.resources import files
from pathlib import Path
from typing import Any

import psycopg
from sqlalchemy import Engine
from tests.service.servers import Database, _cpu_s, free_port, opened, wait_for_port

from common import living
from common.replay import STUDY_S
from jackettwin.service.intake.files import accept
from jackettwin.service.workers import engine
from jackettwin.service.workers.tasks import File, Outcome, Parsed, read_file
from jackettwin.store import reading, work, writing

Figures = dict[str, Any]
TWIN = files("jackettwin.data") / "twins" / "openfast_pile.yaml"
RECORDS = ("pile_U12_s301", "pile_U8_s302")
PERIOD_S = 600.0
_SLOWEST = "SELECT query, calls, mean_exec_time FROM pg_stat_statements ORDER BY total_exec_time DESC LIMIT 6"
START = datetime(2025, 3, 1, tzinfo=UTC)


def measured(folder: Path, given: argparse.Namespace) -> Figures:
    """Run a farm for some minutes at its own rate while readers ask, then once as fast as servers go."""
    database = Database(folder / "postgresql", shared_preload_libraries="pg_stat_statements")
    database.start()
    try:
        twin = "\n".join(line for line in TWIN.read_text().splitlines() if "../records/" not in line)
        store = living.new_store(folder, twin.replace("records:\n", ""), database.url)
        outcomes, about, cost = identified(store)
        (store / "outcomes.json").write_text(json.dumps([asdict(one) for one in outcomes], default=str))
        with opened(database.url) as made:
            living.fill_with_versions(made, given.turbines)
            farm = Farm(made, database, about, given.turbines)
            rate = given.turbines / PERIOD_S
            workers = int(rate * cost * 1.3 / given.servers) + 1
            with servers(store, database.url, given.servers, workers, cost) as running:
                there = farm.run(running, lambda k: k / rate, round(rate * given.farm_s), given.readers)
            with servers(store, database.url, given.servers, 4, 0.0) as running:
                fast = farm.run(running, lambda k: 0.0, given.burst, 0)
            common = {
                "turbines": given.turbines,
                "servers": given.servers,
                "workers": workers,
                "cost_s": cost,
            }
            return {**common, "rate_hz": rate, "there": there, "fast": fast, "statements": farm.statements()}
    finally:
        database.stop()


def identified(store: Path) -> tuple[list[Outcome], dict[str, Any], float]:
    """Identify shipped records; return what was found, what is said of one, and the CPU seconds of one."""
    twin, outcomes, spent = engine.load_twin(store.parent), [], 0.0
    for name in (RECORDS[0], *RECORDS):  # the first one compiles
        source = str(files("jackettwin.data") / "records" / f"{name}.parquet")
        with tempfile.TemporaryDirectory() as here:
            begin = time.process_time()
            (read,) = read_file(File(source, "wtg", here, 10**9, 3 * 2**30, datetime(2100, 1, 1, tzinfo=UTC)))
            found = Outcome(*engine.observed(twin.model, Path(here) / str(read.waveform), {}, ()))
            spent, outcomes = time.process_time() - begin, [*outcomes, found]
    return outcomes[1:], read.about, spent


class Farm:
    """Turbines of a store whose records are fed to its queue as an upload does."""

    def __init__(self, made: Engine, database: Database, about: dict[str, Any], turbines: int) -> None:
        self._made, self._database, self._about, self._turbines = made, database, about, turbines
        self._sent = 0
        self._ask("CREATE EXTENSION IF NOT EXISTS pg_stat_statements")

    def run(self, running: dict[int, int], due: Callable[[int], float], n: int, readers: int) -> Figures:
        """Feed records when they are due until all are observed; return what it took."""
        for _ in range(4 * len(running)):  # what servers load with their first records
            self._send()
        while work_left(self._made):
            time.sleep(0.2)
        self._ask("SELECT pg_stat_statements_reset()")
        size, cpu, begin = self._bytes(), self._cpu(running), time.monotonic()
        waits, waited, stop = Counter[str](), [0.0], threading.Event()

        def watch() -> None:
            while not stop.wait(0.5):
                found = self._ask(
                    "SELECT coalesce(wait_event_type || ' ' || wait_event, 'runs') FROM pg_stat_activity "
                    "WHERE state = 'active' AND pid <> pg_backend_pid()"
                )
                waits.update(event for (event,) in found)
                with reading(self._made) as connection:
                    oldest = work.oldest_queued(connection)
                waited.append(0.0 if oldest is None else (datetime.now(UTC) - oldest).total_seconds())

        def feed() -> None:
            for k in range(n):
                time.sleep(max(begin + due(k) - time.monotonic(), 0.0))
                self._send()
            while work_left(self._made):
                time.sleep(0.2)

        watcher = threading.Thread(target=watch, daemon=True)
        watcher.start()
        told = living.asked_at(list(running), readers, self._turbines, feed)
        took = time.monotonic() - begin
        stop.set()
        watcher.join()
        spent = [after - before for after, before in zip(self._cpu(running), cpu, strict=True)]
        calls, rows = self._ask("SELECT sum(calls), sum(rows) FROM pg_stat_statements")[0]
        return {
            "records": n, "took_s": took, "server_cpu_s": sum(spent[1:]) / n, "database_cpu_s": spent[0] / n,
            "statements": float(calls) / n, "rows": float(rows) / n, "bytes": (self._bytes() - size) / n,
            "longest_wait_s": max(waited), "waits": waits.most_common(4), "told": told,
        }  # fmt: skip

    def _send(self) -> None:
        asset, number = f"wtg_{self._sent % self._turbines:02d}", f"{self._sent:024x}"
        start = START + timedelta(seconds=PERIOD_S * (self._sent // self._turbines))
        about = {**self._about, "start_utc": start.isoformat()}
        parsed = Parsed(number, f"{number}@{start.isoformat()}", 600_000, about)
        with writing(self._made) as connection:
            accept(datetime.now(UTC), connection, asset, parsed, "replayed")
        self._sent += 1

    def statements(self) -> list[tuple[str, int, float]]:
        """Return the statements that take most of the database's time: text, calls, milliseconds each."""
        return [
            (" ".join(text.split())[:90], int(calls), float(each))
            for text, calls, each in self._ask(_SLOWEST)
        ]

    def _ask(self, query: str) -> list[Any]:
        with psycopg.connect(self._database.url.replace("+psycopg", ""), autocommit=True) as connection:
            cursor = connection.execute(query)  # type: ignore[call-overload]
            return cursor.fetchall() if cursor.description else []

    def _bytes(self) -> int:
        return int(self._ask("SELECT pg_database_size('postgres')")[0][0])

    def _cpu(self, running: dict[int, int]) -> list[float]:
        backends = self._ask("SELECT pid FROM pg_stat_activity")
        return [sum(_cpu_s(pid) for (pid,) in backends), *(_cpu_s(pid) for pid in running.values())]


def work_left(made: Engine) -> bool:
    """Return whether records wait or are observed."""
    with reading(made) as connection:
        counts = connection.exec_driver_sql(
            "SELECT count(*) FROM work WHERE kind = 'observe' AND state IN ('queued', 'leased')"
        )
        return bool(counts.scalar_one())


@contextmanager
def servers(store: Path, url: str, n: int, workers: int, seconds: float) -> Iterator[dict[int, int]]:
    """Run servers that replay; yields {port: process}."""
    ports, processes = [free_port() for _ in range(n)], []
    try:
        for port in ports:
            options = ["--database", url, "--port", port, "--workers", workers, "--seconds", seconds]
            command = [sys.executable, "-m", "common.replay", store, *options]
            processes.append(subprocess.Popen(list(map(str, command)), cwd=Path(__file__).parents[1]))
        for port in ports:
            wait_for_port(port, 120.0)
        yield {port: process.pid for port, process in zip(ports, processes, strict=True)}
    finally:
        for process in processes:
            process.kill()
            process.wait()


def page(pieces: list[Figures]) -> list[str]:
    """Return the page of what a farm takes."""
    lines = ["## A thousand turbines", ""]
    for f in pieces:
        there, fast, told = f["there"], f["fast"], f["there"]["told"]
        lines += [
            f"{f['turbines']} turbines send {f['rate_hz']:.2f} records a second to {f['servers']} servers on "
            f"one PostgreSQL, each with {f['workers']} workers, who wait the {f['cost_s']:.1f} s that",
            f"identification takes of nine channels at 100 Hz, a study {STUDY_S:g} s. "
            f"{told['answers']} answers to readers, {told['wrong']} not 200, median {told['p50_ms']:.0f} ms, "
            f"p95 {told['p95_ms']:.0f} ms.",
            "",
            "| | records | records/s | servers' CPU a record, answers included | PostgreSQL's | statements "
            "| rows | bytes | longest wait |",
            "|---|---|---|---|---|---|---|---|---|",
            *(
                f"| {name} | {g['records']} | {g['records'] / g['took_s']:.2f} | {g['server_cpu_s']:.3f} s "
                f"| {g['database_cpu_s']:.3f} s | {g['statements']:.0f} | {g['rows']:.0f} "
                f"| {g['bytes']:,.0f} | {g['longest_wait_s']:.1f} s |"
                for name, g in (("at their rate", there), ("as fast as servers go", fast))
            ),
            "",
            "What sessions of the database waited for, in samples: "
            + "; ".join(f"{name} {n}" for name, n in fast["waits"]) + ".",
            "",
            "| statement as fast as servers go | calls | ms each |",
            "|---|---|---|",
            *(f"| `{text}` | {calls} | {each:.2f} |" for text, calls, each in f["statements"]),
            "",
        ]  # fmt: skip
    return lines
