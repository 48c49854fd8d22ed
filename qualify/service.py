"""The living twin under load and under fire, with real servers: docs/verification/service.md.

Records are observed for real; each has two channels, 300 s at 20 Hz and two modes. Faults are drawn from a
seed. What counts in the end: records lost or doubled, and days whose state differs from an undisturbed run.

    python qualify/service.py [--records 60] [--kills 60] [--load-s 600] [--queued 100000] [--seed 1]
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
import threading
import time
from pathlib import Path

import httpx
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.service.conftest import description, hour, record_file
from tests.service.servers import Broker, Database, Server, opened

from jackettwin.service import add_twin
from jackettwin.store import open_database, sqlite_url, work, writing
from jackettwin.version import __version__

PAGE = Path(__file__).parents[1] / "docs" / "verification" / "service.md"
SAMPLES = 6000
READERS = 50


def records(n: int) -> list[tuple[str, bytes, str]]:
    """Return (name, file, description) of records an hour apart."""
    return [(f"r{k}.parquet", record_file(k, samples=SAMPLES), description(hour(k))) for k in range(n)]


def new_store(folder: Path, database: str | None = None) -> Path:
    """Return a store with one turbine."""
    store = folder / "store"
    store.mkdir(parents=True)
    twin = folder / "twin.yaml"
    twin.write_text("structure: jacket15\n")
    with opened(database or sqlite_url(store)) as engine:
        add_twin(engine, store, "wtg", twin)
    return store


def undisturbed(folder: Path, sent: list[tuple[str, bytes, str]]) -> tuple[dict[str, str], float]:
    """Return the states of a run without faults, and its CPU seconds a record, everything included."""
    with Server(new_store(folder)) as server:
        before = time.monotonic()
        for one in sent:
            server.send(*one)
        server.wait_until_observed(len(sent), seconds=3600.0)
        return server.states(), (time.monotonic() - before) / len(sent)


def under_fire(
    folder: Path, sent: list[tuple[str, bytes, str]], kills: int, rng: random.Random
) -> dict[str, object]:
    """Kill servers, workers, the database and the broker while records arrive; return what came of it."""
    database, broker = Database(folder / "postgresql"), Broker(folder / "broker")
    database.start()
    broker.start()
    store = new_store(folder / "fire", database.url)
    options = ("--database", database.url, "--mqtt", f"mqtt://127.0.0.1:{broker.port}")
    servers = [Server(store, *options), Server(store, *options)]
    for server in servers:
        server.start()
    struck = {"server": 0, "worker": 0, "database": 0, "broker": 0}
    due = sorted(rng.choices(range(len(sent)), k=kills))
    try:
        for k, one in enumerate(sent):
            rng.choice(servers).send(*one)
            for _ in range(due.count(k)):
                what = rng.choice(list(struck))
                victim = rng.choice(servers)
                time.sleep(rng.uniform(0.0, 2.0))
                struck[what] += 1
                if what == "server":
                    victim.kill()
                    victim.start()
                elif what == "worker":
                    victim.kill_a_worker()
                else:
                    part = database if what == "database" else broker
                    part.kill()
                    part.start()
        servers[0].wait_until_observed(len(sent), seconds=3600.0)
        return {"struck": struck, "states": servers[0].states(), "counts": servers[0].counts()}
    finally:
        for server in servers:
            server.stop()
        broker.stop()
        database.stop()


def under_load(folder: Path, seconds: float) -> dict[str, float]:
    """Send records as fast as two workers take them while fifty readers ask; return rates and delays."""
    answers: list[float] = []
    stop = threading.Event()
    with Server(new_store(folder)) as server:

        def read(i: int) -> None:
            paths = [
                "/assets",
                "/assets/wtg/modes?limit=200",
                "/assets/wtg/twin",
                "/assets/wtg/records?limit=50",
            ]
            with httpx.Client(base_url=server.url + "/api/v1", timeout=30.0) as client:
                while not stop.wait(1.0):
                    before = time.perf_counter()
                    client.get(paths[i % len(paths)])
                    answers.append(time.perf_counter() - before)

        readers = [threading.Thread(target=read, args=(i,), daemon=True) for i in range(READERS)]
        for reader in readers:
            reader.start()
        begin, k, memory = time.monotonic(), 0, []
        while time.monotonic() - begin < seconds:
            server.send(f"r{k}.parquet", record_file(k, samples=SAMPLES), description(hour(k)))
            k += 1
            waiting = server.get("/api/v1/assets").json()["items"][0]["records"]
            memory.append(resident_bytes(server))
            while waiting.get("received", 0) > 4:
                time.sleep(0.2)
                waiting = server.get("/api/v1/assets").json()["items"][0]["records"]
        took = time.monotonic() - begin
        stop.set()
    late = memory[len(memory) // 2 :]
    return {
        "records": k,
        "seconds_a_record": took / k,
        "p95_ms": float(np.quantile(answers, 0.95)) * 1e3,
        "answers": len(answers),
        "memory_mb": late[-1] / 2**20,
        "memory_growth": late[-1] / late[0] - 1.0,
    }


def many_queued(folder: Path, n: int) -> dict[str, float]:
    """Queue many rows, and time a lease and a listing among them."""
    engine = open_database(sqlite_url(new_store(folder)))
    with writing(engine) as connection:
        now = hour(0)
        rows = [
            {
                "kind": "observe",
                "asset": "wtg",
                "record_id": f"{k:08x}",
                "version": 1,
                "model_hash": "m",
                "settings_hash": "s",
                "code_version": __version__,
                "state": "queued",
                "priority": 0,
                "tries": 0,
                "created_utc": now,
            }
            for k in range(n)
        ]
        for i in range(0, n, 5000):
            connection.execute(work.work.insert(), rows[i : i + 5000])
    before = time.process_time()
    with writing(engine) as connection:
        jobs = work.lease(connection, "one", 4, now)
    took = time.process_time() - before
    return {"queued": n, "leased": len(jobs), "lease_ms": took * 1e3}


def resident_bytes(server: Server) -> int:
    """Return the memory of the server's own process."""
    assert server._process is not None
    pages = int(Path(f"/proc/{server._process.pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", type=int, default=60)
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--load-s", type=float, default=600.0)
    parser.add_argument("--queued", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    rng = random.Random(given.seed)
    with tempfile.TemporaryDirectory(prefix="jackettwin-qualify-") as name:
        folder = Path(name)
        folder.chmod(0o755)
        queued = many_queued(folder / "queue", given.queued)
        load = under_load(folder / "load", given.load_s)
        sent = records(given.records)
        expected, seconds = undisturbed(folder / "undisturbed", sent)
        fire = under_fire(folder, sent, given.kills, rng)
    counts, states = fire["counts"], fire["states"]
    assert isinstance(counts, dict)
    assert isinstance(states, dict)
    days = {*expected, *states}
    different = sum(states.get(day) != expected.get(day) for day in days)
    struck = ", ".join(f"{n} {what}" for what, n in fire["struck"].items())  # type: ignore[attr-defined]
    rate, memory, lease_ms = load["seconds_a_record"], load["memory_mb"], queued["lease_ms"]
    lines = [
        "# The service under load and under fire",
        "",
        f"`python qualify/service.py --records {given.records} --kills {given.kills} "
        f"--load-s {given.load_s:g} --queued {given.queued} --seed {given.seed}`",
        "",
        "| what | figure |",
        "|---|---|",
        f"| kills, by part | {struck} |",
        f"| records sent, kept, observed | {given.records}, {counts['records']}, {counts['observations']} |",
        f"| days with another state than undisturbed | {different} of {len(days)} |",
        f"| records taken and observed under load | {load['records']}, one in {rate:.2f} s |",
        f"| {READERS} readers meanwhile | {load['answers']} answers, p95 {load['p95_ms']:.0f} ms |",
        f"| memory of the server | {memory:.0f} MB, {load['memory_growth']:+.1%} over the 2nd half |",
        f"| {queued['queued']} queued | a lease of {queued['leased']} takes {lease_ms:.1f} CPU-ms |",
        f"| undisturbed | {seconds:.2f} s a record on two workers, sending included |",
    ]
    PAGE.write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
