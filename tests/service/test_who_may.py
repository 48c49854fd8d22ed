"""Who is let in without a login, whose word on others is taken, and who reads what lies in a store."""

from __future__ import annotations

import json
import os
import stat
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from fastapi.testclient import TestClient
from tests.service.conftest import HERE, NOON, PASSWORD, make_service, upload

from jackettwin.cli.main import main
from jackettwin.errors import InputError
from jackettwin.service import ServiceSettings
from jackettwin.service.context import Service
from jackettwin.service.intake.mqtt import MqttIntake
from jackettwin.service.login_attempts import LoginAttempts
from jackettwin.service.settings import read_settings, refuse_exposed
from jackettwin.service.web import auth
from jackettwin.service.web.app import create_app
from jackettwin.store import backup, open_database, people, private_folder, sqlite_url, writing

PROXY = ("10.0.0.2", 40000)
ADDRESS = "http://127.0.0.1:8470"


def asked(service: Service, peer: tuple[str, int] = HERE, **headers: str) -> int:
    with TestClient(create_app(service), base_url=ADDRESS, client=peer) as client:
        return client.get(
            "/api/v1/users", headers={k.replace("_", "-"): v for k, v in headers.items()}
        ).status_code


def behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, **changes: Any) -> Any:
    return make_service(tmp_path, None, monkeypatch, behind_proxy=True, **changes)


@pytest.mark.parametrize("header", auth.PROXY_HEADERS)
def test_an_open_server_is_open_to_nobody_whom_a_proxy_passes_on(service: Service, header: str) -> None:
    assert asked(service) == 200
    assert asked(service, **{header: "203.0.113.9"}) == 401


def test_an_open_server_is_open_to_its_own_machine_alone(service: Service) -> None:
    """Whatever name it is asked by: a proxy names it 127.0.0.1."""
    assert asked(service, ("203.0.113.9", 40000)) == 401
    assert asked(service, ("::1", 40000)) == 200


def test_behind_a_proxy_nothing_is_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for service in behind(tmp_path, monkeypatch):
        assert asked(service) == 401
        with pytest.raises(InputError, match="no user is defined"):
            refuse_exposed(service.settings, users=False)
        refuse_exposed(service.settings, users=True)


def test_the_last_admin_stays(users: Service, password_hash: str) -> None:
    with writing(users.database) as connection:
        for role in ("viewer", "engineer"):
            with pytest.raises(InputError, match="last admin"):
                people.add_user(connection, people.User("admin", role, password_hash, NOON))
        with pytest.raises(InputError, match="last admin"):
            people.remove_user(connection, "admin")
        people.add_user(connection, people.User("other", "admin", password_hash, NOON))
        assert people.remove_user(connection, "admin")
        disabled = people.User("other", "admin", password_hash, NOON, disabled=True)
        with pytest.raises(InputError, match="last admin"):
            people.add_user(connection, disabled)


def test_the_last_user_stays(service: Service, password_hash: str) -> None:
    """Without users the server would be open again."""
    with writing(service.database) as connection:
        people.add_user(connection, people.User("only", "viewer", password_hash, NOON))
        with pytest.raises(InputError, match="last user"):
            people.remove_user(connection, "only")


def guess(client: TestClient, k: int, name: str = "admin") -> int:
    headers = {"X-Forwarded-For": f"198.51.100.{k}"}
    login = {"name": name, "password": "not the password"}
    return client.post("/api/v1/login", json=login, headers=headers).status_code


@pytest.mark.parametrize("behind_proxy", [False, True])
def test_a_forged_sender_does_not_help_to_guess(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, password_hash: str, behind_proxy: bool
) -> None:
    for service in make_service(tmp_path, None, monkeypatch, behind_proxy=behind_proxy):
        with writing(service.database) as connection:
            people.add_user(connection, people.User("admin", "admin", password_hash, NOON))
        with TestClient(create_app(service), base_url=ADDRESS, client=("203.0.113.9", 1)) as client:
            assert [guess(client, k) for k in range(7)] == [401] * 5 + [429] * 2


def test_a_trusted_proxy_says_who_asks_and_what_its_clients_say_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, password_hash: str
) -> None:
    monkeypatch.setattr(auth, "ATTEMPTS_OF", 8)
    for service in behind(tmp_path, monkeypatch, trusted_proxies=("10.0.0.0/24",)):
        with writing(service.database) as connection:
            people.add_user(connection, people.User("admin", "admin", password_hash, NOON))
        with TestClient(create_app(service), base_url=ADDRESS, client=PROXY) as client:
            assert [guess(client, k) for k in range(7)] == [401] * 7  # seven people
            assert guess(client, 7) == 401 and guess(client, 8) == 429  # and one account
            forged = {"X-Forwarded-For": "198.51.100.77, 203.0.113.5"}
            login = {"name": "nobody", "password": "not the password"}
            for k in range(6):
                forged["X-Forwarded-For"] = f"198.51.100.{k}, 203.0.113.5"  # the proxy adds whom it saw
                status = client.post("/api/v1/login", json=login, headers=forged).status_code
            assert status == 429


def test_a_header_of_trust_counts_from_the_trusted_proxy_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, password_hash: str
) -> None:
    given = {"trusted_header": "X-Who", "trusted_proxies": ("10.0.0.2",)}
    for service in behind(tmp_path, monkeypatch, **given):
        with writing(service.database) as connection:
            people.add_user(connection, people.User("admin", "admin", password_hash, NOON))
        assert asked(service, PROXY, X_Who="admin") == 200
        assert asked(service, HERE, X_Who="admin") == 401
        forged = {"X_Who": "admin", "X_Forwarded_For": "10.0.0.2"}
        assert asked(service, ("203.0.113.9", 1), **forged) == 401


def test_a_proxy_is_named_by_its_address() -> None:
    with pytest.raises(InputError) as error:
        read_settings(store=Path("x"), trusted_proxies=("*",))
    assert (error.value.field, error.value.value) == ("trusted_proxies.0", "*")


def test_a_flood_of_names_clears_no_count() -> None:
    attempts = LoginAttempts()
    assert [attempts.wait_s({"from x": 3}) for _ in range(3)] == [0.0] * 3
    for k in range(12_000):
        assert attempts.wait_s({"from x": 3, f"name {k}": 5}) > 0.0
    assert len(attempts._tried) == 1
    assert (
        attempts.place("2001:db8::1") == attempts.place("2001:db8::ffff") != attempts.place("2001:db8:1::1")
    )


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_store_and_its_backup_are_their_owners(tmp_path: Path) -> None:
    store, file = tmp_path / "a" / "store", tmp_path / "backup.tar.gz"
    private_folder(store)
    database = open_database(sqlite_url(store))
    with writing(database):
        assert {mode(path) for path in store.iterdir()} == {0o600}
    backup.backup(database, store, file)
    assert (mode(store), mode(file)) == (0o700, 0o600)
    database.dispose()
    store.chmod(0o755)
    (store / "jackettwin.sqlite").chmod(0o644)  # as an earlier version left it
    private_folder(store)
    open_database(sqlite_url(store)).dispose()
    assert (mode(store), mode(store / "jackettwin.sqlite")) == (0o700, 0o600)
    private_folder(tmp_path)  # no store: it is not ours to close
    assert mode(tmp_path) == tmp_path.stat().st_mode & 0o777


@pytest.mark.skipif(os.geteuid() != 0, reason="only root becomes another user")
def test_another_user_of_the_machine_reads_no_password(tmp_path: Path) -> None:
    for parent in (tmp_path, tmp_path.parent, tmp_path.parent.parent):
        parent.chmod(0o711)
    store = tmp_path / "store"
    private_folder(store)
    open_database(sqlite_url(store)).dispose()
    code = f"open({str(store / 'jackettwin.sqlite')!r}, 'rb').read(1)"
    as_nobody = subprocess.run(
        [
            "setpriv",
            "--reuid=65534",
            "--regid=65534",
            "--clear-groups",
            "/usr/bin/env",
            "python3",
            "-c",
            code,
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "PermissionError" in as_nobody.stderr


def test_the_password_of_the_broker_stands_in_no_command(
    service: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="every user") as error:
        MqttIntake(service, "mqtts://anna:secret@broker")
    assert "secret" not in str(error.value)
    file = tmp_path / "password"
    file.write_text("of a file\n")
    monkeypatch.setenv("JACKETTWIN_SERVE_MQTT_PASSWORD", "of the environment")
    for more, expected in (({}, "of the environment"), ({"mqtt_password_file": file}, "of a file")):
        service.settings = read_settings(store=tmp_path, **more)
        intake = MqttIntake(service, "mqtts://anna@broker")
        assert (intake._client.username, intake._client.password) == ("anna", expected)
        assert intake._client.port == 8883
        assert "environment" not in repr(service.settings)
    assert MqttIntake(service, "mqtt://broker")._client.port == 1883


def test_a_certificate_for_the_broker_that_is_none_is_said(service: Service, tmp_path: Path) -> None:
    (tmp_path / "ca.pem").write_text("no certificate")
    for field in ("mqtt_ca", "mqtt_certificate"):
        service.settings = ServiceSettings(store=tmp_path, **{field: tmp_path / "ca.pem"})
        with pytest.raises(InputError) as error:
            MqttIntake(service, "mqtts://broker")
        assert error.value.field == field.replace("_", "-")


@pytest.fixture
def engineer(users: Service) -> Iterator[TestClient]:
    with TestClient(create_app(users), base_url=ADDRESS, client=HERE) as client:
        logged_in(client, "engineer", PASSWORD)
        yield client


def logged_in(client: TestClient, name: str, password: str) -> None:
    answer = client.post("/api/v1/login", json={"name": name, "password": password})
    assert answer.status_code == 200
    client.headers["X-CSRF-Token"] = answer.json()["csrf_token"]


def test_who_knows_the_old_password_changes_it_and_other_sessions_end(
    engineer: TestClient, users: Service
) -> None:
    with TestClient(create_app(users), base_url=ADDRESS, client=HERE) as other:
        logged_in(other, "engineer", PASSWORD)
        wrong = {"old": "no such password", "new": "four rather small words"}
        assert engineer.post("/api/v1/me/password", json=wrong).status_code == 403
        assert engineer.post("/api/v1/me/password", json={"old": PASSWORD, "new": "short"}).status_code == 422
        right = {"old": PASSWORD, "new": "four rather small words"}
        assert engineer.post("/api/v1/me/password", json=right).status_code == 204
        assert engineer.get("/api/v1/me").status_code == 200
        assert other.get("/api/v1/me").status_code == 401
        del other.headers["X-CSRF-Token"]
        other.cookies.clear()
        logged_in(other, "engineer", right["new"])


def test_a_session_alone_does_not_guess_the_password(engineer: TestClient) -> None:
    wrong = {"old": "no such password", "new": "four rather small words"}
    tried = [engineer.post("/api/v1/me/password", json=wrong).status_code for _ in range(6)]
    assert tried == [403] * 5 + [429]


def test_the_audit_log_says_who_did_what(engineer: TestClient, users: Service) -> None:
    upload(engineer, 1)
    upload(engineer, 1)
    body = {"time_utc": [NOON.isoformat()], "values": {"mean_wind_speed_m_s": [8.0]}}
    engineer.post("/api/v1/assets/wtg/conditions", json=body)
    table = {"file": ("t.csv", b"time_utc,mean_wind_speed_m_s\n2025-03-01T12:10:00Z,8.5\n")}
    engineer.post("/api/v1/assets/wtg/conditions.csv", files=table)
    assert engineer.get("/api/v1/audit").status_code == 403
    engineer.post("/api/v1/logout")
    engineer.cookies.clear()
    logged_in(engineer, "admin", PASSWORD)
    page = engineer.get("/api/v1/audit", params={"limit": 4}).json()
    rest = engineer.get("/api/v1/audit", params={"cursor": page["next_cursor"]}).json()
    lines = [(line["who"], line["action"], line["outcome"]) for line in (*page["items"], *rest["items"])]
    sent = [("record", "ok"), ("record", "known"), ("conditions", "ok"), ("conditions", "ok")]
    done = [("login", "ok"), *sent, ("logout", "ok")]
    assert [(action, outcome) for who, action, outcome in reversed(lines) if who == "engineer"] == done
    assert lines[0] == ("admin", "login", "ok") and rest["next_cursor"] is None
    ran = CliRunner().invoke(main, ["audit", "--store", str(users.settings.store), "--limit", "1", "--json"])
    assert json.loads(ran.stdout)["audit"][0]["who"] == "admin"
