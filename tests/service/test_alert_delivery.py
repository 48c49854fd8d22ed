"""Alerts by the ways that carry a password: mail after STARTTLS and by TLS, MQTT by TLS, to real servers."""

from __future__ import annotations

import email
import ipaddress
import ssl
import subprocess
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from queue import Queue
from typing import Any

import paho.mqtt.client as mqtt
import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat
from paho.mqtt.enums import CallbackAPIVersion
from tests.service.servers import found, free_port, wait_for_port

from jackettwin.service.alerts.broker import Broker
from jackettwin.service.alerts.mail import Mail
from jackettwin.service.alerts.outbox import tried

USER, PASSWORD = "twin", "three small words"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Beside which the channels' files lie: a certificate of 127.0.0.1, its key, passwords."""
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "loopback")])
    valid = datetime(2000, 1, 1, tzinfo=UTC), datetime(2100, 1, 1, tzinfo=UTC)
    builder = x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number(), *valid)
    here = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address("127.0.0.1"))])
    signed = builder.add_extension(here, critical=False).sign(key, hashes.SHA256())
    (tmp_path / "ca.pem").write_bytes(signed.public_bytes(Encoding.PEM))
    (tmp_path / "key.pem").write_bytes(key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))
    (tmp_path / "right").write_text(PASSWORD + "\n")
    (tmp_path / "wrong").write_text("something else\n")
    return tmp_path


class MailSink:
    """A mail server that takes what a known user sends after TLS began, as real ones do."""

    def __init__(self, folder: Path, security: str) -> None:
        aiosmtpd = pytest.importorskip("aiosmtpd.smtp")
        from aiosmtpd.controller import Controller

        self.got: list[Any] = []
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(folder / "ca.pem", folder / "key.pem")

        def known(_server: Any, _session: Any, _envelope: Any, _kind: str, data: Any) -> Any:
            good = (data.login, data.password) == (USER.encode(), PASSWORD.encode())
            return aiosmtpd.AuthResult(success=good, handled=False)

        wrapped = {"ssl_context": context} if security == "tls" else {}
        begun = {"tls_context": context, "require_starttls": True} if security == "starttls" else {}
        self.controller = Controller(
            self,
            hostname="127.0.0.1",
            port=free_port(),
            authenticator=known,
            auth_required=True,
            auth_require_tls=security == "starttls",
            **wrapped,
            **begun,
        )

    async def handle_DATA(self, _server: Any, session: Any, envelope: Any) -> str:
        self.got.append((session.ssl is not None, email.message_from_bytes(envelope.content)))
        return "250 OK"

    def __enter__(self) -> MailSink:
        self.controller.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.controller.stop()


@pytest.mark.filterwarnings("ignore:Requiring AUTH")  # behind TLS from the first byte on it is safe, too
@pytest.mark.parametrize("security", ["starttls", "tls"])
def test_mail_goes_after_a_login_behind_tls(folder: Path, security: str) -> None:
    with MailSink(folder, security) as sink:
        place = {"host": "127.0.0.1", "port": sink.controller.port, "security": security, "user": USER}
        who = {"kind": "mail", "sender": "twin@example.org", "to": ["duty@example.org"]}

        def sent(**files: str) -> str | None:
            return tried(Mail(**place, **who, **files), None, folder)

        assert "authentication" in str(sent(password_file="wrong", ca="ca.pem")).lower()
        assert "certificate" in str(sent(password_file="right")).lower()  # one that the system does not trust
        assert sink.got == []
        assert sent(password_file="right", ca="ca.pem") is None
        assert sent(password_file="right", ca="ca.pem") is None
    assert len(sink.got) == 2
    assert all(encrypted for encrypted, _ in sink.got) or security == "tls"  # then all of it is
    assert sink.got[0][1]["Subject"].startswith("[jackettwin] INFO")


@pytest.fixture
def broker(folder: Path) -> Iterator[int]:
    """The port of a mosquitto that lets in one user, by TLS."""
    port, passwords = free_port(), folder / "passwords"
    subprocess.run(
        [found("mosquitto_passwd"), "-b", "-c", str(passwords), USER, PASSWORD],
        check=True,
        capture_output=True,
    )
    lines = [f"listener {port} 127.0.0.1", f"certfile {folder / 'ca.pem'}", f"keyfile {folder / 'key.pem'}"]
    lines += ["allow_anonymous false", f"password_file {passwords}", "user root"]
    (folder / "mosquitto.conf").write_text("\n".join(lines) + "\n")
    with (folder / "log").open("wb") as log:
        process = subprocess.Popen(
            [found("mosquitto"), "-c", str(folder / "mosquitto.conf")], stdout=log, stderr=log
        )
    try:
        wait_for_port(port)
        yield port
    finally:
        process.terminate()
        process.wait(timeout=20)


@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning"
)  # paho's, of a refused handshake
def test_a_broker_is_told_by_tls_and_password(folder: Path, broker: int) -> None:
    """Somebody listens who is a user of the broker, too."""
    came: Queue[tuple[str, int, bool, bytes]] = Queue()
    listener = mqtt.Client(CallbackAPIVersion.VERSION2, client_id="listener")
    listener.username_pw_set(USER, PASSWORD)
    listener.tls_set(str(folder / "ca.pem"))
    listener.on_connect = lambda client, *_: client.subscribe("alarms/#", qos=1)
    listener.on_subscribe = lambda *_: came.put(("", 0, False, b"listens"))
    listener.on_message = lambda _c, _d, m: came.put((m.topic, m.qos, m.retain, m.payload))
    listener.connect("127.0.0.1", broker)
    listener.loop_start()
    try:
        assert came.get(timeout=30.0)[3] == b"listens"
        place = {"kind": "mqtt", "host": "127.0.0.1", "port": broker, "topic": "alarms", "user": USER}

        def sent(**files: str) -> str | None:
            return tried(Broker(**place, **files), None, folder)

        assert sent(password_file="right", ca="ca.pem") is None
        topic, qos, retained, payload = came.get(timeout=30.0)
        assert (topic, qos, retained) == ("alarms/none/info", 1, False)
        assert b"this is a test message" in payload
        assert "certificate" in str(sent(password_file="right")).lower()
        assert "refuses the connection" in str(sent(password_file="wrong", ca="ca.pem"))
        assert came.empty()
    finally:
        listener.disconnect()
        listener.loop_stop()
