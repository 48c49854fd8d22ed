"""Real servers for tests: PostgreSQL and mosquitto of Debian, ``jackettwin serve``; started and killed."""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import UTC, datetime, timedelta
from functools import cache
from io import BytesIO
from pathlib import Path

import httpx
import numpy as np
import paho.mqtt.client as mqtt
import pyarrow.parquet as pq
import pytest
from paho.mqtt.enums import CallbackAPIVersion
from sqlalchemy import Engine, select
from tests.service.conftest import record_file

from jackettwin.store import assets, open_database, reading, results, sqlite_url, streams, tables

CHROMIUM = next((p for p in ("chromium", "chromium-browser", "google-chrome") if shutil.which(p)), "")
"""Name of the browser, empty where there is none."""


@contextmanager
def opened(url: str) -> Iterator[Engine]:
    """Open a database, and close every connection to it in the end."""
    database = open_database(url)
    try:
        yield database
    finally:
        database.dispose()


def free_port() -> int:
    """Return a port that nobody listens at, below those that the system gives to clients.

    A client that tries a closed port of theirs again and again is given that very port in the end, and then
    talks to itself: the server that comes back finds its place taken.
    """
    while True:
        port = random.SystemRandom().randrange(20_000, 32_000)
        with socket.socket() as s, suppress(OSError):
            s.bind(("127.0.0.1", port))
            return port


def wait_for_port(port: int, seconds: float = 20.0) -> None:
    """Wait until somebody listens."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with socket.socket() as s:
            if s.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise TimeoutError(f"nobody listens at {port}")


def found(program: str) -> str:
    """Return a program of a Debian package, which may not be on the path; skip the test without it."""
    places = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{program}"))
    place = shutil.which(program) or shutil.which(program, path="/usr/sbin:/sbin")
    place = place or (str(places[-1]) if places else None)
    if not place:
        pytest.skip(f"{program} is not installed; scripts/install-servers does")
    return place


class Database:
    """A PostgreSQL in a folder of its own, to be started, stopped and killed."""

    def __init__(self, folder: Path, **settings: str) -> None:
        self.data, self.port, self.log = folder / "data", free_port(), folder / "postgresql.log"
        self._settings = settings
        self.url = f"postgresql+psycopg://postgres@127.0.0.1:{self.port}/postgres"
        self._as_user = ["runuser", "-u", "postgres", "--"] if os.geteuid() == 0 else []
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, on what it left behind."""
        initdb, server = found("initdb"), found("postgres")
        if not self.data.exists():
            self.data.mkdir(parents=True)
            self._let_in()
            arguments = ["-D", str(self.data), "-U", "postgres", "-A", "trust", "-E", "UTF8", "--no-sync"]
            subprocess.run([*self._as_user, initdb, *arguments], check=True, capture_output=True, cwd="/")
        self._let_in()
        (self.data / "postmaster.pid").unlink(missing_ok=True)
        arguments = ["-D", str(self.data), "-p", str(self.port), "-k", "", "-h", "127.0.0.1"]
        arguments += ["-c", "fsync=off"]  # we kill it, not the machine it runs on
        arguments += [word for name, value in self._settings.items() for word in ("-c", f"{name}={value}")]
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                [server, *arguments], stdout=log, stderr=log, cwd="/", user=self._user()
            )
        wait_for_port(self.port, 120.0)
        self._wait_until_it_answers(120.0)

    def _wait_until_it_answers(self, seconds: float) -> None:
        """Wait: it listens a while before it answers, and longer if it recovers."""
        import psycopg

        end = time.monotonic() + seconds
        while True:
            try:
                psycopg.connect(self.url.replace("+psycopg", "")).close()
                return
            except psycopg.OperationalError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.1)

    def _let_in(self) -> None:
        """Let PostgreSQL, which refuses to run as root, reach its folder.

        Each time it starts: another run of pytest closes the folder of all of them.
        """
        if self._as_user:
            for parent in self.data.parents:
                if str(parent) not in ("/", "/tmp"):
                    parent.chmod(parent.stat().st_mode | 0o711)
            shutil.chown(self.data, "postgres")

    def _user(self) -> str | None:
        return "postgres" if self._as_user else None

    def kill(self) -> None:
        """Kill it, with all its processes, at once."""
        assert self._process is not None
        children = subprocess.run(
            ["pgrep", "-P", str(self._process.pid)], capture_output=True, text=True, check=False
        ).stdout.split()
        self._process.kill()
        for child in children:
            with suppress(ProcessLookupError):
                os.kill(int(child), signal.SIGKILL)
        self._process.wait(timeout=20)

    def stop(self) -> None:
        """Stop it well."""
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
            self._process.wait(timeout=20)


class Scheduler:
    """A scheduler of Dask by TLS with a worker, as on another machine; killed and started together."""

    def __init__(self, folder: Path) -> None:
        from jackettwin.service.workers.certificates import own_security

        folder.mkdir()
        self.port, self._folder, security = free_port(), folder, own_security()
        self._processes: list[subprocess.Popen[bytes]] = []
        files = {name: folder / f"{name}.pem" for name in ("ca", "certificate", "key")}
        files["ca"].write_text(security.tls_ca_file)
        files["certificate"].write_text(security.tls_scheduler_cert)
        files["key"].write_text(security.tls_scheduler_key)
        named = (("ca-file", "ca"), ("cert", "certificate"), ("key", "key"))
        self._tls = [word for option, name in named for word in (f"--tls-{option}", str(files[name]))]
        self.options = ["--scheduler", f"tls://127.0.0.1:{self.port}"]
        self.options += [word for name, path in files.items() for word in (f"--scheduler-{name}", str(path))]

    def start(self) -> None:
        """Start both; servers find them by themselves."""
        place = ["--protocol", "tls", "--host", "127.0.0.1"]
        self._run("scheduler", *place, "--port", str(self.port), "--no-dashboard")
        wait_for_port(self.port, 120.0)
        self._run("worker", f"tls://127.0.0.1:{self.port}", *place, "--nthreads", "1", "--no-dashboard")

    def _run(self, kind: str, *options: str) -> None:
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *options, *self._tls]
        with (self._folder / f"{kind}.log").open("ab") as log:
            self._processes.append(
                subprocess.Popen(command, stdout=log, stderr=log, cwd=self._folder, start_new_session=True)
            )

    def kill(self) -> None:
        """Kill both at once, the worker's nanny with it."""
        for process in self._processes:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait(timeout=20)
        self._processes = []

    stop = kill


class Relay:
    """The way to a server on loopback, which a test cuts and mends: what is on it is lost at once."""

    def __init__(self, to: int) -> None:
        self.to, self.port = to, free_port()
        self._open: set[socket.socket] = set()
        self._door: socket.socket | None = None
        self.mend()

    def mend(self) -> None:
        """Let connections through."""
        self._door = socket.create_server(("127.0.0.1", self.port))
        threading.Thread(target=self._accept, args=(self._door,), daemon=True).start()

    def cut(self) -> None:
        """End every connection, and take no more."""
        door, self._door = self._door, None
        if door is not None:
            with suppress(OSError):
                door.shutdown(socket.SHUT_RDWR)
            door.close()
        for end in list(self._open):
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def _accept(self, door: socket.socket) -> None:
        with suppress(OSError):  # the door is closed
            while True:
                one, _ = door.accept()
                try:
                    other = socket.create_connection(("127.0.0.1", self.to))
                except OSError:
                    one.close()
                    continue
                self._open |= {one, other}
                for ends in ((one, other), (other, one)):
                    threading.Thread(target=self._carry, args=ends, daemon=True).start()

    def _carry(self, source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while part := source.recv(65536):
                sink.sendall(part)
        for end in (source, sink):
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
        with suppress(OSError):
            source.close()
        self._open.discard(source)


@contextmanager
def postgresql(folder: Path) -> Iterator[str]:
    """Run a PostgreSQL; yields the URL of its first database."""
    database = Database(folder)
    try:
        database.start()
        yield database.url
    finally:
        database.stop()


class Broker:
    """A mosquitto that keeps sessions and messages in a folder, to be started and killed."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self.folder, self.port = folder, free_port()
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, on what it left behind."""
        config = self.folder / "mosquitto.conf"
        user = "user root\n" if os.geteuid() == 0 else ""
        config.write_text(
            f"listener {self.port} 127.0.0.1\nallow_anonymous true\n{user}persistence true\n"
            f"persistence_location {self.folder}/\nautosave_interval 1\nautosave_on_changes true\n"
            "max_queued_messages 0\n"
        )
        self._process = subprocess.Popen([found("mosquitto"), "-c", str(config)], **_quiet())
        wait_for_port(self.port)

    def kill(self) -> None:
        """Kill it at once."""
        assert self._process is not None
        self._process.kill()
        self._process.wait(timeout=20)

    def stop(self) -> None:
        """Stop it."""
        if self._process is not None and self._process.poll() is None:
            self.kill()


class Server:
    """``jackettwin serve`` as a process of its own."""

    def __init__(self, store: Path, *options: str, log: Path | None = None) -> None:
        self.store, self.options, self.port = store, options, free_port()
        self.url = f"http://127.0.0.1:{self.port}"
        self._process: subprocess.Popen[bytes] | None = None
        self._log = log or store.parent / "serve.log"

    def __enter__(self) -> Server:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def start(self) -> None:
        """Start it and wait until it is ready."""
        arguments = ["serve", str(self.store), "--port", str(self.port), *self.options]
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "jackettwin", *arguments],
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        end = time.monotonic() + 120.0
        while time.monotonic() < end and self._process.poll() is None:
            with suppress(httpx.TransportError):
                if self.get("/api/v1/health").status_code == 200:
                    return
            time.sleep(0.2)
        raise TimeoutError(self._log.read_text()[-2000:])

    def get(self, path: str) -> httpx.Response:
        """Ask."""
        return httpx.get(self.url + path, timeout=60.0, verify=False)  # no certificates to load

    def post(self, name: str, file: bytes, description: str, asset: str = "wtg") -> httpx.Response:
        """Send a record."""
        return httpx.post(
            f"{self.url}/api/v1/assets/{asset}/records",
            files={"file": (name, file)},
            data={"description": description},
            timeout=120.0,
        )

    def send(self, name: str, file: bytes, description: str, asset: str = "wtg") -> None:
        """Send a record until it is taken, as a client does that must not lose it, and has the time."""
        end = time.monotonic() + 600.0
        while time.monotonic() < end:
            with suppress(httpx.TransportError):
                answer = self.post(name, file, description, asset)
                if answer.status_code in (200, 202):
                    return
            time.sleep(0.5)
        raise TimeoutError(f"{name} is not taken: {self._log.read_text()[-2000:]}")

    def wait_until_observed(self, n: int, seconds: float = 240.0) -> None:
        """Wait until so many records are observed."""
        end = time.monotonic() + seconds
        counts: Counter[str] = Counter()
        while time.monotonic() < end:
            with suppress(httpx.TransportError, KeyError):
                counts = self.records()
                if (
                    counts.get("observed", 0) >= n
                    and not counts.get("observing")
                    and not counts.get("received")
                ):
                    return
            time.sleep(0.3)
        raise TimeoutError(f"{counts}: {self._log.read_text()[-2000:]}")

    def wait_for_windows(self, seconds: float = 600.0) -> None:
        """Wait until every packet of a stream is in a record."""
        end = time.monotonic() + seconds
        with self._database() as database:
            while time.monotonic() < end:
                with reading(database) as connection:
                    if not streams.open_windows(connection):
                        return
                time.sleep(1.0)
        raise TimeoutError("packets wait for their record")

    def records(self) -> Counter[str]:
        """Return how many records have each status, of all turbines."""
        counts: Counter[str] = Counter()
        for asset in self.get("/api/v1/assets").json()["items"]:
            counts.update(asset["records"])
        return counts

    def states(self) -> dict[str, str]:
        """Return the content hash of the state of every day of every turbine."""
        with self._database() as database, reading(database) as connection:
            return {
                f"{asset} {day}": found
                for asset in assets.asset_names(connection)
                for day, found in results.state_hashes(
                    connection, asset, assets.found_version(connection, asset).model_hash
                ).items()
            }

    def counts(self) -> dict[str, int]:
        """Return how many records and observations count: not those that others took the place of."""
        with self._database() as database, reading(database) as connection:
            counted = select(tables.records.c.record_id).where(tables.records.c.status != "set_aside")
            return {
                "records": len(connection.execute(counted).all()),
                "observations": len(connection.execute(select(tables.observations.c.record_id)).all()),
            }

    def cpu_s(self) -> tuple[float, float]:
        """Return the CPU seconds of the server's own process and of its workers so far."""
        assert self._process is not None
        return _cpu_s(self._process.pid), sum(_cpu_s(pid) for pid in self.workers())

    def own_bytes(self) -> dict[int, int]:
        """Return the memory that the server's own process, then each worker, shares with no other process."""
        assert self._process is not None
        return {pid: _own_bytes(pid) for pid in (self._process.pid, *sorted(self.workers()))}

    @contextmanager
    def _database(self) -> Iterator[Engine]:
        url = self.options[self.options.index("--database") + 1] if "--database" in self.options else None
        with opened(url or sqlite_url(self.store)) as database:
            yield database

    def workers(self) -> list[int]:
        """Return the processes that observe."""
        if self._process is None:
            return []
        found = subprocess.run(
            ["pgrep", "-s", str(self._process.pid), "-f", "spawn_main"],
            capture_output=True,
            text=True,
            check=False,
        )
        return [int(pid) for pid in found.stdout.split()]

    def kill_a_worker(self) -> bool:
        """Kill the newest worker at once."""
        workers = self.workers()
        if workers:
            os.kill(workers[-1], signal.SIGKILL)
        return bool(workers)

    def workers_alive(self, seconds: float = 20.0) -> bool:
        """Tell whether a worker outlives the server by so long."""
        end = time.monotonic() + seconds
        while self.workers() and time.monotonic() < end:
            time.sleep(0.2)
        return bool(self.workers())

    def kill(self) -> None:
        """Kill the server at once; its workers end by themselves."""
        assert self._process is not None
        self._process.kill()
        self._process.wait(timeout=20)

    def stop(self) -> None:
        """Stop it as Ctrl-C does."""
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
            try:
                self._process.wait(timeout=30)
            except subprocess.TimeoutExpired:
                self.kill()


@cache
def stream() -> dict[str, np.ndarray]:
    """Return what two channels with a mode each measure in half an hour."""
    table = pq.read_table(BytesIO(record_file(7, samples=36_000)))
    return {name: table[name].to_numpy() for name in table.column_names}


def publish(
    port: int, *, first_s: float, last_s: float, seed: int, doubled: bool = False, asset: str = "wtg"
) -> None:
    """Send two channels as packets of five seconds, in disorder, some of them twice."""
    rng = random.Random(seed)
    start = datetime(2025, 3, 1, 12, tzinfo=UTC)
    bodies = []
    for k in range(round(first_s / 5.0), round(last_s / 5.0)):
        part = slice(100 * k, 100 * (k + 1))
        channels = {name: row[part].round(4).tolist() for name, row in stream().items()}
        t0 = (start + timedelta(seconds=5.0 * k)).isoformat()
        bodies.append(json.dumps({"t0_utc": t0, "rate_hz": 20.0, "channels": channels}))
    if doubled:
        bodies += bodies[::4]
    # disorder within a minute, as networks make it
    bodies = [b for _, b in sorted(enumerate(bodies), key=lambda item: item[0] + rng.uniform(0.0, 12.0))]
    client = mqtt.Client(CallbackAPIVersion.VERSION2, client_id=f"logger{seed}")
    client.connect("127.0.0.1", port)
    client.loop_start()
    sent = [client.publish(f"jackettwin/{asset}", body, qos=1) for body in bodies]
    for message in sent:
        message.wait_for_publish(timeout=30.0)
    client.disconnect()
    client.loop_stop()


def _cpu_s(pid: int) -> float:
    with suppress(FileNotFoundError, ProcessLookupError):
        after_name = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        return (int(after_name[11]) + int(after_name[12])) / os.sysconf("SC_CLK_TCK")
    return 0.0


def _own_bytes(pid: int) -> int:
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return 1024 * sum(int(line.split()[1]) for line in lines if line.startswith("Private_"))


def _quiet() -> dict[str, int]:
    return {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
