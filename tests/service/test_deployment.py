"""The documented unit file, and two servers on one store: as they run at an operator's."""

from __future__ import annotations

import socket
import time
from pathlib import Path

import pytest
from tests.service.conftest import description, hour, record_file
from tests.service.servers import Server
from tests.service.test_survival import new_store

from jackettwin.service.systemd import tell_systemd
from jackettwin.service.work.dispatch import DEAD_AFTER_S

ROOT = Path(__file__).parents[2]
UNIT = ROOT / "deploy" / "jackettwin.service"


def test_the_documented_unit_is_the_one_that_is_shipped() -> None:
    assert UNIT.read_text() in (ROOT / "docs" / "reference" / "service.md").read_text()


def test_systemd_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tell_systemd("READY=1")  # nobody listens
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as system:
        system.bind(str(tmp_path / "notify"))
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        tell_systemd("WATCHDOG=1")
        assert system.recv(100) == b"WATCHDOG=1"


def test_one_of_two_servers_takes_the_inbox_and_the_other_takes_over(tmp_path: Path) -> None:
    """Each record once, none refused; who is silent for half of the 30 s that are promised is dead."""
    assert DEAD_AFTER_S <= 15.0
    store = new_store(tmp_path, "wtg")
    with Server(store, "--workers", "1", log=tmp_path / "one") as first:
        with Server(store, "--workers", "1", log=tmp_path / "two") as second:
            for k in range(6):
                _drop(store, k)
            _until_there(second, 6, 240.0)
            first.kill()
            _drop(store, 6)
            _until_there(second, 7, 240.0)
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
