"""The documented unit file, and two servers on one store: as they run at an operator's."""

from __future__ import annotations

import configparser
import os
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import httpx
import pytest
from tests.service.conftest import description, hour, record_file
from tests.service.servers import Server, free_port
from tests.service.test_survival import new_store

from jackettwin.service.systemd import tell_systemd

ROOT = Path(__file__).parents[2]
UNIT = ROOT / "deploy" / "jackettwin.service"
NOBODY = 65534
READS = "--inh-caps=+dac_read_search --ambient-caps=+dac_read_search"
"""What lets another user read, not write, where we are installed: that may be somebody's home."""


def unit() -> configparser.SectionProxy:
    parser = configparser.ConfigParser(interpolation=None, strict=False)
    parser.optionxform = str  # type: ignore[assignment, method-assign]
    parser.read(UNIT)
    return parser["Service"]


def test_the_documented_unit_is_the_one_that_is_shipped() -> None:
    assert UNIT.read_text() in (ROOT / "docs" / "reference" / "service.md").read_text()


def test_systemd_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tell_systemd("READY=1")  # nobody listens
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as system:
        system.bind(str(tmp_path / "notify"))
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        tell_systemd("WATCHDOG=1")
        assert system.recv(100) == b"WATCHDOG=1"


@pytest.mark.skipif(os.geteuid() != 0, reason="only root becomes another user, with another view of the disk")
def test_the_unit_runs_as_another_user_who_may_write_the_store_alone(tmp_path: Path) -> None:
    """ProtectSystem=strict, ProtectHome, PrivateTmp and User of the unit, by ``unshare``.

    Numba compiles, and Dask starts workers, in processes that may write nothing but STORE.
    """
    given = unit()
    assert (given["ProtectSystem"], given["ProtectHome"], given["PrivateTmp"]) == ("strict", "true", "true")
    place = Path(tempfile.mkdtemp(dir="/srv"))  # not below /tmp, which is its own
    place.chmod(0o755)
    store, port = new_store(place, "wtg"), free_port()
    heard = place / "notify"
    words = shlex.split(given["ExecStart"].replace(given["ReadWritePaths"], str(store)))
    served = [w for w in words[1:] if w != "--behind-proxy"]  # which asks for users
    command = [sys.executable, "-m", "jackettwin", *served, "--port", str(port), "--workers", "1"]
    for path in (store, *store.rglob("*")):
        os.chown(path, NOBODY, NOBODY)
    sealed = (
        "mount --bind / / && mount --rbind /dev /dev && mount -o remount,bind,ro / && "
        f"mount --bind {store} {store} && mount -o remount,bind,rw {store} && mount -t tmpfs tmpfs /tmp && "
        f"chmod 1777 /tmp && cd / && exec setpriv --reuid={NOBODY} --regid={NOBODY} --clear-groups {READS} "
        + shlex.join(command)
    )
    environment = {
        "PATH": os.environ["PATH"],
        "PYTHONPATH": os.environ.get("PYTHONPATH", str(ROOT / "src")),
        "HOME": "/nonexistent",
        "JACKETTWIN_SERVE_PARSE_LIMIT_S": "600",  # everything is compiled first
        "NOTIFY_SOCKET": str(heard),
    }
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as system:
        system.bind(str(heard))
        heard.chmod(0o777)
        system.settimeout(120.0)
        log = (place / "log").open("wb")
        process = subprocess.Popen(
            ["unshare", "--mount", "sh", "-c", sealed], env=environment, stdout=log, stderr=log
        )
        try:
            told = {system.recv(100)}
            while b"READY=1" not in told:
                told.add(system.recv(100))
            url = f"http://127.0.0.1:{port}/api/v1"
            files = {"file": ("r.parquet", record_file(0, samples=4000))}
            sent = httpx.post(
                f"{url}/assets/wtg/records",
                files=files,
                data={"description": description(hour(0))},
                timeout=600.0,
            )
            assert sent.status_code == 202, sent.text
            end = time.monotonic() + 240.0
            states: list[str] = []
            while time.monotonic() < end and states.count("done") < 2:
                jobs = httpx.get(f"{url}/jobs", timeout=60.0).json()["items"]
                states = [job["state"] for job in jobs]
                assert not {"failed", "set_aside"} & set(states), jobs
                time.sleep(1.0)
            assert states.count("done") == 2, (place / "log").read_text()  # it was observed, and studied
            assert httpx.get(f"{url}/health", timeout=60.0).json()["status"] == "ok"
            assert any((store / "cache").rglob("*.nbi"))
            told.add(system.recv(100))
            assert b"WATCHDOG=1" in told
        finally:
            process.send_signal(getattr(signal, given["KillSignal"]))
            with suppress(subprocess.TimeoutExpired):
                process.wait(timeout=60)
            process.kill()
            subprocess.run(["rm", "-rf", str(place)], check=True)


def test_one_of_two_servers_takes_the_inbox_and_the_other_takes_over(tmp_path: Path) -> None:
    """Each record once, none refused, and at most 30 s without anybody."""
    store = new_store(tmp_path, "wtg")
    with Server(store, "--workers", "1", log=tmp_path / "one") as first:
        with Server(store, "--workers", "1", log=tmp_path / "two") as second:
            for k in range(6):
                _drop(store, k)
            _until_there(second, 6, 240.0)
            first.kill()
            _drop(store, 6)
            _until_there(second, 7, 30.0)
            assert second.counts()["records"] == 7
    assert list((store / "inbox" / "wtg").iterdir()) == []  # none is left, or was refused


def _until_there(server: Server, n: int, seconds: float) -> None:
    """Wait until so many records are in the store, whatever becomes of them."""
    end = time.monotonic() + seconds
    while server.records().total() < n:
        assert time.monotonic() < end
        time.sleep(0.3)


def _drop(store: Path, k: int) -> None:
    """Write a record into the inbox, its description before it."""
    folder = store / "inbox" / "wtg"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"r{k}.json").write_text(description(hour(k)))
    (folder / f"r{k}.parquet").write_bytes(record_file(k))
