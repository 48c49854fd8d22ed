"""The living twin under load and under fire, with real servers: docs/verification/service.md.

Usage: ``python qualify/service.py [--only SCENE …] [--records 150] [--kills 60] [--seed 1]``. Each scene
keeps its figures in out/qualify/service, so that an interrupted run resumes; the page is written of those
there are, kills of several seeds together. Faults are drawn from a seed; what counts in the end are records
lost or doubled, and days whose state differs from an undisturbed run.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from common.page import write_page

sys.path.insert(0, str(Path(__file__).parents[1]))

from common import farm, living
from tests.service.conftest import description, hour, record_file
from tests.service.servers import Broker, Database, Relay, Scheduler, Server, opened, publish

from jackettwin.store import assets, backup, reading, sqlite_url, work, writing
from jackettwin.store.backup import restore

KEPT = Path("out/qualify/service")
TEN_MINUTES = 12_000
"""Samples of ten minutes at 20 Hz."""
PACE_S = 6.0
"""Between two records of a hundred turbines."""
CHEAP = 1200
"""Samples of a record that is observed in a fifth of a CPU second: faults, not modes, are looked at."""
CHEAP_TWIN = """structure: jacket15
identification: {max_order: 12}
sensors:
  - {channel: acc_top_x, height_m: 120.0, direction: [1, 0, 0]}
  - {channel: acc_top_y, height_m: 120.0, direction: [0, 1, 0]}
"""
Figures = dict[str, Any]
Sent = tuple[str, bytes, str]


def records(n: int, samples: int) -> list[Sent]:
    """Return (name, file, description) of records an hour apart."""
    return [(f"r{k}.parquet", record_file(k, samples=samples), description(hour(k))) for k in range(n)]


def load(folder: Path, given: argparse.Namespace) -> Figures:
    """Send records of a hundred turbines as fast as two workers take them while many readers ask.

    The store holds days of the hundred turbines already, so that questions cost what they cost by evening.
    """
    store = living.new_store(folder, living.TWIN)
    living.fill(store, turbines=100, days=given.stored_days)
    with Server(store) as server:
        warm(server)
        quiet = asked(server, given.readers, lambda: time.sleep(given.quiet_s))
        begin, cpu, memory = time.monotonic(), server.cpu_s(), list[dict[int, int]]()

        def send() -> None:
            for k in range(given.records):
                one = (f"r{k}.parquet", record_file(k, samples=TEN_MINUTES), description(hour(30 + k // 100)))
                server.send(*one, asset=f"wtg_{k % 100:02d}")
                time.sleep(max(begin + k * given.pace_s - time.monotonic(), 0.0))
                while server.records()["received"] > 3:
                    time.sleep(0.1)
                memory.append(server.own_bytes())
                if k % 10 == 0:
                    sizes = (f"{size / 2**20:.1f}" for size in memory[-1].values())
                    print(k, f"{time.monotonic() - begin:.0f} s", *sizes, file=sys.stderr, flush=True)

            while server.records()["received"] or server.records()["observing"]:
                time.sleep(0.1)

        busy = asked(server, given.readers, send)
        took, spent, sent = time.monotonic() - begin, server.cpu_s(), len(memory)
        return {
            "records": sent,
            "stored": 100 * 143 * given.stored_days,
            "pace_s": given.pace_s,
            "readers": given.readers,
            "seconds_a_record": took / sent,
            "server_cpu_s": spent[0] - cpu[0],
            "worker_cpu_s_a_record": (spent[1] - cpu[1]) / sent,
            "quiet": quiet,
            "busy": busy,
            "minutes": took / 60.0,
            **spread(memory, took),
        }


def warm(server: Server) -> None:
    """Have everything loaded that the first questions and records load, and every worker there."""
    while server.get("/api/v1/ready").json()["workers"] < 2:
        time.sleep(0.2)
    for path in living.PATHS:
        server.get(f"/api/v1{path.format(k=0)}")
    server.send(
        "warm.parquet", record_file(10**6, samples=TEN_MINUTES), description(hour(29)), asset="wtg_00"
    )
    while server.records()["received"] or server.records()["observing"]:
        time.sleep(0.2)


def asked(server: Server, n: int, during: Callable[[], None]) -> Figures:
    """Have readers ask a server, as :func:`living.asked_at`; return what answers took, and their CPU time."""
    cpu = server.cpu_s()[0]
    told = living.asked_at([server.port], n, 100, during)
    return {**told, "cpu_ms": (server.cpu_s()[0] - cpu) / max(told["answers"], 1) * 1e3}


def spread(memory: list[dict[int, int]], took_s: float) -> Figures:
    """Return the memory of server and workers [MB], and how far from its middle each ever is [%].

    The first hour, of less than 75 minutes the first third, is warm-up: libraries are loaded when
    they are first needed, and caches fill. A worker that was started anew meanwhile is not among them.
    """
    lasting = [pid for pid in memory[0] if all(pid in m for m in memory)]
    sizes = np.array([[m[pid] for pid in lasting] for m in memory]) / 2**20
    share = 3600.0 / took_s if took_s > 4500.0 else 1 / 3
    late = sizes[int(share * len(sizes)) :]
    lowest, highest = late.min(axis=0), late.max(axis=0)
    return {
        "warm_up_minutes": share * took_s / 60.0,
        "memory_mb": [sizes[0].tolist(), late[0].tolist(), sizes[-1].tolist()],
        "memory_tenths_mb": sizes[:: max(len(sizes) // 10, 1)].tolist(),
        "spread_percent": list(100.0 * (highest - lowest) / (highest + lowest)),
    }


def by_the_clock(folder: Path, given: argparse.Namespace) -> Figures:
    """Send records of a hundred turbines at their own rate, one every six seconds; memory is looked at."""
    there = {"pace_s": PACE_S, "records": round(60.0 * given.minutes / PACE_S)}
    return load(folder, argparse.Namespace(**{**vars(given), **there}))


def kills(folder: Path, given: argparse.Namespace) -> Figures:
    """Kill servers, workers, the database, the broker and a scheduler, and cut the way to the database.

    Records and a stream arrive meanwhile. One server has workers of its own, the other asks a scheduler.
    """
    sent = records(given.kill_records, CHEAP)
    expected = undisturbed(folder / "undisturbed", sent)
    database, broker = Database(folder / "postgresql"), Broker(folder / "broker")
    database.start()
    broker.start()
    relay, scheduler = Relay(database.port), Scheduler(folder / "scheduler")
    url = database.url.replace(str(database.port), str(relay.port))
    scheduler.start()
    store = living.new_store(folder / "fire", CHEAP_TWIN, database.url, "stream")
    options = ("--database", url, "--mqtt", f"mqtt://127.0.0.1:{broker.port}")
    servers = [Server(store, *options, "--workers", "1"), Server(store, *options, *scheduler.options)]
    for server in servers:
        server.start()
    parts: dict[str, Any] = {"database": database, "broker": broker, "scheduler": scheduler, "way": relay}
    rng, struck = random.Random(given.seed), dict.fromkeys(("server", "worker", *parts), 0)
    due = sorted(rng.choices(range(len(sent)), k=given.kills))
    due_parts = [PARTS[i % len(PARTS)] for i in range(given.kills)]
    rng.shuffle(due_parts)
    try:
        for k, one in enumerate(sent):
            rng.choice(servers).send(*one)
            stream(broker, k, len(sent))
            for _ in range(due.count(k)):
                what, victim = due_parts.pop(), rng.choice(servers)
                time.sleep(rng.uniform(0.0, 1.5))
                struck[what] += strike(what, victim, parts, rng.uniform(0.5, 10.0))
                print(f"record {k}: {struck}", file=sys.stderr, flush=True)
        servers[0].wait_until_observed(len(sent) + WINDOWS, seconds=3600.0)
        servers[0].wait_for_windows()  # one that was closed in a long silence is made anew of what came later
        servers[0].wait_until_observed(len(sent) + WINDOWS, seconds=3600.0)
        return {"struck": struck, **compared(expected, servers[0], len(sent) + WINDOWS)}
    finally:
        for server in servers:
            server.stop()
        scheduler.stop()
        relay.cut()
        broker.stop()
        database.stop()


PARTS = ("server", "worker", "worker", "database", "broker", "scheduler", "way")
"""What is killed in turn, and then shuffled: a server takes its workers with it."""
WINDOWS = 3
"""Windows of the stream, and so records of it."""


def stream(broker: Broker, k: int, n: int) -> None:
    """Send the part of the stream that belongs to a record, until the broker has it."""
    length = WINDOWS * 600.0
    first, last = (5.0 * round(length * i / n / 5.0) for i in (k, k + 1))
    while last > first:
        with suppress(OSError, RuntimeError, ValueError):
            publish(broker.port, first_s=first, last_s=last, seed=k, asset="stream")
            return
        time.sleep(0.5)


def strike(what: str, server: Server, parts: dict[str, Any], cut_s: float) -> int:
    """Kill a part and start it again, or cut the way for a while; return whether it was there."""
    if what == "worker":
        return int(server.kill_a_worker())
    if what == "way":
        parts[what].cut()
        time.sleep(cut_s)
        parts[what].mend()
        return 1
    part = server if what == "server" else parts[what]
    part.kill()
    part.start()
    return 1


def undisturbed(folder: Path, sent: list[Sent]) -> dict[str, str]:
    """Return the states of a run without faults, of the same records and the same stream."""
    folder.mkdir()
    broker = Broker(folder / "broker")
    broker.start()
    try:
        store = living.new_store(folder, CHEAP_TWIN, None, "stream")
        with Server(store, "--mqtt", f"mqtt://127.0.0.1:{broker.port}") as server:
            for one in sent:
                server.send(*one)
            for k in range(len(sent)):
                stream(broker, k, len(sent))
            server.wait_until_observed(len(sent) + WINDOWS, seconds=3600.0)
            server.wait_for_windows()
            return server.states()
    finally:
        broker.stop()


def compared(expected: dict[str, str], server: Server, n: int) -> Figures:
    """Return how many records were lost or doubled, and how many days' states differ."""
    counts, states = server.counts(), server.states()
    differing = [day for day in {*expected, *states} if states.get(day) != expected.get(day)]
    print("different:", differing, file=sys.stderr)
    return {
        "records": n,
        "lost": n - min(counts.values()),
        "doubled": max(counts.values()) - n,
        "days": len({*expected, *states}),
        "different": len(differing),
    }


def full_disk(folder: Path, given: argparse.Namespace) -> Figures:
    """Fill the store's disk while records arrive, make room again, and send what was refused again."""
    sent = records(given.few, CHEAP)
    expected = plain(folder / "undisturbed", sent)
    small = folder / "small"
    small.mkdir()
    if os.geteuid() != 0 or os.system(f"mount -t tmpfs -o size=320m tmpfs {small} 2>/dev/null") != 0:
        return {"skipped": "needs the right to mount a small file system"}
    try:
        refused = 0
        with Server(living.new_store(small, CHEAP_TWIN), log=folder / "serve.log") as server:
            for k, one in enumerate(sent):
                if k == len(sent) // 3:
                    fill_up(small / "ballast")
                if k == 2 * len(sent) // 3:
                    (small / "ballast").unlink()
                refused += server.post(*one).status_code == 507
            for one in sent:
                server.send(*one)
            server.wait_until_observed(len(sent), seconds=600.0)
            return {"refused": refused, **compared(expected, server, len(sent))}
    finally:
        os.system(f"umount -l {small}")


def fill_up(path: Path) -> None:
    """Write until nothing more fits."""
    with suppress(OSError), path.open("wb", buffering=0) as stream:
        while True:
            stream.write(b"\0" * 4096)


def plain(folder: Path, sent: list[Sent]) -> dict[str, str]:
    """Return the states of a run of records alone, without faults."""
    with Server(living.new_store(folder, CHEAP_TWIN)) as server:
        for one in sent:
            server.send(*one)
        server.wait_until_observed(len(sent), seconds=600.0)
        return server.states()


def restored(folder: Path, given: argparse.Namespace) -> Figures:
    """Back up while served, lose the store, restore into another database, send everything again."""
    sent = records(given.few, CHEAP)
    expected = plain(folder / "undisturbed", sent)
    store, file = living.new_store(folder / "first", CHEAP_TWIN), folder / "backup.tar.gz"
    with Server(store) as server:
        for k, one in enumerate(sent):
            server.send(*one)
            if k == len(sent) // 2:
                with opened(sqlite_url(store)) as engine:
                    backup.backup(engine, store, file)
        server.kill()
    database = Database(folder / "postgresql")
    database.start()
    again = folder / "second" / "store"
    again.mkdir(parents=True)
    try:
        with opened(database.url) as engine:
            rows = restore(file, engine, again)
        with Server(again, "--database", database.url) as server:
            for one in sent:
                server.send(*one)
            server.wait_until_observed(len(sent), seconds=600.0)
            return {"from_backup": rows["records"], **compared(expected, server, len(sent))}
    finally:
        database.stop()


def long_queue(folder: Path, given: argparse.Namespace) -> Figures:
    """Queue many records; return what queueing, leasing, ending and listing one of them costs."""
    store = living.new_store(folder, CHEAP_TWIN)
    figures: Figures = {"queued": given.queued}
    with opened(sqlite_url(store)) as engine:
        with reading(engine) as connection:
            version = assets.found_version(connection, "wtg")
        figures["enqueue_ms"] = living.queue_many(engine, version, given.queued)
        costs: dict[str, list[float]] = {"lease": [], "end": [], "list": []}
        for _ in range(20):
            with writing(engine) as connection:
                before = time.process_time()
                jobs = work.lease(connection, "one", 4, hour(0))
                costs["lease"].append(time.process_time() - before)
                before = time.process_time()
                assert all(work.finish(connection, job, "one", "done", hour(0)) for job in jobs)
                costs["end"].append(time.process_time() - before)
                before = time.process_time()
                work.list_jobs(connection, state="queued")
                costs["list"].append(time.process_time() - before)
    return figures | {f"{name}_ms": float(np.median(spent)) * 1e3 for name, spent in costs.items()}


def clock(folder: Path, given: argparse.Namespace) -> Figures:
    """Set the server's clock back by a day, and forth, between records."""
    sent = records(given.few, CHEAP)
    return living.with_wandering_clock(folder, CHEAP_TWIN, sent)


SCENES: dict[str, Callable[[Path, argparse.Namespace], Figures]] = {
    "queue": long_queue,
    "clock": clock,
    "disk": full_disk,
    "backup": restored,
    "kills": kills,
    "load": load,
    "hour": by_the_clock,
    "farm": farm.measured,
}


def summed(pieces: list[Figures]) -> Figures:
    """Return the figures of runs with several seeds together; of one, its own."""
    total = dict(pieces[0])
    for piece in pieces[1:]:
        for name in ("records", "lost", "doubled", "days", "different"):
            total[name] += piece[name]
        known = {**total["struck"], **piece["struck"]}  # earlier pieces had fewer parts
        total["struck"] = {part: _of(total, part) + _of(piece, part) for part in known}
    return total


def _of(piece: Figures, part: str) -> int:
    return int(piece["struck"].get(part, 0))


def page(kept: dict[str, list[Figures]]) -> list[str]:
    """Return the page of what was measured."""
    lines = ["# The service under load and under fire", "", "`python qualify/service.py`", ""]
    for name in kept:
        lines += PAGES[name](kept[name])
    return lines


def _load(pieces: list[Figures]) -> list[str]:
    return [
        "## A hundred turbines",
        "",
        f"Stores of a hundred turbines with so many records already, two workers, {pieces[0]['readers']} "
        "readers, who each ask once a second;",
        "records of ten minutes and two channels, sent as fast as they were taken.",
        "",
        "| stored before | sent | one record in | a worker's CPU for one | the server's, answers included "
        "| CPU for an answer | readers' median, p95 | without records | answers that were not 200 |",
        "|---|---|---|---|---|---|---|---|---|",
        *map(_load_row, sorted(pieces, key=lambda f: (f["stored"], f["records"]))),
        "| bar | | 6 s | | | | 200 ms | | 0 |",
        "",
    ]


def _load_row(f: Figures) -> str:
    busy, quiet = f["busy"], f["quiet"]
    cells = (
        f"{f['stored']:,}",
        str(f["records"]),
        f"{f['seconds_a_record']:.2f} s",
        f"{f['worker_cpu_s_a_record']:.2f} s",
        f"{f['server_cpu_s'] / f['records']:.2f} s",
        f"{quiet['cpu_ms']:.1f} ms",
        f"{busy['p50_ms']:.0f}, {busy['p95_ms']:.0f} ms",
        f"{quiet['p50_ms']:.0f}, {quiet['p95_ms']:.0f} ms",
        str(busy["wrong"] + quiet["wrong"]),
    )
    return f"| {' | '.join(cells)} |"


def _hour(pieces: list[Figures]) -> list[str]:
    f = pieces[0]
    return [
        "## By the clock",
        "",
        f"{f['records']} records of a hundred turbines at their own rate, one every {f['pace_s']:g} s for "
        f"{f['minutes']:.0f} minutes,",
        f"with {f['readers']} readers ({f['busy']['answers']} answers, p95 {f['busy']['p95_ms']:.0f} ms, "
        f"{f['busy']['wrong']} not 200). A worker spent {f['worker_cpu_s_a_record']:.2f} CPU-s a record,",
        f"the server {f['server_cpu_s'] / f['records']:.2f}, answers included. Memory each shares with no",
        f"other process; the first {f['warm_up_minutes']:.0f} minutes are warm-up:",
        "",
        *_grown(f),
        "| MB at tenths of the records | " + " | ".join(map(str, range(len(f["memory_tenths_mb"])))) + " |",
        "|---" * (1 + len(f["memory_tenths_mb"])) + "|",
        *(
            f"| {name} | {' | '.join(f'{size:.0f}' for size in sizes)} |"
            for name, sizes in zip(_processes(f), zip(*f["memory_tenths_mb"], strict=True), strict=True)
        ),
        "",
    ]


def _processes(f: Figures) -> list[str]:
    return ["server", *(f"worker {i}" for i, _ in enumerate(f["spread_percent"][1:], start=1))]


def _grown(f: Figures) -> list[str]:
    return [
        "| MB | after the first record | after warm-up | in the end | from its middle, after warm-up | bar |",
        "|---|---|---|---|---|---|",
        *(
            f"| {name} | {first:.0f} | {warm:.0f} | {last:.0f} | ± {share:.1f} % | ± 5 % |"
            for name, first, warm, last, share in zip(
                _processes(f), *f["memory_mb"], f["spread_percent"], strict=True
            )
        ),
        "",
    ]


def _faults(title: str, detail: str) -> Callable[[list[Figures]], list[str]]:
    def lines(pieces: list[Figures]) -> list[str]:
        f = summed(pieces)
        if "skipped" in f:
            return [f"## {title}", "", f"Left out here: {f['skipped']}.", ""]
        return [
            f"## {title}",
            "",
            detail.format(**f),
            "",
            "| records | lost | doubled | days | states different |",
            "|---|---|---|---|---|",
            f"| {f['records']} | {f['lost']} | {f['doubled']} | {f['days']} | {f['different']} |",
            "",
        ]

    return lines


def _queue(pieces: list[Figures]) -> list[str]:
    f = pieces[0]
    return [
        "## A long queue",
        "",
        f"| {f['queued']:,} records queued | CPU |",
        "|---|---|",
        f"| queue one more | {f['enqueue_ms']:.2f} ms |",
        f"| lease four | {f['lease_ms']:.2f} ms |",
        f"| end four | {f['end_ms']:.2f} ms |",
        f"| list a hundred | {f['list_ms']:.2f} ms |",
        "",
    ]


PAGES: dict[str, Callable[[list[Figures]], list[str]]] = {
    "load": _load,
    "hour": _hour,
    "farm": farm.page,
    "kills": _faults(
        "Kills",
        "Two servers on one PostgreSQL, a stream through a broker, and kill −9 at moments drawn from a seed: "
        "{struck[server]} of a server, {struck[worker]} of a worker, {struck[database]} of the database, "
        "{struck[broker]} of the broker, {struck[scheduler]} of the scheduler of one server with its worker; "
        "{struck[way]} times the way to the database was cut for up to ten seconds.",
    ),
    "disk": _faults(
        "A full disk",
        "The disk was full for a third of the records; {refused} were refused (507) and sent again.",
    ),
    "backup": _faults(
        "Restore",
        "A backup taken of SQLite while served held {from_backup} records; it was restored into PostgreSQL "
        "after the server was killed, and all records were sent again.",
    ),
    "clock": _faults("A clock set back", "The server's clock jumped by up to a day before every record."),
    "queue": _queue,
}


def main() -> None:
    """Run the scenes that are not kept yet, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="*", choices=list(SCENES), default=list(SCENES))
    parser.add_argument("--records", type=int, default=150)
    parser.add_argument("--stored-days", type=int, default=1, help="of the turbines before load")
    parser.add_argument("--readers", type=int, default=50)
    parser.add_argument("--pace-s", type=float, default=0.0, help="least time between two records of load")
    parser.add_argument("--minutes", type=float, default=60.0, help="of the scene by the clock")
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--kill-records", type=int, default=60)
    parser.add_argument("--few", type=int, default=24)
    parser.add_argument("--queued", type=int, default=100_000)
    parser.add_argument("--turbines", type=int, default=1000, help="of the farm")
    parser.add_argument("--servers", type=int, default=2, help="of the farm")
    parser.add_argument("--farm-s", type=float, default=120.0, help="for which the farm runs at its own rate")
    parser.add_argument("--burst", type=int, default=600, help="records that the farm sends at once")
    parser.add_argument("--quiet-s", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    KEPT.mkdir(parents=True, exist_ok=True)
    for scene in given.only:
        file = KEPT / f"{scene}-{given.seed}.json"
        if file.exists():
            continue
        print(scene, "…", file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory(prefix="jackettwin-qualify-") as name:
            Path(name).chmod(0o755)  # PostgreSQL runs as a user of its own
            figures = SCENES[scene](Path(name), given)
        file.write_text(json.dumps(figures))
        print(json.dumps(figures), file=sys.stderr, flush=True)
    kept = {name: [json.loads(f.read_text()) for f in KEPT.glob(f"{name}-*.json")] for name in PAGES}
    write_page("service", page({name: pieces for name, pieces in kept.items() if pieces}))


if __name__ == "__main__":
    main()
