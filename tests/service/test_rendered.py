"""Answers are made once for each version of the store: never an old one, and at a fixed price in queries."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from typing import get_type_hints

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import event
from tests.service.conftest import HERE, NOON, TWIN, make_service, turn, upload

from jackettwin.service import adopt_version, rebuild
from jackettwin.service.answer_cache import Answer, AnswerCache, has_tag
from jackettwin.service.context import Service
from jackettwin.service.web.app import create_app
from jackettwin.service.web.dependencies import ReadsAtVersion
from jackettwin.service.web.routes import assets, assumptions, findings, modes, records
from jackettwin.service.work.housekeeping import Housekeeping, end_mutes, prune
from jackettwin.store import journal, results, writing
from jackettwin.store.tables import events

QUERIES = {
    "/assets": 9,
    "/assets/{asset}": 9,
    "/assets/{asset}/versions": 6,
    "/assets/{asset}/records": 4,
    "/records/{record_id}": 3,
    "/assets/{asset}/modes": 4,
    "/assets/{asset}/modes/bins": 16,  # one for each label of a mode
    "/assets/{asset}/twin": 7,
    "/assets/{asset}/supports": 4,
    "/assets/{asset}/damping-budget": 7,
    "/assets/{asset}/sensitivity": 7,
    "/assets/{asset}/explore": 4,
    "/assets/{asset}/structure": 5,
    "/assets/{asset}/assumptions": 4,
    "/assets/{asset}/comparison": 12,
    "/assets/{asset}/life": 4,
    "/assets/{asset}/findings": 5,
    "/assets/{asset}/alarms": 5,
    "/assets/{asset}/watch": 4,
}
"""The most statements that an answer made anew may cost: who asks, which version, and what is asked for."""
AGAIN = 2
"""Of an answer that is known: who asks, and which version."""


def told() -> list[str]:
    """Return the paths of all routes whose answers change with an event only."""
    routes = [
        route for module in (assets, assumptions, findings, modes, records) for route in module.router.routes
    ]
    hints = [(r.path, get_type_hints(inspect.unwrap(r.endpoint), include_extras=True)) for r in routes]
    return [path for path, found in hints if ReadsAtVersion in found.values()]


def test_every_answer_about_assets_has_a_version() -> None:
    """But not an export: it is sent as it is read, and every download is noted down."""
    assert set(told()) == set(QUERIES)


def filled(path: str, client: TestClient) -> str:
    items = client.get("/api/v1/assets/wtg/records").json()["items"]
    known = items[0]["record_id"] if items else "0123456789abcdef"
    return (
        "/api/v1"
        + path.format(asset="wtg", record_id=known)
        + ("?version=1" if path.endswith("comparison") else "")
    )


@contextmanager
def counted(service: Service) -> Iterator[list[str]]:
    statements: list[str] = []

    def count(_c: object, _cursor: object, statement: str, *_: object) -> None:
        if (
            not statement.startswith("BEGIN") and "events.payload" not in statement
        ):  # the feed's look for news
            statements.append(statement)

    event.listen(service.database, "before_cursor_execute", count)
    yield statements
    event.remove(service.database, "before_cursor_execute", count)


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[TestClient, Service]]:
    """Two turbines, one of them with two versions and four records."""
    patch = pytest.MonkeyPatch()
    for service in make_service(tmp_path_factory.mktemp("standing"), None, patch):
        with TestClient(create_app(service), base_url="http://127.0.0.1:8470", client=HERE) as client:
            client.post("/api/v1/assets", json={"name": "other", "twin": TWIN})
            client.put("/api/v1/assets/wtg", json={"twin": TWIN + "gravity: false\n"})
            for k in range(4):
                upload(client, k)
            turn(service, 8)
            yield client, service
    patch.undo()


@pytest.mark.parametrize("path", QUERIES)
def test_an_answer_costs_so_many_queries_and_a_known_one_two(
    standing: tuple[TestClient, Service], path: str
) -> None:
    client, service = standing
    url = filled(path, client)
    service.answers = AnswerCache()
    with counted(service) as statements:
        first = client.get(url)
    assert first.status_code == 200
    assert len(statements) <= QUERIES[path], statements
    with counted(service) as statements:
        assert client.get(url).content == first.content
    assert len(statements) <= AGAIN, statements
    with counted(service) as statements:
        assert client.get(url, headers={"If-None-Match": first.headers["etag"]}).status_code == 304
    assert len(statements) <= AGAIN, statements


def test_no_change_leaves_an_old_answer(client: TestClient, service: Service) -> None:
    """Whatever happens, an answer that became another one has another version."""
    picks = {"picks": [{"frequency_hz": 0.5}]}
    first: list[str] = []

    def remember() -> None:
        first.append(client.get("/api/v1/assets/wtg/records").json()["items"][0]["record_id"])

    def alarm() -> None:
        with writing(service.database) as connection:
            row = {"asset": "wtg", "model_hash": _model(client), "record_id": "", "origin": "watch"}
            said = {
                "code": "structure_changed",
                "severity": "alarm",
                "subject": None,
                "params": {},
                "text": "!",
            }
            results.put_findings(connection, [{**row, **said, "time_utc": NOON, "day": "2025-03-01"}])
            journal.tell(connection, "finding", "wtg", {}, service.now())

    def acknowledged() -> None:
        number = client.get("/api/v1/assets/wtg/alarms").json()["items"][0]["id"]
        assert (
            client.post(f"/api/v1/alarms/{number}/acknowledge", json={"comment": "seen"}).status_code == 200
        )

    def forgotten() -> None:
        service.settings = service.settings.model_copy(update={"raw_days": 7.0})
        service.now = lambda: NOON + timedelta(days=20)
        Housekeeping(service)
        assert prune(service) > 0

    def muted() -> None:
        number = client.get("/api/v1/assets/wtg/alarms").json()["items"][0]["id"]
        until = (service.now() + timedelta(days=1)).isoformat()
        answer = client.post(f"/api/v1/findings/{number}/mute", json={"until_utc": until})
        assert answer.status_code == 200

    def mute_over() -> None:
        now = service.now()
        service.now = lambda: now + timedelta(days=2)
        end_mutes(service)

    steps: list[Callable[[], object]] = [
        lambda: upload(client, 1),
        remember,
        lambda: turn(service),
        lambda: upload(client, 2),
        lambda: client.post("/api/v1/jobs/3/cancel"),
        lambda: client.post("/api/v1/jobs/3/retry"),
        lambda: turn(service),
        lambda: client.put(f"/api/v1/records/{first[0]}/picks", json=picks),
        lambda: turn(service),
        lambda: client.put("/api/v1/assets/wtg", json={"twin": TWIN + "gravity: false\n"}),
        lambda: turn(service, 8),
        lambda: client.post("/api/v1/assets/wtg/versions/2/adopt"),
        lambda: adopt_version(service.database, service.settings.store, "wtg", 1),
        lambda: client.post("/api/v1/assets", json={"name": "other", "twin": TWIN}),
        lambda: client.delete("/api/v1/assets/other?confirm=other"),
        alarm,
        muted,
        mute_over,
        acknowledged,
        lambda: rebuild(service.database, service.settings.store, None, None),
        forgotten,
    ]
    changed = 0
    before: dict[str, tuple[bytes, str]] = {}
    for number, step in enumerate(steps):
        step()
        urls = [filled(path, client) for path in QUERIES]
        service.answers = AnswerCache()
        found = {url: client.get(url) for url in urls}
        now = {url: (answer.content, answer.headers["etag"]) for url, answer in found.items()}
        for url in now.keys() & before.keys():
            same_body, same_tag = (a == b for a, b in zip(now[url], before[url], strict=True))
            assert same_body or not same_tag, (number, url)
            changed += not same_body
        before = now
    assert changed > 40


def test_answers_kept_take_no_more_than_their_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("jackettwin.service.answer_cache._MOST_BYTES", 5000)
    kept = AnswerCache()
    for k in range(10):
        kept.keep(f"/{k}", Answer.of(1, b"body"))
    assert kept.find("/9", 1) is not None and kept.find("/9", 1).body == b"body"  # type: ignore[union-attr]
    assert kept.find("/9", 2) is None
    assert [k for k in range(10) if kept.find(f"/{k}", 1)] == [6, 7, 8, 9]


def test_tags_are_compared_as_http_says() -> None:
    assert has_tag('"x", W/"a-1"', 'W/"a-1"')
    assert has_tag('"a-1"', 'W/"a-1"')  # what a proxy that compresses makes of it
    assert not has_tag('"a-12"', 'W/"a-1"')
    assert not has_tag(None, 'W/"a-1"')


def test_versions_outlive_the_events_that_readers_need(service: Service, client: TestClient) -> None:
    upload(client, 1)
    with writing(service.database) as connection:
        last = journal.last_event(connection, "wtg")
        journal.forget_events(connection, service.now() + timedelta(days=30))
        assert journal.last_event(connection, "wtg") == last
        assert len(connection.execute(events.select()).all()) == 1


def _model(client: TestClient) -> str:
    return str(client.get("/api/v1/assets/wtg").json()["model_hash"])


def test_a_reader_who_cannot_unpack_gets_it_plain(client: TestClient) -> None:
    packed = client.get("/api/v1/assets", headers={"Accept-Encoding": "gzip"})
    plain = client.get("/api/v1/assets", headers={"Accept-Encoding": "identity"})
    assert (packed.headers["content-encoding"], "content-encoding" in plain.headers) == ("gzip", False)
    assert packed.json() == plain.json()
    assert "Accept-Encoding" in plain.headers["vary"]
