"""Findings are assigned, commented on, muted, closed and opened again; all of it is kept."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from tests.service.alerting import Receiver, found, hook, outbox
from tests.service.conftest import HERE, NOON, make_service
from tests.service.test_security import token
from tests.store.conftest import fresh

from jackettwin.service.context import Service
from jackettwin.service.web.app import create_app
from jackettwin.service.work.housekeeping import Housekeeping
from jackettwin.store import journal, people, reading, writing

LONG = "acc_" + 45 * "höhe_"
"""A subject with which the key of a finding is longer than its column."""


@pytest.fixture(params=["sqlite", "postgresql"])
def service(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Service]:
    url = None if request.param == "sqlite" else fresh(request.getfixturevalue("postgresql_url"))
    yield from make_service(tmp_path / "store", url, monkeypatch)


class Desk:
    """Somebody at the findings of one turbine."""

    def __init__(self, client: TestClient) -> None:
        self.client = client

    def listed(self, kind: str = "findings") -> list[dict[str, Any]]:
        return list(self.client.get(f"/api/v1/assets/wtg/{kind}").json()["items"])

    def does(self, action: str, status: int = 200, number: int | None = None, **body: Any) -> dict[str, Any]:
        of = self.listed()[0]["id"] if number is None else number
        answer = self.client.post(f"/api/v1/findings/{of}/{action}", json=body)
        assert answer.status_code == status, answer.text
        return dict(answer.json())

    def status(self) -> str:
        (listed,) = self.client.get("/api/v1/assets").json()["items"]
        assert listed == self.client.get("/api/v1/assets/wtg").json()  # the list renews what changed
        return str(listed["status"])


@pytest.fixture
def desk(client: TestClient) -> Desk:
    return Desk(client)


def alerting(service: Service, receiver: Receiver) -> Any:
    return outbox(service, channels={"ops": hook(receiver)}, rules=[{"channel": "ops"}])


@pytest.mark.parametrize("subject", ["fore_aft_1", LONG])
def test_all_that_was_done_is_told_in_its_order(desk: Desk, service: Service, subject: str) -> None:
    found(service, subject=subject)
    until = (service.now() + timedelta(days=7)).isoformat()
    desk.does("assign", to="ben", comment="on duty")
    desk.does("comment", comment="divers sent")
    desk.does("mute", until_utc=until, comment="until they are back")
    desk.does("close", reason="scour filled")
    told = desk.does("reopen", comment="it is back")
    number = told["id"]
    acts = [(act["action"], act["comment"]) for act in told["history"]]
    assert acts == [
        ("assign", "on duty"),
        ("comment", "divers sent"),
        ("mute", "until they are back"),
        ("close", "scour filled"),
        ("unmute", "it is back"),
        ("reopen", "it is back"),
    ]
    assert (told["assigned_to"], told["closed_by"], told["muted_until_utc"]) == ("ben", None, None)
    assert desk.client.get(f"/api/v1/findings/{number}").json() == told
    with reading(service.database) as connection:
        noted = [line.action for line in people.read_audit(connection, 5)]
        events = [e.payload["action"] for e in journal.events_after(connection, 0) if "action" in e.payload]
    assert noted == ["reopen", "close", "mute", "comment", "assign"]
    assert events == noted[::-1]


def test_an_act_outlives_the_number_of_its_finding(desk: Desk, service: Service) -> None:
    """A late record has a day advanced anew: its findings are written anew, under other numbers."""
    found(service, subject=LONG)
    alarm = desk.listed("alarms")[0]["id"]
    answer = desk.client.post(f"/api/v1/alarms/{alarm}/acknowledge", json={"comment": "seen"})
    assert answer.json()["comment"] == "seen"
    desk.does("assign", to="ben")
    found(service, subject=LONG)
    first, second = desk.listed("alarms")
    assert first["id"] != second["id"]
    for name in ("acknowledged_by", "assigned_to", "comment"):
        assert first[name] == second[name] is not None
    assert desk.status() != "alarm"


def test_a_closed_finding_asks_for_nobody_until_it_is_opened_again(desk: Desk, service: Service) -> None:
    found(service)
    number = desk.listed()[0]["id"]
    desk.client.post(f"/api/v1/alarms/{number}/acknowledge", json={"comment": "seen"})
    assert desk.does("close", reason="a slipped clamp")["close_reason"] == "a slipped clamp"
    assert "closed already" in desk.does("close", 409, reason="again")["detail"]
    desk.does("reopen")
    assert "open already" in desk.does("reopen", 409)["detail"]
    again = desk.listed("alarms")[0]
    assert (again["closed_by"], again["acknowledged_by"]) == (None, None)


@pytest.mark.parametrize("action", ["close", "mute"])
def test_what_is_dealt_with_is_not_alerted(
    desk: Desk, service: Service, clock: list[datetime], receiver: Receiver, action: str
) -> None:
    out = alerting(service, receiver)
    found(service)
    more = (
        {"reason": "known"} if action == "close" else {"until_utc": (NOON + timedelta(hours=2)).isoformat()}
    )
    desk.does(action, **more)
    found(service, subject="other")
    out.turn()
    assert [f["subject"] for body in receiver.bodies for f in body["findings"]] == ["other"]


def test_a_mute_holds_for_later_days_and_ends_by_itself(
    desk: Desk, service: Service, clock: list[datetime], receiver: Receiver
) -> None:
    out, keeper = alerting(service, receiver), Housekeeping(service)
    found(service)
    desk.does("mute", until_utc=(NOON + timedelta(days=1)).isoformat())
    clock[0] += timedelta(hours=20)
    found(service, day="2025-03-02")
    out.turn()
    keeper.turn()
    assert receiver.got == []
    before = desk.client.get("/api/v1/assets/wtg/findings")
    assert all(finding["muted_until_utc"] for finding in before.json()["items"])
    clock[0] += timedelta(hours=5)
    Housekeeping(service).turn()
    after = desk.client.get("/api/v1/assets/wtg/findings")
    assert after.headers["etag"] != before.headers["etag"]
    assert [finding["muted_until_utc"] for finding in after.json()["items"]] == [None, None]
    out.turn()
    (body,) = receiver.bodies
    assert [finding["day"] for finding in body["findings"]] == ["2025-03-01", "2025-03-02"]
    ended = desk.client.get(f"/api/v1/findings/{desk.listed()[0]['id']}").json()["history"]
    assert [(act["action"], act["by"]) for act in ended][1:] == [("unmute", "jackettwin")]


def test_what_makes_no_sense_is_refused(desk: Desk, service: Service) -> None:
    found(service)
    past = (service.now() - timedelta(minutes=1)).isoformat()
    assert desk.does("mute", 422, until_utc=past)["field"] == "until_utc"
    assert desk.does("mute", 422, until_utc="2040-01-01T00:00:00")["field"] == "until_utc"
    assert desk.does("close", 422, reason="")["field"] == "reason"
    assert desk.does("comment", 422, comment="")["field"] == "comment"
    assert desk.does("assign", 422, to="a b\n")["field"] == "to"
    assert desk.does("assign", 404, number=987_654, to=None)["detail"] == "no such finding"


def test_a_finding_is_given_to_who_sees_it_and_by_who_may(users: Service, password_hash: str) -> None:
    found(users)
    with writing(users.database) as connection:
        eve = people.User("eve", "engineer", password_hash, NOON, scope=["other"])
        people.add_user(connection, eve)
    with TestClient(create_app(users), base_url="http://127.0.0.1:8470", client=HERE) as client:
        desk = Desk(client)
        client.headers.update(token(users, "engineer"))
        assert desk.does("assign", to="viewer")["assigned_to"] == "viewer"
        said = [desk.does("assign", 422, to=name)["detail"] for name in ("eve", "nobody")]
        assert said[0] == said[1]
        assert desk.does("assign", to=None)["assigned_to"] is None
        number = desk.listed()[0]["id"]
        client.headers.update(token(users, "viewer"))
        assert client.get(f"/api/v1/findings/{number}").status_code == 200
        desk.does("comment", 403, comment="me too")
