"""Channels of alerts that an admin adds, tries and takes away; nobody is told their secrets."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from tests.service.alerting import Receiver, found, write

from jackettwin.service.alerts.outbox import Outbox
from jackettwin.service.context import Service

PATH = "/api/v1/alert-channels"


def hook(receiver: Receiver, name: str = "ops", **more: Any) -> dict[str, Any]:
    channel = {"kind": "webhook", "url": f"{receiver.url}/T0KEN", "secret": "a signing secret"}
    return {"name": name, "channel": channel, **more}


def test_what_is_found_is_told_by_a_channel_that_was_added(
    client: TestClient, service: Service, clock: list[datetime], receiver: Receiver
) -> None:
    out = Outbox(service, None, service.settings.store)
    out.turn()
    found(service, subject="before")
    rules = [{"severity": "warning", "codes": ["structure_changed"]}]
    answer = client.post(PATH, json=hook(receiver, rules=rules))
    assert answer.status_code == 201, answer.text
    out.turn()
    found(service, severity="warning")
    found(service, "sensor_changed", "alarm")
    out.turn()
    ((headers, body),) = receiver.got
    assert headers["webhook-signature"].startswith("v1,")
    assert [f["subject"] for f in json.loads(body)["findings"]] == ["fore_aft_1"]
    assert client.delete(f"{PATH}/ops").status_code == 204
    assert client.delete(f"{PATH}/ops").status_code == 404
    found(service, subject="after")
    out.turn()
    assert len(receiver.got) == 1


def test_secrets_are_its_owners_and_told_nobody(
    client: TestClient, service: Service, receiver: Receiver
) -> None:
    added = client.post(PATH, json=hook(receiver))
    (listed,) = client.get(PATH).json()["items"]
    assert listed == added.json()
    assert (listed["id"], listed["kind"], listed["from_file"]) == ("ops", "webhook", False)
    for secret in ("T0KEN", "signing"):
        assert secret not in client.get(PATH).text + added.text
    files = list((service.settings.store / "secrets").iterdir())
    assert {path.name for path in files} == {"ops.url", "ops.secret"}
    assert {path.stat().st_mode & 0o777 for path in (files[0].parent, *files)} == {0o700, 0o600}
    client.delete(f"{PATH}/ops")
    assert list((service.settings.store / "secrets").iterdir()) == []


def test_a_try_says_what_came_of_it(client: TestClient, receiver: Receiver) -> None:
    client.post(PATH, json=hook(receiver))
    assert client.post(f"{PATH}/ops/test").json() == {"delivered": True, "problem": None}
    receiver.answer = 410
    told = client.post(f"{PATH}/ops/test").json()
    assert told == {"delivered": False, "problem": "the other side returns status 410"}
    assert [body["findings"][0]["code"] for body in receiver.bodies] == ["try", "try"]
    assert client.post(f"{PATH}/none/test").status_code == 404


def test_those_of_the_file_are_listed_and_stay(
    client: TestClient, service: Service, receiver: Receiver, clock: list[datetime]
) -> None:
    url = {"kind": "webhook", "url": receiver.url}
    file = write(service.settings.store, channels={"duty": url}, rules=[{"channel": "duty"}])
    service.settings = service.settings.model_copy(update={"alerts": file})
    (listed,) = client.get(PATH).json()["items"]
    assert (listed["id"], listed["from_file"], listed["about"]) == ("duty", True, "127.0.0.1 as plain")
    assert client.post(f"{PATH}/duty/test").json()["delivered"]
    assert client.delete(f"{PATH}/duty").status_code == 404
    assert client.post(PATH, json=hook(receiver, "duty")).status_code == 422
    quiet = [
        {"quiet": {"begin": "22:00", "end": "06:00"}, "escalate": {"channel": "duty", "after_minutes": 5}}
    ]
    assert client.post(PATH, json=hook(receiver, rules=quiet)).status_code == 201


MAIL = {"kind": "mail", "host": "h", "sender": "a@b", "to": ["c@d"]}


@pytest.mark.parametrize(
    ("channel", "rules", "said"),
    [
        ({**MAIL, "user": "u", "password": "p", "security": "none"}, [{}], "unencrypted"),
        ({**MAIL, "ca": "no certificate"}, [{}], "not a certificate in PEM"),
        ({**MAIL, "password_file": "/etc/passwd"}, [{}], "Extra inputs"),
        ({"kind": "webhook", "url": "file:///etc/passwd"}, [{}], "not an HTTP address"),
        ({"kind": "webhook", "url": "https://h/\nX: y"}, [{}], "pattern"),
        (
            {"kind": "mqtt", "host": "h", "topic": "jackettwin/wtg"},
            [{}],
            "used for packets of samples",
        ),
        (MAIL, [{"codes": ["no_such"]}], "code of a finding"),
        (MAIL, [{"escalate": {"channel": "nobody", "after_minutes": 5}}], "channel"),
        (MAIL, [], "at least 1"),
    ],
)
def test_what_could_not_be_used_is_refused_and_leaves_nothing(
    client: TestClient, service: Service, channel: dict[str, Any], rules: list[Any], said: str
) -> None:
    answer = client.post(PATH, json={"name": "ops", "channel": channel, "rules": rules})
    assert answer.status_code == 422, answer.text
    assert said in answer.text
    assert client.get(PATH).json()["items"] == []
    assert not any(Path(service.settings.store).glob("secrets/*"))


def test_only_a_name_makes_a_file(client: TestClient, receiver: Receiver) -> None:
    for name in ("../x", "a/b", ".", "", "a.b"):
        assert client.post(PATH, json=hook(receiver, name)).status_code == 422
