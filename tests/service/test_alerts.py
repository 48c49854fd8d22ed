"""Alerts out: to a real SMTP sink, a receiver of HTTP and a broker, once, when they are due."""

from __future__ import annotations

import base64
import email
import hashlib
import hmac
import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from tests.service.alerting import SECRET, Receiver, found, hook, outbox, states, write
from tests.service.conftest import NOON, TWIN, turn, upload
from tests.service.servers import free_port
from tests.service.test_people_commands import ran

from jackettwin.errors import InputError
from jackettwin.service.alerts.notice import Notice
from jackettwin.service.alerts.outbox import MOST_TRIES
from jackettwin.service.alerts.rules import QuietHours, Rule, read_alerts
from jackettwin.service.alerts.webhook import SHAPES, signed, signing_key
from jackettwin.service.context import Service
from jackettwin.service.web.catalogue import add_text_version
from jackettwin.store import alerts, reading, rights, tables, writing


def test_an_alarm_is_posted_once_and_signed(service: Service, clock: list, receiver: Receiver) -> None:
    """The signature is computed here anew, from the headers that came."""
    out = outbox(service, channels={"ops": hook(receiver, secret_file="key")}, rules=[{"channel": "ops"}])
    found(service)
    for _ in range(3):
        out.turn()
    ((headers, body),) = receiver.got
    key = base64.b64decode(SECRET.removeprefix("whsec_"))
    content = f"{headers['webhook-id']}.{headers['webhook-timestamp']}.".encode() + body
    mac = base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()
    assert headers["webhook-signature"] == f"v1,{mac}"
    told = json.loads(body)["findings"]
    assert [(f["asset"], f["code"], f["text"]) for f in told] == [
        ("wtg", "structure_changed", "it fell by 2 %")
    ]
    assert set(states(service).values()) == {"sent"}


def test_the_signature_is_that_of_the_standard() -> None:
    """The published example of Standard Webhooks, in the tests of its reference libraries."""
    body = b'{"test": 2432232314}'
    made = signed(signing_key(SECRET), "msg_p5jXN8AQM9LWM0D4loKWxJek", 1614265330, body)
    assert made == "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE="
    assert signing_key("plain words") == b"plain words"


def test_what_was_found_before_is_not_told_and_a_death_tells_nothing_twice(
    service: Service, clock: list, receiver: Receiver
) -> None:
    found(service, subject="old")
    rules = {"channels": {"ops": hook(receiver)}, "rules": [{"channel": "ops"}]}
    out = outbox(service, **rules)
    out.turn()
    assert receiver.got == []
    found(service, subject="new")
    out.turn()
    outbox(service, **rules).turn()  # another server, which knows only the store
    found(service, subject="new")  # its day is advanced anew: the same finding has another number
    outbox(service, **rules).turn()
    assert [f["subject"] for body in receiver.bodies for f in body["findings"]] == ["new"]


def test_a_message_is_the_same_message_when_it_is_sent_again(
    service: Service, clock: list, receiver: Receiver
) -> None:
    """A server that died between sending and noting sends it again, by the same name."""
    out = outbox(service, channels={"ops": hook(receiver)}, rules=[{"channel": "ops"}])
    found(service)
    out.turn()
    with writing(service.database) as connection:
        connection.execute(tables.alerts.update().values(state="waiting"))
    out.turn()
    first, second = (headers["webhook-id"] for headers, _ in receiver.got)
    assert first == second


def test_rules_choose_by_severity_asset_and_code(service: Service, clock: list, receiver: Receiver) -> None:
    add_text_version(service, "other", TWIN, {}, "test")
    with writing(service.database) as connection:
        rights.put_group(connection, "north", ["other"])
    channels = {name: hook(receiver) for name in ("alarms", "north", "sensor")}
    rules = [
        {"channel": "alarms"},
        {"channel": "north", "severity": "warning", "assets": ["@north"]},
        {"channel": "sensor", "severity": "info", "codes": ["sensor_changed"]},
    ]
    out = outbox(service, channels=channels, rules=rules)
    found(service)
    found(service, "sensor_changed", "warning")
    found(service, "sensor_changed", "warning", asset="other")
    found(service, "watch_sees", "info", asset="other")
    out.turn()
    told = {tuple(key.split()[0].split("/") + key.split()[1].split("/")) for key in states(service)}
    assert {(name, asset, code) for name, asset, _, code, _ in told} == {
        ("alarms", "wtg", "structure_changed"),
        ("north", "other", "sensor_changed"),
        ("sensor", "wtg", "sensor_changed"),
        ("sensor", "other", "sensor_changed"),
    }


def test_a_digest_is_one_message_and_old_warnings_are_none(
    service: Service, clock: list, receiver: Receiver
) -> None:
    rule = {"channel": "ops", "severity": "warning", "digest_minutes": 60}
    out = outbox(service, channels={"ops": hook(receiver)}, rules=[rule])
    clock[0] = NOON + timedelta(minutes=10)
    found(service, "spikes", "warning", subject="a")
    found(service, "spikes", "warning", subject="years ago", time_utc=NOON - timedelta(days=400))
    out.turn()
    clock[0] = NOON + timedelta(minutes=59)
    found(service, "spikes", "warning", subject="b")
    out.turn()
    assert receiver.got == []
    clock[0] = NOON + timedelta(minutes=60)
    out.turn()
    (body,) = receiver.bodies
    assert [f["subject"] for f in body["findings"]] == ["a", "b"]
    assert body["title"] == "2 warnings of wtg"


@pytest.mark.parametrize(
    ("quiet", "now", "due"),
    [
        (("22:00", "06:00", "UTC"), "2025-03-01T23:00", "2025-03-02T06:00"),
        (("22:00", "06:00", "UTC"), "2025-03-02T05:59", "2025-03-02T06:00"),
        (("22:00", "06:00", "UTC"), "2025-03-02T06:00", "2025-03-02T06:00"),
        (("22:00", "06:00", "UTC"), "2025-03-01T21:59", "2025-03-01T21:59"),
        (("09:00", "17:00", "UTC"), "2025-03-01T12:00", "2025-03-01T17:00"),
        (
            ("22:00", "06:00", "Europe/Copenhagen"),
            "2025-03-29T22:30",
            "2025-03-30T04:00",
        ),  # summer time begins
        (("22:00", "06:00", "Europe/Copenhagen"), "2025-03-01T20:30", "2025-03-01T20:30"),
    ],
)
def test_quiet_hours_end_by_the_clock_of_their_zone(quiet: tuple, now: str, due: str) -> None:
    hours = dict(zip(("begin", "end", "zone"), quiet, strict=True))
    rule = Rule(channel="x", severity="warning", quiet=QuietHours(**hours))
    moment, expected = (datetime.fromisoformat(text).replace(tzinfo=UTC) for text in (now, due))
    assert rule.due({"severity": "warning"}, moment) == expected
    assert rule.due({"severity": "alarm"}, moment) == moment  # people are woken for these
    rule = Rule(channel="x", quiet=QuietHours(**hours, also_alarms=True))
    assert rule.due({"severity": "alarm"}, moment) == expected


def test_a_receiver_that_fails_is_tried_later_and_given_up_in_the_end(
    service: Service, clock: list, receiver: Receiver
) -> None:
    out = outbox(service, channels={"ops": hook(receiver)}, rules=[{"channel": "ops"}])
    receiver.answer = 503
    found(service)
    for _ in range(3):
        out.turn()
    assert len(receiver.got) == 1
    clock[0] += timedelta(seconds=31)
    out.turn()
    assert len(receiver.got) == 2
    receiver.answer = 200
    clock[0] += timedelta(seconds=61)
    out.turn()
    assert len(receiver.got) == 3
    assert set(states(service).values()) == {"sent"}
    receiver.answer = 404
    found(service, subject="another")
    for _ in range(MOST_TRIES + 3):
        out.turn()
        clock[0] += timedelta(hours=1, seconds=1)
    assert len(receiver.got) == 3 + MOST_TRIES
    with reading(service.database) as connection:
        last = alerts.newest(connection, 1)[0]
    assert (last.state, last.tries, last.problem) == (
        "given_up",
        MOST_TRIES,
        "the other side returns status 404",
    )


def test_one_dead_channel_holds_up_no_other(service: Service, clock: list, receiver: Receiver) -> None:
    dead = {"kind": "webhook", "url": f"http://127.0.0.1:{free_port()}/"}
    mail = {
        "kind": "mail",
        "host": "127.0.0.1",
        "port": free_port(),
        "security": "none",
        "sender": "a@b",
        "to": ["c@d"],
    }
    channels = {"a": dead, "b": mail, "ops": hook(receiver)}
    out = outbox(service, channels=channels, rules=[{"channel": name} for name in channels])
    key = found(service)
    out.turn()
    assert len(receiver.got) == 1
    assert states(service) == {f"a {key}": "waiting", f"b {key}": "waiting", f"ops {key}": "sent"}


def test_what_nobody_took_note_of_goes_further(
    client: TestClient, service: Service, clock: list, receiver: Receiver
) -> None:
    rule = {"channel": "ops", "escalate": {"channel": "chief", "after_minutes": 30}}
    channels = {"ops": hook(receiver), "chief": hook(receiver)}
    out = outbox(service, channels=channels, rules=[rule])
    noted, unanswered = found(service, subject="seen"), found(service, subject="unseen")
    out.turn()
    (number,) = [
        a["id"] for a in client.get("/api/v1/assets/wtg/alarms").json()["items"] if a["subject"] == "seen"
    ]
    assert client.post(f"/api/v1/alarms/{number}/acknowledge", json={"comment": "I go"}).status_code == 200
    clock[0] += timedelta(minutes=29)
    out.turn()
    assert len(receiver.got) == 1
    clock[0] += timedelta(minutes=2)
    out.turn()
    (told,) = receiver.bodies[1]["findings"]
    assert (told["subject"], told["unanswered_minutes"]) == ("unseen", 30)
    assert states(service)[f"chief unanswered {noted}"] == "withdrawn"
    assert states(service)[f"chief unanswered {unanswered}"] == "sent"


def test_what_holds_no_more_is_not_told(service: Service, clock: list, receiver: Receiver) -> None:
    out = outbox(service, channels={"ops": hook(receiver)}, rules=[{"channel": "ops", "digest_minutes": 60}])
    clock[0] += timedelta(minutes=5)
    key = found(service)
    out.turn()
    with writing(service.database) as connection:
        connection.execute(tables.findings.delete())  # a late record undid it
    clock[0] += timedelta(hours=1)
    out.turn()
    assert receiver.got == []
    assert states(service) == {f"ops {key}": "withdrawn"}


def test_an_asset_that_sends_nothing_is_an_alarm_until_it_sends(
    client: TestClient, service: Service, clock: list, receiver: Receiver
) -> None:
    upload(client, 0)
    turn(service)
    out = outbox(service, channels={"ops": hook(receiver)}, rules=[{"channel": "ops"}], silent_hours=6)
    clock[0] = NOON + timedelta(hours=5.9)
    out.turn()
    assert receiver.got == []
    clock[0] = NOON + timedelta(hours=6.1)
    for _ in range(3):
        out.turn()
    (told,) = receiver.bodies[0]["findings"]
    assert (told["code"], told["subject"]) == ("asset_silent", "latest record 2025-03-01 12:00 UTC")
    assert client.get("/api/v1/assets/wtg").json()["status"] == "alarm"
    upload(client, 6)
    turn(service)
    out.turn()
    assert client.get("/api/v1/assets/wtg/alarms").json()["items"] == []
    clock[0] = NOON + timedelta(hours=12.2)  # silent again: that is another alarm, on the same day
    out.turn()
    assert len(receiver.got) == 2


def notice(**more: Any) -> Notice:
    finding = {
        "asset": "wtg_01",
        "code": "structure_changed",
        "severity": "alarm",
        "subject": "fore_aft_1",
        "text": "fell by 2 % <b> & more\r\nBcc: all@example.org",
        "day": "2025-03-01",
        "time_utc": "2025-03-01T12:00:00+00:00",
        "key": "k",
        **more,
    }
    return Notice([finding], "https://twin.example.org/")


def test_every_shape_is_what_its_reader_reads() -> None:
    """Slack takes a text, Teams a card in a message, Alertmanager a list of alerts with labels."""
    slack = SHAPES["slack"](notice())
    assert list(slack) == ["text"]
    assert "&lt;b&gt; &amp; more" in slack["text"]
    assert "https://twin.example.org/assets/wtg_01" in slack["text"]
    teams = SHAPES["teams"](notice())
    card = teams["attachments"][0]
    assert (teams["type"], card["contentType"]) == ("message", "application/vnd.microsoft.card.adaptive")
    assert {block["type"] for block in card["content"]["body"]} == {"TextBlock"}
    manager = SHAPES["alertmanager"](notice())
    assert (manager["version"], manager["status"]) == ("4", "firing")
    assert manager["alerts"][0]["labels"] == {
        "alertname": "structure_changed",
        "severity": "critical",
        "asset": "wtg_01",
        "subject": "fore_aft_1",
    }
    assert manager["alerts"][0]["startsAt"] == "2025-03-01T12:00:00+00:00"
    assert SHAPES["plain"](notice())["findings"][0]["code"] == "structure_changed"


def test_no_text_of_a_stranger_begins_another_line() -> None:
    assert len(notice().lines) == 1
    assert "\n" not in notice().title and "\r" not in notice().title


def test_mail_arrives_at_a_real_sink(service: Service, clock: list, tmp_path: Path) -> None:
    controller = pytest.importorskip("aiosmtpd.controller")
    got: list[Any] = []

    class Sink:
        async def handle_DATA(self, server: Any, session: Any, envelope: Any) -> str:
            got.append(envelope)
            return "250 OK" if len(got) > 1 else "451 not now"

    sink = controller.Controller(Sink(), hostname="127.0.0.1", port=free_port())
    sink.start()
    try:
        mail = {
            "kind": "mail",
            "host": "127.0.0.1",
            "port": sink.port,
            "security": "none",
            "sender": "Twin <twin@example.org>",
            "to": ["duty@example.org", "chief@example.org"],
        }
        out = outbox(
            service, channels={"duty": mail}, rules=[{"channel": "duty"}], address="https://twin.example.org"
        )
        found(service, text="fell by 2 % \u2013 überall")
        out.turn()
        assert set(states(service).values()) == {"waiting"}
        clock[0] += timedelta(seconds=31)
        out.turn()
    finally:
        sink.stop()
    assert set(states(service).values()) == {"sent"}
    refused, taken = got
    assert taken.mail_from == "twin@example.org"
    assert taken.rcpt_tos == ["duty@example.org", "chief@example.org"]
    message, before = (
        email.message_from_bytes(one.content, policy=email.policy.default) for one in (taken, refused)
    )
    assert message["Subject"].startswith("[jackettwin] ALARM wtg: fore_aft_1: fell by 2 %")
    assert message["Message-ID"] == before["Message-ID"]
    text = message.get_content()
    assert "überall" in text and "https://twin.example.org/assets/wtg" in text


def of(rule: dict[str, Any]) -> dict[str, Any]:
    return {"rules": [{"channel": "ops", **rule}]}


def by(kind: str, **channel: Any) -> dict[str, Any]:
    return {"channels": {"ops": {"kind": kind, **channel}}}


MAIL = {"host": "a", "sender": "a@b", "to": ["c@d"]}
NIGHT = {"begin": "22:00", "end": "06:00"}


@pytest.mark.parametrize(
    ("wrong", "field", "problem"),
    [
        (of({"channel": "opps"}), "rules.0.channel", "no such channel"),
        (of({"codes": ["structure_change"]}), "rules.0.codes", "structure_changed"),
        (of({"severity": "alarms"}), "rules.0.severity", "did you mean"),
        (of({"quiet": {"begin": 1320, "end": "06:00"}}), "quiet.begin", "in quotes"),
        (of({"quiet": {**NIGHT, "zone": "Sea"}}), "zone", "no such"),
        (of({"quiet": {**NIGHT, "end": "22:00"}}), "end", "when they begin"),
        (of({"escalate": {"channel": "x", "after_minutes": 5}}), "escalate.channel", "no such"),
        ({"silent_hours": -1}, "silent_hours", "0"),
        ({"chanels": {}}, "chanels", "did you mean"),
        (by("fax"), "channels.ops", "email"),
        (by("webhook", url="file:///etc/passwd"), "channels.ops.url", "https://"),
        (by("webhook"), "channels.ops.url", "either url"),
        (by("webhook", url="http://a/", secret_file="none"), "secret_file", "no such"),
        (by("mqtt", host="a", topic="a/#"), "channels.ops.topic", "no + and #"),
        (by("mqtt", host="a", topic="jackettwin/x"), "topic", "samples"),
        (by("email", **{**MAIL, "to": ["nobody"]}), "channels.ops.to.0", "NAME@HOST"),
        (by("email", **MAIL, user="u", security="none"), "security", "unencrypted"),
        (by("email", **MAIL, user="u"), "password_file", "both or neither"),
    ],
)
def test_a_file_that_is_wrong_is_refused_at_its_place(
    tmp_path: Path, wrong: dict[str, Any], field: str, problem: str
) -> None:
    good = {**by("webhook", url="https://example.org/"), **of({})}
    read_alerts(write(tmp_path, **good))
    with pytest.raises(InputError) as error:
        read_alerts(write(tmp_path, **{**good, **wrong}))
    said = str(error.value)
    assert field in said and problem in said and str(tmp_path) in said


def test_the_command_tries_every_channel_and_lists_what_was_told(
    service: Service, clock: list[datetime], receiver: Receiver
) -> None:
    store = service.settings.store
    channels = {"ops": hook(receiver), "dead": {"kind": "webhook", "url": f"http://127.0.0.1:{free_port()}"}}
    out = outbox(service, channels=channels, rules=[{"channel": "ops"}])
    tried = ran(store, "alerts", "--try", str(store / "alerts.yaml"))["channels"]
    assert tried["ops"] is None and "refused" in tried["dead"]
    key = found(service)
    out.turn()
    listed = ran(store, "alerts")["alerts"]
    assert [(row["channel"], row["key"], row["state"]) for row in listed] == [("ops", key, "sent")]
