"""Alerts through an MQTT broker."""

from __future__ import annotations

import json
import ssl
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Literal

import paho.mqtt.client as mqtt
from paho.mqtt.enums import CallbackAPIVersion
from paho.mqtt.reasoncodes import ReasonCode
from pydantic import Field

from jackettwin.errors import require
from jackettwin.files import Schema
from jackettwin.service.alerts.notice import NotDelivered, Notice
from jackettwin.service.credentials import secret_in, tls_context

_TIMEOUT_S = 15.0


class Topic(Schema):
    """A broker and the topic below which each finding is published with QoS 1, not retained."""

    host: str = Field(min_length=1)
    port: int | None = Field(default=None, ge=1, le=65535)
    """Default: 8883 with TLS, 1883 without."""
    tls: bool = True
    user: str | None = None
    topic: str = "jackettwin-alerts"
    """``/ASSET/SEVERITY`` is appended to it."""


class Broker(Topic):
    """A topic of a broker with secrets in files."""

    kind: Literal["mqtt"]
    ca: Path | None = None
    password_file: Path | None = None

    @property
    def about(self) -> str:
        """Its destination, without secrets."""
        return f"{self.topic} at {self.host}"

    def check(self, folder: Path) -> None:
        """Raise an error on settings with which no message could be sent.

        Raises
        ------
        InputError
            If the topic is not valid, a password would travel unencrypted, or a file cannot be read.
        """
        good = self.topic and not set(self.topic) & set("+#\0") and self.topic.isprintable()
        require(good, "is not a topic for publishing", field="topic", value=self.topic, allowed="no + and #")
        require(
            not self.topic.startswith("jackettwin/") and self.topic != "jackettwin",
            "this topic is used for packets of samples",
            field="topic",
            value=self.topic,
            remedy="choose another one",
        )
        require(
            self.tls or self.user is None, "a password would travel unencrypted", field="tls", value=self.tls
        )
        secret_in(folder, self.password_file, "password_file")
        if self.ca is not None:
            tls_context(self.ca and folder / self.ca)

    def send(self, notice: Notice, folder: Path) -> None:
        """Publish every finding of a message.

        Raises
        ------
        OSError, NotDelivered
            If the broker did not accept all of them.
        """
        client, answers = mqtt.Client(CallbackAPIVersion.VERSION2), SimpleQueue[ReasonCode]()
        client.connect_timeout = _TIMEOUT_S
        client.on_connect = lambda _client, _data, _flags, reason, _properties: answers.put(reason)
        if self.user is not None:
            client.username_pw_set(self.user, secret_in(folder, self.password_file, "password_file"))
        if self.tls:
            context: ssl.SSLContext = tls_context(self.ca and folder / self.ca)
            client.tls_set_context(context)
        client.connect(self.host, self.port or (8883 if self.tls else 1883))
        client.loop_start()
        try:
            # a refused client would try again until the time is over
            if (reason := answers.get(timeout=_TIMEOUT_S)).is_failure:
                raise NotDelivered(f"the broker refuses the connection: {reason}")
            told = [self._published(client, dict(finding), notice.id) for finding in notice.findings]
            for one in told:
                one.wait_for_publish(_TIMEOUT_S)
                if not one.is_published():
                    raise NotDelivered("the broker does not acknowledge the message")
        except Empty:
            raise NotDelivered("the broker does not answer") from None
        except (RuntimeError, ValueError) as error:
            raise NotDelivered(f"the broker refuses the message: {error}") from None
        finally:
            client.disconnect()
            client.loop_stop()

    def _published(
        self, client: mqtt.Client, finding: dict[str, object], message: str
    ) -> mqtt.MQTTMessageInfo:
        topic = f"{self.topic}/{finding['asset']}/{finding['severity']}"
        return client.publish(topic, json.dumps({"message": message, **finding}, ensure_ascii=False), qos=1)
