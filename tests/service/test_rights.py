"""A customer sees his own assets, on every route, page, feed, stream, export and measure, and no others."""

from __future__ import annotations

import gzip
import io
import re
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from fastapi.testclient import TestClient
from tests.service.conftest import HERE, NOON, PASSWORD, TWIN, turn, upload
from tests.service.test_people_commands import ran
from tests.service.test_security import routes, token

from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.web.app import create_app
from jackettwin.service.web.catalogue import add_text_version
from jackettwin.store import journal, people, reading, results, rights, writing
from jackettwin.store.export import ADMINS, EXPORTED
from jackettwin.store.tables import metadata

OTHERS = "secret_farm"
"""The asset that the customer must not even learn the name of."""
NOTHING = {
    "key": "tolerances.rna_mass",
    "asset": "none",
    "record_id": "0123456789abcdef",
    "job_id": 987_654,
    "alarm_id": 987_654,
    "finding_id": 987_654,
    "version": 1,
}


@pytest.fixture
def customer(users: Service, password_hash: str) -> Iterator[TestClient]:
    """A session of an engineer who sees ``wtg`` by a group; the other asset has all there is."""
    add_text_version(users, OTHERS, TWIN, {}, "test")
    with writing(users.database) as connection:
        rights.put_group(connection, "mine", ["wtg"])
        for name, scope in (("eve", ["@mine"]), ("nobody", ["@gone"])):
            user = people.User(name, "engineer", password_hash, NOON, scope=scope)
            people.add_user(connection, user)
        alarm = {
            "asset": OTHERS,
            "model_hash": "m",
            "record_id": "",
            "origin": "watch",
            "time_utc": NOON,
            "day": "2025-03-01",
            "code": "changed",
            "severity": "alarm",
            "subject": "mode_1",
            "params": {},
            "text": "it fell",
        }
        results.put_findings(connection, [alarm])
    with TestClient(create_app(users), base_url="http://127.0.0.1:8470", client=HERE) as owner:
        owner.headers.update(token(users, "engineer"))
        for asset, k in ((OTHERS, 1), ("wtg", 2)):
            assert upload(owner, k, asset=asset).status_code == 202
        turn(users)
    with TestClient(
        create_app(users), base_url="http://127.0.0.1:8470", client=HERE, follow_redirects=False
    ) as client:
        client.headers.update(token(users, "eve"))
        yield client


def owned(service: Service, asset: str) -> dict[str, str]:
    """Return what the paths of an asset's things are made of."""
    with reading(service.database) as connection:
        number = {
            name: connection.scalar(
                metadata.tables[name]
                .select()
                .with_only_columns(metadata.tables[name].c[column])
                .where(metadata.tables[name].c.asset == asset)
            )
            for name, column in (("records", "record_id"), ("work", "id"), ("findings", "id"))
        }
    return {
        "asset": asset,
        "record_id": number["records"],
        "job_id": number["work"],
        "alarm_id": number["findings"],
        "finding_id": number["findings"],
        "version": 1,
        "key": "tolerances.rna_mass",
    }


def at(path: str, of: dict[str, str]) -> str:
    return re.sub(r"{(\w+)}", lambda m: str(of[m[1]]), path)


def test_nothing_of_another_asset_is_reached_by_any_route(customer: TestClient, users: Service) -> None:
    theirs = owned(users, OTHERS)
    bodies = {"comment": "x", "picks": [], "values": {}, "time_utc": [], "twin": TWIN}
    bodies |= {"to": None, "until_utc": "2100-01-01T00:00:00Z", "reason": "x"}
    walked = 0
    for method, path, role in routes():
        named = set(re.findall(r"{(\w+)}", path)) & {"asset", "record_id", "job_id", "alarm_id", "finding_id"}
        if not role or not named:
            continue
        walked += 1
        given = {"files": {"file": ("r", b"x")}} if path.endswith(("/records", "csv")) else {"json": bodies}
        sent = {} if method in ("GET", "DELETE") else given
        told, of_nothing = (customer.request(method, at(path, of), **sent) for of in (theirs, NOTHING))
        assert told.status_code in (403, 404, 422), (method, path, told.status_code)
        if role != "admin":
            assert told.status_code != 403, path
        said = told.text
        for name in named:
            said = said.replace(str(theirs[name]), str(NOTHING[name]))
        assert said == of_nothing.text, (method, path)  # it is not told from one that there is not
    assert walked > 25


def test_his_own_is_reached(customer: TestClient, users: Service) -> None:
    mine = owned(users, "wtg")
    assert customer.get("/api/v1/assets/wtg").status_code == 200
    assert customer.get(f"/api/v1/records/{mine['record_id']}").status_code == 200
    assert customer.get(f"/api/v1/jobs/{mine['job_id']}").status_code == 200
    assert customer.get("/assets/wtg").status_code == 200
    assert upload(customer, 9).status_code == 202


def test_lists_pages_and_measures_name_his_own_alone(customer: TestClient) -> None:
    for path in ("/api/v1/assets", "/api/v1/jobs", "/api/v1/metrics"):
        answer = customer.get(path)
        assert answer.status_code == 200
        assert "wtg" in answer.text, path
        assert OTHERS not in answer.text, path


@pytest.mark.parametrize("table", [table for table in EXPORTED if table not in ADMINS])
def test_an_export_has_his_own_rows_alone(customer: TestClient, users: Service, table: str) -> None:
    his = customer.get("/api/v1/export.parquet", params={"table": table})
    found = pq.read_table(io.BytesIO(his.content))
    name = "name" if table == "assets" else "asset"
    assert his.status_code == 200
    assert set(found[name].to_pylist()) <= {"wtg"}
    stream = customer.get("/api/v1/export.arrow", params={"table": table})
    assert pa.ipc.open_stream(stream.content).read_all().equals(found)
    everything = customer.get(
        "/api/v1/export.parquet", params={"table": table}, headers=token(users, "viewer")
    )
    assert pq.read_table(io.BytesIO(everything.content)).num_rows >= found.num_rows
    if table in ("modes", "records", "observations", "states", "assets", "versions", "work", "events"):
        assert found.num_rows > 0
        assert pq.read_table(io.BytesIO(everything.content)).num_rows > found.num_rows


@pytest.mark.parametrize("table", sorted(ADMINS))
def test_who_may_and_what_was_done_is_exported_to_admins_without_secrets(
    customer: TestClient, users: Service, table: str
) -> None:
    for name in ("eve", "engineer"):
        told = customer.get("/api/v1/export.arrow", params={"table": table}, headers=token(users, name))
        assert told.status_code == 403
    admin = token(users, "admin")
    content = customer.get("/api/v1/export.arrow", params={"table": table}, headers=admin).content
    found = pa.ipc.open_stream(content).read_all()
    file = customer.get("/api/v1/export.parquet", params={"table": table}, headers=admin).content
    assert pq.read_table(io.BytesIO(file)).column_names == found.column_names
    if table in ("asset_groups", "audit", "servers", "tokens", "users"):
        assert found.num_rows > 0
    with reading(users.database) as connection:
        secrets = connection.execute(metadata.tables["users"].select()).all()
        hashes = [row.password_hash for row in secrets] + [
            secret
            for row in connection.execute(metadata.tables["tokens"].select())
            for secret in (row.hash, row.csrf)
        ]
    assert not any(secret and secret.encode() in content for secret in hashes)


def test_every_table_of_the_store_is_exported() -> None:
    assert set(EXPORTED) == set(metadata.tables)


def test_events_of_others_are_not_told(customer: TestClient, users: Service) -> None:
    with writing(users.database) as connection:
        journal.tell(connection, "state", OTHERS, {"day": "x"}, NOON)
        journal.tell(connection, "state", "wtg", {"day": "last"}, NOON)
    told = []
    with customer.stream("GET", "/api/v1/events", headers={"Last-Event-ID": "0"}) as stream:
        for line in stream.iter_lines():
            told.append(line)
            if '"last"' in line:
                break
    assert OTHERS not in "\n".join(told)
    assert sum(line.startswith("event:") for line in told) > 2


def test_answers_are_not_shared_with_who_sees_more(customer: TestClient, users: Service) -> None:
    """Lists are kept by what is asked: what was made for one must not be given to another."""
    all_of_it = customer.get("/api/v1/assets", headers=token(users, "viewer"))
    assert OTHERS in all_of_it.text
    his = customer.get("/api/v1/assets", headers={"If-None-Match": all_of_it.headers["etag"]})
    assert his.status_code == 200
    assert OTHERS not in his.text
    assert OTHERS in customer.get("/api/v1/assets", headers=token(users, "viewer")).text


def test_a_group_that_changes_changes_what_is_seen_at_once(customer: TestClient, users: Service) -> None:
    before = customer.get("/api/v1/assets")
    with writing(users.database) as connection:
        rights.put_group(connection, "mine", [OTHERS])
    after = customer.get("/api/v1/assets", headers={"If-None-Match": before.headers["etag"]})
    assert [a["name"] for a in after.json()["items"]] == [OTHERS]
    with writing(users.database) as connection:
        rights.put_group(connection, "mine", [])
    assert customer.get("/api/v1/assets").json()["items"] == []


def test_who_sees_some_assets_adds_none_and_who_is_in_no_group_sees_none(
    customer: TestClient, users: Service
) -> None:
    new = customer.post("/api/v1/assets", json={"name": "new", "twin": TWIN})
    assert new.status_code == 403
    assert customer.get("/api/v1/assets", headers=token(users, "nobody")).json()["items"] == []


def test_rights_are_given_by_name_and_mistakes_are_said(users: Service, password_hash: str) -> None:
    with writing(users.database) as connection:
        assert rights.checked_scope(connection, ["wtg", "wtg"]) == ["wtg"]
        for wrong in ([], ["wtgg"], ["@none"]):
            with pytest.raises(InputError, match="no such asset or group"):
                rights.checked_scope(connection, wrong)
        with pytest.raises(InputError, match="no such asset"):
            rights.put_group(connection, "north", ["wtgg"])
        with pytest.raises(InputError, match="an admin sees every asset"):
            people.add_user(connection, people.User("a", "admin", password_hash, NOON, scope=["wtg"]))


def test_a_user_whose_time_is_over_is_nobody(
    stranger: TestClient, users: Service, password_hash: str
) -> None:
    with writing(users.database) as connection:
        over = users.now() - timedelta(seconds=1)
        ends = people.User(
            "guest", "viewer", password_hash, NOON, expires_utc=users.now() + timedelta(hours=1)
        )
        people.add_user(connection, ends)
    held = token(users, "guest")
    assert stranger.get("/api/v1/me", headers=held).status_code == 200
    with writing(users.database) as connection:
        connection.execute(
            people.users.update().where(people.users.c.name == "guest").values(expires_utc=over)
        )
    assert stranger.get("/api/v1/me", headers=held).status_code == 401
    login = {"name": "guest", "password": PASSWORD}
    assert stranger.post("/api/v1/login", json=login).status_code == 401


def test_an_old_password_opens_only_the_way_to_another(stranger: TestClient, users: Service) -> None:
    object.__setattr__(users.settings, "password_days", 90.0)
    login = {"name": "viewer", "password": PASSWORD}
    refused = stranger.post("/api/v1/login", json=login)
    assert (refused.status_code, refused.json()["field"]) == (403, "new")
    assert "set-cookie" not in refused.headers
    assert stranger.post("/api/v1/login", json={**login, "new": PASSWORD}).status_code == 422
    wrong = {"name": "viewer", "password": "not the password", "new": "four rather small words"}
    assert stranger.post("/api/v1/login", json=wrong).status_code == 401
    assert stranger.post("/api/v1/login", json={**login, "new": "four rather small words"}).status_code == 200
    stranger.cookies.clear()
    assert stranger.post("/api/v1/login", json=login).status_code == 401
    again = {**login, "password": "four rather small words"}
    assert stranger.post("/api/v1/login", json=again).status_code == 200
    stranger.cookies.clear()
    later = users.now() + timedelta(days=91)
    users.now = lambda: later
    assert stranger.post("/api/v1/login", json=again).status_code == 403


def test_downloads_are_in_the_audit_log(customer: TestClient, users: Service) -> None:
    mine = owned(users, "wtg")
    customer.get("/api/v1/export.parquet")
    arrow = {"Accept": "application/vnd.apache.arrow.stream"}
    customer.get(f"/api/v1/records/{mine['record_id']}/signal", headers=arrow)
    with writing(users.database) as connection:
        results.put_knowledge(connection, "wtg", 1, {"known": {}}, gzip.compress(b"page"), NOON)
    assert customer.get("/assets/wtg/report").text.startswith("page")
    with reading(users.database) as connection:
        lines = [(a.who, a.subject) for a in people.read_audit(connection, 20) if a.action == "download"]
    assert sorted(lines) == [
        ("eve", "report of wtg/1"),
        ("eve", f"samples of {mine['record_id']}"),
        ("eve", "table modes"),
    ]


def test_rights_by_command(tmp_path: Path) -> None:
    (tmp_path / "twin.yaml").write_text(TWIN)
    password = "three small words\n"
    ran(tmp_path, "asset", "add", "wtg", str(tmp_path / "twin.yaml"))
    assert ran(tmp_path, "asset", "group", "north", "wtg") == {"group": "north", "assets": ["wtg"]}
    ran(tmp_path, "user", "add", "anna", "--role", "admin", "--password-stdin", given=password)
    words = ("user", "add", "eve", "--role", "viewer", "--no-password", "--assets", "@north")
    ran(tmp_path, *words, "--until", "2030-01-31")
    eve = ran(tmp_path, "user", "list")["users"][1]
    until = "2030-01-31T00:00:00+00:00"
    assert eve == {"user": "eve", "role": "viewer", "assets": ["@north"], "expires_utc": until}
    assert "no such asset or group" in ran(tmp_path, *words[:-1], "@south", code=2)
