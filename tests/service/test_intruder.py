"""What an intruder tried against a server, and may not try with success."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import cbor2
import psutil
import pytest
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings, strategies as st
from tests.service.conftest import HERE, PASSWORD, Done, description, make_service, record_file, turn, upload
from tests.service.test_security import token
from tests.store.conftest import fresh

from jackettwin.errors import InputError
from jackettwin.service.answer_cache import Answer, AnswerCache
from jackettwin.service.context import Service
from jackettwin.service.intake.packets import read_packets
from jackettwin.service.web import app as web, auth
from jackettwin.service.web.app import create_app
from jackettwin.service.web.routes import health
from jackettwin.service.work import consequences
from jackettwin.service.workers import engine
from jackettwin.service.workers.file_access import only_files_in
from jackettwin.store import people, records, writing

FORM = {"Content-Type": "multipart/form-data; boundary=b"}
JSON = {"Content-Type": "application/json"}


def pieces(n: int) -> Iterator[bytes]:
    """Yield the parts of an upload that does not say its length."""
    yield b'--b\r\nContent-Disposition: form-data; name="file"; filename="x.parquet"\r\n\r\n'
    for _ in range(n):
        yield b"x" * 10_000
    yield b"\r\n--b--\r\n"


def test_a_stranger_sends_no_body(stranger: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """The framework reads a body before it asks a route who may send it."""
    monkeypatch.setattr("starlette.requests.Request.stream", lambda _: pytest.fail("the body was read"))
    for path in ("/api/v1/assets/wtg/records", "/api/v1/assets", "/api/v1/tokens"):
        assert stranger.post(path, content=pieces(100), headers=FORM).status_code == 401


@pytest.mark.parametrize(
    ("user", "path", "most"),
    [
        (None, "/api/v1/login", "_FEW_BYTES"),
        ("viewer", "/api/v1/tokens", "_FEW_BYTES"),
        ("engineer", "/api/v1/assets", "_TEXT_BYTES"),
    ],
)
@pytest.mark.parametrize("said", [True, False])
def test_a_body_is_bounded_whether_it_says_its_length_or_not(
    stranger: TestClient,
    users: Service,
    monkeypatch: pytest.MonkeyPatch,
    user: str | None,
    path: str,
    most: str,
    said: bool,
) -> None:
    monkeypatch.setattr(web, most, 5000)
    headers = {**JSON, **(token(users, user) if user else {})}
    body = b'{"name": "' + b"x" * 6000 + b'"}'
    content: Any = body if said else iter([body[:3000], body[3000:]])
    answer = stranger.post(path, content=content, headers=headers)
    assert (answer.status_code, answer.headers["content-type"]) == (413, "application/problem+json")


def test_a_file_of_somebody_who_may_send_none_is_refused_for_that(
    stranger: TestClient, users: Service
) -> None:
    answer = stranger.post(
        "/api/v1/assets/wtg/records", content=pieces(5), headers={**FORM, **token(users, "viewer")}
    )
    assert answer.status_code == 403 and "engineer" in answer.json()["detail"]


def test_an_upload_is_bounded_if_it_does_not_say_its_length(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(web, "_FIELDS_BYTES", 1000)
    for small in make_service(tmp_path, None, monkeypatch, upload_limit_bytes=20_000):
        with TestClient(create_app(small), base_url="http://127.0.0.1:8470", client=HERE) as client:
            answer = client.post("/api/v1/assets/wtg/records", content=pieces(5), headers=FORM)
            assert answer.status_code == 413
        assert list(small.settings.spool.iterdir()) == []


@pytest.mark.parametrize("twin", ["structure: {place}\n", "structure: sent.yaml\n"])
@pytest.mark.parametrize("exists", [True, False])
def test_a_twin_reads_no_file_of_ours(client: TestClient, tmp_path: Path, twin: str, exists: bool) -> None:
    """Neither by its absolute path nor by one that climbs; what is there, and whether, is not told."""
    place = tmp_path / "secret.yaml"
    if exists:
        place.write_text("hidden words\n")
    for path in (str(place), "../" * 12 + str(place)[1:]):
        deck = f"type: subdyn\nfile: {path}\n"
        body = {"name": "spy", "twin": twin.format(place=path), "files": {"sent.yaml": deck}}
        answer = client.post("/api/v1/assets", json=body)
        assert answer.status_code == 422
        assert "hidden" not in answer.text
    assert [a["name"] for a in client.get("/api/v1/assets").json()["items"]] == ["wtg"]


def test_files_are_confined_while_they_are_read(tmp_path: Path) -> None:
    inside, outside = tmp_path / "in" / "a", tmp_path / "b"
    inside.parent.mkdir()
    inside.write_text("1")
    outside.write_text("2")
    (inside.parent / "link").symlink_to(outside)
    with only_files_in(inside.parent):
        assert inside.read_text() == "1"
        assert Path(json.__file__).read_text()
        for path in (outside, inside.parent / ".." / "b", inside.parent / "link", tmp_path / "none"):
            with pytest.raises(InputError, match="not sent with it"):
                path.read_text()
    assert outside.read_text() == "2"


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="only Linux tells of processes in files")
def test_memory_is_watched_while_files_are_guarded(tmp_path: Path) -> None:
    """Workers measure their memory in callbacks of the garbage collector, which comes at any time."""
    process = psutil.Process()
    with only_files_in(tmp_path):
        assert process.memory_info().rss > 0
        with pytest.raises(InputError, match="not sent with it"):
            Path("/proc/self/environ").read_bytes()


def test_text_that_no_database_can_keep_is_refused(
    postgresql_url: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Half a character, and in PostgreSQL a NUL."""
    for service in make_service(tmp_path, fresh(postgresql_url), monkeypatch):
        with TestClient(create_app(service), base_url="http://127.0.0.1:8470", client=HERE) as client:
            for text in ("\ud800", "a\0b"):
                asset = json.dumps({"name": "other", "twin": "structure: jacket15", "comment": text})
                assert client.post("/api/v1/assets", content=asset, headers=JSON).status_code == 422
                name = json.dumps({"name": text, "password": text})
                assert client.post("/api/v1/login", content=name, headers=JSON).status_code in (401, 422)
            assert client.get("/api/v1/assets/wtg/modes", params={"label": "a\0b"}).status_code == 422
            for name in ("a\0b.parquet", "a\r\nX: y.parquet", "../../" + "𝕏" * 300 + ".parquet"):
                files = {"file": (name, record_file(1))}
                data = {"description": description()}
                answer = client.post("/api/v1/assets/wtg/records", files=files, data=data)
                assert answer.status_code in (200, 202, 422), name


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_a_condition_is_a_number(client: TestClient, number: str) -> None:
    body = f'{{"time_utc": ["2025-03-01T12:00:00Z"], "values": {{"mean_wind_speed_m_s": [{number}]}}}}'
    assert client.post("/api/v1/assets/wtg/conditions", content=body, headers=JSON).status_code == 422
    table = f"time_utc,mean_wind_speed_m_s\n2025-03-01T12:00:00Z,{number}\n2025-03-01T12:10:00Z,8.5\n"
    files = {"file": ("t.csv", table.encode())}
    again = [client.post("/api/v1/assets/wtg/conditions.csv", files=files).json()["count"] for _ in range(2)]
    assert again[1] == 0  # what is no number is missing, not another value each time


@pytest.mark.parametrize("text", ['{"a":' * 5000 + "1" + "}" * 5000, "[" * 5000])
def test_a_description_that_is_none_is_refused(client: TestClient, text: str) -> None:
    files, data = {"file": ("r.parquet", record_file(1))}, {"description": text}
    assert client.post("/api/v1/assets/wtg/records", files=files, data=data).status_code == 422


ANYTHING = st.recursive(
    st.none() | st.integers() | st.text(max_size=3) | st.lists(st.floats(), max_size=3),
    lambda inner: st.dictionaries(st.text(max_size=3) | st.integers(), inner, max_size=3),
    max_leaves=6,
)
BODY = {
    "t0_utc": st.sampled_from(["2025-03-01T12:00:00Z", "", 5, None, ["x"]]),
    "rate_hz": st.sampled_from([20.0, "20", 10**400, None, float("nan"), {}]),
    "channels": ANYTHING,
    "samples": st.sampled_from([[1.0], [[1.0], [1.0, 2.0]], {"a": 1}, "x", 10**400, None]),
}


# the first text drawn builds tables of Unicode: a second, once
@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.sampled_from(["jackettwin/wtg", "jackettwin/wtg/a"]), st.fixed_dictionaries({}, optional=BODY))
def test_no_message_of_a_stranger_holds_up_those_behind_it(topic: str, body: dict[str, Any]) -> None:
    """Whatever it holds, it is packets or refused as input: anything else would come back for ever."""
    for payload in (cbor2.dumps(body), b'{"a":' * 100_000, b"\x81" * 100_000):
        try:
            assert all(packet.asset == "wtg" for packet in read_packets(topic, payload))
        except InputError:
            pass


def test_answers_kept_count_what_was_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reader's long questions fill no memory."""
    monkeypatch.setattr("jackettwin.service.answer_cache._MOST_BYTES", 100_000)
    kept = AnswerCache()
    for k in range(50):
        kept.keep(f"/{k}?{'x' * 20_000}", Answer.of(1, b"body"))
    assert sum(sys.getsizeof(question) for question in kept._answers) < 100_000


def test_names_at_random_are_slowed_down_too(stranger: TestClient, monkeypatch) -> None:
    monkeypatch.setattr(auth, "ATTEMPTS_FROM", 8)
    for k in range(8):
        assert stranger.post("/api/v1/login", json={"name": f"u{k}", "password": "x" * 12}).status_code == 401
    assert stranger.post("/api/v1/login", json={"name": "admin", "password": PASSWORD}).status_code == 429


def test_success_does_not_count_as_a_guess(stranger: TestClient) -> None:
    right = {"name": "viewer", "password": PASSWORD}
    assert {stranger.post("/api/v1/login", json=right).status_code for _ in range(7)} == {200, 403}


def test_no_lock_is_held_while_a_password_is_tried(
    stranger: TestClient, users: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A flood of guesses must not keep records out."""
    wrote = []

    def slow(*_: Any) -> None:
        with writing(users.database) as connection:
            people.note_down(connection, "intake", "record", "", "ok", users.now())
        wrote.append(True)

    monkeypatch.setattr(auth, "checked_login", slow)
    assert stranger.post("/api/v1/login", json={"name": "admin", "password": "x" * 12}).status_code == 401
    assert wrote == [True]


def test_a_revoked_token_is_nobodys(stranger: TestClient, users: Service) -> None:
    old, new = token(users, "engineer"), token(users, "engineer")
    assert stranger.get("/api/v1/me", headers=old).status_code == 200
    assert stranger.post("/api/v1/logout", headers=old).status_code == 204
    assert stranger.get("/api/v1/me", headers=old).status_code == 401
    assert stranger.get("/api/v1/me", headers=new).status_code == 200
    with writing(users.database) as connection:
        assert people.revoke_tokens(connection, "engineer", "another") == 0
        assert people.revoke_tokens(connection, "engineer", "test") == 1
        assert people.list_tokens(connection) == []
    assert stranger.get("/api/v1/me", headers=new).status_code == 401


def test_a_user_who_is_removed_has_no_session(stranger: TestClient, users: Service) -> None:
    stranger.post("/api/v1/login", json={"name": "viewer", "password": PASSWORD})
    assert stranger.get("/api/v1/me").status_code == 200
    with writing(users.database) as connection:
        assert people.remove_user(connection, "viewer")
        assert not people.remove_user(connection, "viewer")
    assert stranger.get("/api/v1/me").status_code == 401


def test_events_end_so_that_who_listens_is_asked_again(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(health, "_TOLD_S", 0.5)
    upload(client, 1)
    turn(service)
    with client.stream("GET", "/api/v1/events", headers={"Last-Event-ID": "0"}) as answer:
        lines = list(answer.iter_lines())  # ends by itself
    assert [line for line in lines if line.startswith("event: ")][0] == "event: asset"
    assert lines[0] == "id: 0"


def test_a_fault_of_ours_is_a_problem_document_without_its_insides(service: Service, monkeypatch) -> None:
    monkeypatch.setattr("jackettwin.service.web.catalogue.overview", lambda _: {}["secret"])
    app = create_app(service)
    with TestClient(
        app, base_url="http://127.0.0.1:8470", client=HERE, raise_server_exceptions=False
    ) as client:
        answer = client.get("/api/v1/assets")
    assert (answer.status_code, answer.json()["title"]) == (500, "Internal Server Error")
    assert "secret" not in answer.text


BOMB = "a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"{b}: &{b} [{', '.join([f'*{a}'] * 10)}]\n" for a, b in pairwise("abcdefghi")
)
"""Nine lines that stand for a thousand million numbers."""


@pytest.mark.parametrize(
    ("twin", "said"),
    [
        ("structure: jacket15\nsubdivide: 100\n", "degrees of freedom"),
        (BOMB + "structure: jacket15\n", "aliases"),
        ("structure: jacket15\nsensors: &a [*a]\n", "aliases"),
    ],
)
def test_a_twin_that_is_small_and_costs_much_is_refused_at_once(
    client: TestClient, service: Service, twin: str, said: str
) -> None:
    for method, path in (("POST", "/api/v1/assets"), ("PUT", "/api/v1/assets/wtg")):
        before = time.process_time()
        answer = client.request(method, path, json={"name": "spy", "twin": twin})
        assert time.process_time() - before < 2.0  # of minutes that it would take
        assert answer.status_code == 422 and said in answer.json()["detail"]
    assert [a["name"] for a in client.get("/api/v1/assets").json()["items"]] == ["wtg"]
    assert list(service.settings.spool.iterdir()) == []


def test_a_twin_is_evaluated_by_a_worker_while_others_write(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SQLite has one writer: within a transaction this would wait for itself."""
    asked, submit = [], service.cluster.submit

    def watched(task: Any, *given: Any, **how: Any) -> Any:
        asked.append(task.__name__)
        with writing(service.database) as connection:
            people.note_down(connection, "another", "record", "", "ok", service.now())
        return submit(task, *given, **how)

    monkeypatch.setattr(service.cluster, "submit", watched)
    body = {"name": "new", "twin": "structure: jacket15\n"}
    assert client.post("/api/v1/assets", json=body).status_code == 201
    assert client.put("/api/v1/assets/new", json=body).status_code == 200
    assert asked == ["examine_twin"] * 2


@pytest.mark.parametrize("error", [TimeoutError(), MemoryError(), RuntimeError("KilledWorker")])
def test_a_twin_that_its_worker_does_not_survive_is_refused(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    monkeypatch.setattr(service.cluster, "submit", lambda *_, **__: Done(error=error))
    answer = client.post("/api/v1/assets", json={"name": "new", "twin": "structure: jacket15\n"})
    assert (answer.status_code, answer.json()["field"]) == (422, "twin")


def test_the_server_never_builds_a_model(
    client: TestClient, service: Service, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it takes, keeps, folds and answers stands in the profile that a worker left beside the twin."""
    turn(service)
    upload(client, 1)
    turn(service)  # the worker, which is this process here, has the model in its cache now
    engine.load_twin.cache_clear()
    monkeypatch.setattr(engine, "read_twin", lambda *_, **__: pytest.fail("the server read a twin"))
    with writing(service.database) as connection:
        number = records.list_records(connection, "wtg", limit=1)[0][0].record_id
        consequences.set_aside(connection, service, "wtg", number, "a test")
    assert client.get("/api/v1/assets/wtg/twin").status_code == 200
    assert upload(client, 2).status_code == 202
