"""Real processes, really killed: every record observed once, states as if nothing had happened.

The campaign of full size is ``python qualify/service.py``; this is the same in small.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from playwright.sync_api import Page, expect, sync_playwright
from tests.service.conftest import HERE, description, hour, make_service, record_file, upload
from tests.service.servers import CHROMIUM, Broker, Database, Server, opened, publish

from jackettwin.service import add_twin, take_here
from jackettwin.service.web import pages
from jackettwin.service.web.app import create_app
from jackettwin.service.workers import engine
from jackettwin.service.workers.tasks import File, read_file
from jackettwin.store import sqlite_url, work, writing
from jackettwin.store.backup import backup, restore
from jackettwin.store.columns import rounded

RECORDS = 5
SAMPLES = 2400
TWIN = """structure: jacket15
identification: {max_order: 12}
update: {laws: [kelvin-voigt], particles: 20, starts: 2}
sensors:
  - {channel: acc_top_x, height_m: 120.0, direction: [1, 0, 0]}
  - {channel: acc_top_y, height_m: 120.0, direction: [0, 1, 0]}
"""


def records() -> list[tuple[str, bytes, str]]:
    """Return (name, file, description) of records whose identification takes a moment."""
    return [
        (f"r{k}.parquet", record_file(k, samples=SAMPLES), description(hour(6 + 2 * k)))
        for k in range(RECORDS)
    ]


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What one process without a server knows in the end, of observations with the digits that are kept."""
    folder = tmp_path_factory.mktemp("undisturbed")
    (folder / "twin.yaml").write_text(TWIN)
    model = engine.load_twin(folder).model
    documents: dict[str, list[str]] = {}
    for name, content, beside in records():
        (folder / name).write_bytes(content)
        (folder / name).with_suffix(".json").write_text(beside)
        (parsed,) = read_file(File(str(folder / name), "wtg", str(folder), 10**9, 2**31, hour(48)))
        assert parsed.waveform is not None
        observed = engine.observed(model, folder / parsed.waveform, {})[0]
        documents.setdefault(parsed.about["start_utc"][:10], []).append(rounded(observed))
    days = {day: engine.advance_day(model, day, None, seen).document for day, seen in documents.items()}
    return {f"wtg {day}": hashlib.sha256(text.encode()).hexdigest() for day, text in days.items()}


def new_store(folder: Path, *names: str) -> Path:
    store = folder / "store"
    store.mkdir()
    twin = folder / "twin.yaml"
    twin.write_text(TWIN)
    with opened(sqlite_url(store)) as database:
        for name in names:
            add_twin(database, store, name, twin)
    return store


@contextmanager
def reader(url: str) -> Iterator[Page | None]:
    """Yield a page of the window that a reader opened before anything happened; None without a browser."""
    if not CHROMIUM or not pages._built():
        yield None
        return
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which(CHROMIUM), args=["--no-sandbox"])
        page = browser.new_page()
        page.goto(f"{url}/assets/wtg/records")
        expect(page.get_by_title("Connection: live")).to_be_visible(timeout=60_000)
        yield page
        browser.close()


def test_kills_of_server_worker_and_broker_do_not_show(tmp_path: Path, expected: dict[str, str]) -> None:
    """Records, and a stream of two windows, shuffled and doubled; a reader sees it without loading again."""
    broker = Broker(tmp_path / "broker")
    broker.start()
    server = Server(
        new_store(tmp_path, "wtg", "stream"), "--workers", "1", "--mqtt", f"mqtt://127.0.0.1:{broker.port}"
    )
    server.start()
    sent = records()
    stack = ExitStack()
    try:
        wait_for(lambda: server.get("/api/v1/ready").json()["broker"])
        page = stack.enter_context(reader(server.url))
        server.send(*sent[0])
        server.send(*sent[1])
        assert {os.getpriority(os.PRIO_PROCESS, pid) for pid in server.workers()} == {os.nice(0) + 5}
        assert server.kill_a_worker()
        publish(broker.port, first_s=0.0, last_s=650.0, seed=1, doubled=True, asset="stream")
        server.send(*sent[2])
        server.kill()
        if page:
            expect(page.get_by_text("The server does not answer.").first).to_be_visible(timeout=60_000)
        publish(broker.port, first_s=650.0, last_s=900.0, seed=2, asset="stream")
        server.start()
        server.send(*sent[3])
        broker.kill()
        broker.start()
        publish(broker.port, first_s=900.0, last_s=1260.0, seed=3, asset="stream")
        server.send(*sent[4])
        server.wait_until_observed(RECORDS + 2)
        states = server.states()
        assert {day: states[day] for day in states if day.startswith("wtg ")} == expected
        counts = server.counts()
        assert counts["records"] == counts["observations"]
        assert len(server.get("/api/v1/assets/wtg/records").json()["items"]) == RECORDS
        rows = server.get("/api/v1/assets/stream/records?status=observed").json()["items"][::-1]
        assert [r["start_utc"] for r in rows[:2]] == ["2025-03-01T12:00:00Z", "2025-03-01T12:10:00Z"]
        found = server.get(f"/api/v1/records/{rows[0]['record_id']}/signal?points=1").json()
        assert set(found["channels"]) == {"acc_top_x", "acc_top_y"}
        if page:
            rows_shown = page.get_by_role("region", name="Records", exact=True).locator("tbody .observed")
            expect(rows_shown).to_have_count(RECORDS, timeout=60_000)
            expect(page.get_by_text("The server does not answer.")).to_have_count(0)
    finally:
        stack.close()
        server.stop()
        broker.stop()
    assert not server.workers_alive()


def restored_store(folder: Path, database: str) -> Path:
    """Return a store restored from the backup of another, in which a record was under way."""
    before = new_store(folder, "wtg")
    name, content, beside = records()[0]
    (folder / name).write_bytes(content)
    (folder / name).with_suffix(".json").write_text(beside)
    with opened(sqlite_url(before)) as old:
        assert take_here(old, before, "wtg", folder / name).new
        with writing(old) as connection:
            assert len(work.lease(connection, "a server that is gone", 1, hour(6))) == 1
        backup(old, before, folder / "yesterday.tar.gz")
    again = folder / "again" / "store"
    again.mkdir(parents=True)
    with opened(database) as new:
        assert restore(folder / "yesterday.tar.gz", new, again)["records"] == 1
    return again


def test_a_database_that_dies_is_waited_for_by_two_servers(tmp_path: Path, expected: dict[str, str]) -> None:
    """It was restored from a backup; one of them dies for good, too, with what it had taken."""
    database = Database(tmp_path / "postgresql")
    database.start()
    try:
        store = restored_store(tmp_path, database.url)
        options = ("--workers", "1", "--database", database.url)
        with Server(store, *options) as server, Server(store, *options) as dying:
            sent = records()
            dying.send(*sent[0])
            dying.send(*sent[1])
            dying.kill()
            for one in sent[:3]:
                server.send(*one)
            database.kill()
            assert server.get("/api/v1/ready").status_code == 503
            database.start()
            for one in sent:  # a client that got no answer sends again
                server.send(*one)
            server.wait_until_observed(RECORDS)
            assert server.states() == expected
            assert server.counts() == {"records": RECORDS, "observations": RECORDS}
    finally:
        database.stop()


def test_a_full_disk_is_said_and_nothing_is_half_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a file system of its own, where the machine lets us make one."""
    folder = tmp_path / "small"
    folder.mkdir()
    if os.geteuid() != 0 or os.system(f"mount -t tmpfs -o size=40m tmpfs {folder} 2>/dev/null") != 0:
        pytest.skip("needs the right to mount a small file system")
    try:
        for full in make_service(folder / "store", None, monkeypatch):
            with TestClient(create_app(full), base_url="http://127.0.0.1:8470", client=HERE) as client:
                answer = upload(client)
                assert answer.status_code == 507
                assert "full" in answer.json()["detail"]
                assert client.get("/api/v1/assets/wtg/records").json()["items"] == []
            assert list(full.settings.spool.iterdir()) == []
    finally:
        os.system(f"umount -l {folder}")
        shutil.rmtree(folder, ignore_errors=True)


def wait_for(condition, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.2)
