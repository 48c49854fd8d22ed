"""Who may do what: roles over every route, sessions, tokens, forged requests, guessing."""

import gzip
import re
import resource
from datetime import timedelta
from pathlib import Path
from urllib.parse import quote

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.routing import APIRoute
from fastapi.testclient import TestClient
from tests.service.conftest import HERE, NOON, PASSWORD, Done, make_service, upload

from jackettwin.errors import InputError
from jackettwin.report.pages.page import page_text
from jackettwin.service import ServiceSettings
from jackettwin.service.context import Service
from jackettwin.service.settings import refuse_exposed
from jackettwin.service.web import auth, pages
from jackettwin.service.web.app import API, ROUTERS, create_app
from jackettwin.service.workers.tasks import File, read_file
from jackettwin.store import people, results, writing

OPEN = {
    "/api/v1/login",
    "/api/v1/oidc/login",
    "/api/v1/oidc/callback",
    "/api/v1/health",
    "/api/v1/ready",
    "/",
    "/login",
    "/docs",
    "/jobs",
    "/start",
    "/users",
    "/assets/{path:path}",
    "/window/assets/{name}",
}
"""What needs no login: the window is the same for everybody, and asks the API as who is logged in."""


def token(service: Service, user: str, **lasts: float) -> dict[str, str]:
    with writing(service.database) as connection:
        lasting = timedelta(**(lasts or {"days": 1}))
        secret, _ = auth.new_grant(connection, user, "token", "test", service.now(), lasting)
    return {"Authorization": f"Bearer {secret}"}


def routes() -> list[tuple[str, str, str]]:
    """Return (method, path, role) of every route; the role is what its dependency says."""
    found = []
    for prefix, router in [*((API, router) for router in ROUTERS), ("", pages.router)]:
        for route in router.routes:
            assert isinstance(route, APIRoute)
            roles = [d.call.role for d in route.dependant.dependencies if hasattr(d.call, "role")]
            path = prefix + route.path
            found += [(method, path, roles[0] if roles else "") for method in sorted(route.methods)]
    return found


def filled(path: str) -> str:
    """Return a path with names for its parts that nothing has."""
    values = {"asset": "none", "record_id": "0123456789abcdef", "name": "index.js"}
    return re.sub(r"{(\w+)}", lambda m: values.get(m[1], "999999"), path)


def test_every_route_says_who_may() -> None:
    known = routes()
    assert len(known) > 35
    assert {path for _, path, role in known if not role} == OPEN


def test_without_login_everything_else_is_refused(stranger: TestClient) -> None:
    for method, path, role in routes():
        if role:
            assert stranger.request(method, filled(path)).status_code == 401, (method, path)


@pytest.mark.parametrize("user", people.ROLES)
def test_a_role_may_what_its_routes_say_and_no_more(stranger: TestClient, users: Service, user: str) -> None:
    headers = token(users, user)
    for method, path, role in routes():
        if not role or path in ("/api/v1/events", "/api/v1/assets/{asset}/live", "/api/v1/logout"):
            continue
        status = stranger.request(method, filled(path), headers=headers).status_code
        refused = people.ROLES.index(user) < people.ROLES.index(role)
        assert (status == 403) == refused, (method, path, role, status)
        assert status < 500


def test_a_session_needs_its_csrf_token_for_what_it_changes(stranger: TestClient) -> None:
    answer = stranger.post("/api/v1/login", json={"name": "engineer", "password": PASSWORD})
    assert answer.status_code == 200
    cookie = answer.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=strict" in cookie
    assert stranger.get("/api/v1/me").json()["role"] == "engineer"
    assert upload(stranger, 1).status_code == 403
    csrf = {"X-CSRF-Token": answer.json()["csrf_token"]}
    assert stranger.post("/api/v1/jobs/1/cancel", headers=csrf).status_code == 404
    foreign = {**csrf, "Origin": "https://elsewhere.example"}
    assert stranger.post("/api/v1/jobs/1/cancel", headers=foreign).status_code == 403
    assert stranger.post("/api/v1/logout", headers=csrf).status_code == 204
    assert stranger.get("/api/v1/me").status_code == 401


def test_cookies_are_secure_where_answers_are_encrypted(users: Service) -> None:
    object.__setattr__(users.settings, "behind_proxy", True)
    with TestClient(create_app(users), base_url="https://127.0.0.1", client=HERE) as client:
        answer = client.post("/api/v1/login", json={"name": "viewer", "password": PASSWORD})
        assert "Secure" in answer.headers["set-cookie"]
        assert "max-age" in answer.headers["strict-transport-security"]


def test_guessing_is_slowed_down(stranger: TestClient) -> None:
    wrong = {"name": "admin", "password": "not the password"}
    statuses = [stranger.post("/api/v1/login", json=wrong).status_code for _ in range(6)]
    assert statuses == [401] * 5 + [429]
    right = stranger.post("/api/v1/login", json={"name": "admin", "password": PASSWORD})
    assert right.status_code == 429
    assert int(right.headers["retry-after"]) > 0


def test_passwords_and_tokens_are_kept_as_hashes(users: Service) -> None:
    secret = token(users, "viewer")["Authorization"].split()[1]
    raw = (users.settings.store / "jackettwin.sqlite").read_bytes() + b"".join(
        p.read_bytes() for p in users.settings.store.glob("*wal")
    )
    assert secret.encode() not in raw
    assert PASSWORD.encode() not in raw
    assert b"$argon2id$" in raw


def test_expired_tokens_and_disabled_users_are_nobody(stranger: TestClient, users: Service) -> None:
    old = token(users, "viewer", seconds=-1)
    assert stranger.get("/api/v1/me", headers=old).status_code == 401
    good = token(users, "viewer")
    assert stranger.get("/api/v1/me", headers=good).status_code == 200
    with writing(users.database) as connection:
        known = people.find_user(connection, "viewer")
        assert known is not None
        connection.execute(people.users.update().where(people.users.c.name == "viewer").values(disabled=True))
    assert stranger.get("/api/v1/me", headers=good).status_code == 401


def test_an_open_server_answers_only_to_its_own_name(client: TestClient) -> None:
    """A page elsewhere may point a name of its own at 127.0.0.1 (DNS rebinding), or send forms here."""
    assert client.get("/api/v1/assets").status_code == 200
    rebound = client.get("/api/v1/assets", headers={"Host": "evil.example:8470"})
    assert rebound.status_code == 401
    forged = client.post("/api/v1/jobs/1/cancel", headers={"Origin": "https://evil.example"})
    assert forged.status_code == 403


def test_a_server_that_others_reach_needs_users_and_tls(tmp_path) -> None:
    exposed = ServiceSettings(store=tmp_path, host="0.0.0.0")
    with pytest.raises(InputError, match="no user is defined"):
        refuse_exposed(exposed, users=False)
    with pytest.raises(InputError, match="unencrypted"):
        refuse_exposed(exposed, users=True)
    refuse_exposed(ServiceSettings(store=tmp_path, host="0.0.0.0", behind_proxy=True), users=True)
    refuse_exposed(ServiceSettings(store=tmp_path), users=False)


def test_what_was_done_is_written_down(stranger: TestClient, users: Service) -> None:
    stranger.post("/api/v1/login", json={"name": "admin", "password": "wrong password"})
    with writing(users.database) as connection:
        rows = connection.execute(people.audit.select().where(people.audit.c.action == "login")).all()
    assert [(row.who, row.outcome) for row in rows] == [("admin", "refused")]


def test_answers_forbid_what_a_page_of_ours_does_not_need(client: TestClient) -> None:
    headers = client.get("/").headers
    assert headers["content-security-policy"].startswith("default-src 'self';")  # for scripts and styles too
    assert "unsafe" not in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["x-frame-options"] == "DENY"


def test_a_file_that_expands_beyond_the_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for small in make_service(tmp_path, None, monkeypatch, samples_limit=100):
        with TestClient(create_app(small), base_url="http://127.0.0.1:8470", client=HERE) as client:
            answer = upload(client, 1)
        assert (answer.status_code, answer.json()["field"]) == (422, "file")
        assert "too many samples" in answer.json()["detail"]
        assert not list(small.settings.store.glob("records/**/*.parquet"))


def test_a_file_is_stopped_while_it_expands(tmp_path: Path) -> None:
    """Thirty million zeros in some kilobytes; nothing near their 240 MB may be held meanwhile."""
    path, zeros = tmp_path / "bomb.parquet", pa.table({"x": np.zeros(10**7)})
    with pq.ParquetWriter(path, zeros.schema) as writer:
        for _ in range(3):
            writer.write_table(zeros)
    assert path.stat().st_size < 200_000
    held = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    limit = resource.getrlimit(resource.RLIMIT_DATA)
    (parsed,) = read_file(File(str(path), "wtg", str(tmp_path), 10**9, memory_bytes=0, latest_utc=NOON))
    assert parsed.problem is not None and "more memory" in parsed.problem["detail"]
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - held < 150_000
    assert resource.getrlimit(resource.RLIMIT_DATA) == limit


def test_a_file_that_is_read_too_long_is_given_up(client: TestClient, service: Service, monkeypatch) -> None:
    monkeypatch.setattr(service.cluster, "submit", lambda *_, **__: Done(error=TimeoutError()))
    answer = upload(client, 1)
    assert answer.status_code == 422 and "in time" in answer.json()["detail"]


@pytest.mark.parametrize(
    "word", ["'; drop table modes; --", '" or 1=1 --', "%' union select * from users --"]
)
def test_words_are_never_statements(client: TestClient, word: str) -> None:
    upload(client, 1)
    assert client.get("/api/v1/assets/wtg/modes", params={"label": word}).json()["items"] == []
    assert client.get(f"/api/v1/assets/{quote(word, safe='')}/twin").status_code in (404, 422)
    assert client.post("/api/v1/login", json={"name": word, "password": word}).status_code == 401
    assert client.get("/api/v1/assets/wtg/modes").status_code == 200


@pytest.mark.parametrize("bearer", ["", "x", "é" * 50, "a" * 5000, "' or '1'='1"])
def test_a_token_that_is_none_is_nobody(stranger: TestClient, bearer: str) -> None:
    headers = {"Authorization": f"Bearer {bearer}".encode()}
    assert stranger.get("/api/v1/assets", headers=headers).status_code == 401


def test_the_report_reaches_nothing_of_ours(client: TestClient, service: Service) -> None:
    """It brings scripts of its own and names of the user's; what its beginning does not list never runs."""
    assert client.get("/assets/wtg/report").status_code == 404
    with writing(service.database) as connection:
        page = gzip.compress(b"<script>1</script>" + page_text((), title="").encode())
        results.put_knowledge(connection, "wtg", 1, {"known": {}, "judged": None}, page, service.now())
    answer = client.get("/assets/wtg/report")
    assert answer.text.startswith("<script>1</script>")
    policy = answer.headers["content-security-policy"]
    assert "sandbox" in policy and "allow-same-origin" not in policy
    assert policy.endswith(
        "default-src 'none'"
    )  # the rules of a page that begins with something else are none
