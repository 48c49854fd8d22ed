"""Import of streams by MQTT; packets are acknowledged to the broker after their commit."""

from __future__ import annotations

import logging
import queue
import secrets
import time
from collections.abc import Iterable
from contextlib import suppress
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote, urlsplit

import paho.mqtt.client as mqtt
from paho.mqtt.enums import CallbackAPIVersion, MQTTProtocolVersion

from jackettwin.errors import InputError
from jackettwin.service.credentials import secret_of, tls_context
from jackettwin.service.intake.packets import SILENT_S, TOPIC, read_packets
from jackettwin.store import Packet, assets, settings, streams, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

_PORTS = {"mqtt": 1883, "mqtts": 8883}
_BATCH = 500
_REMEMBERED = 1000


class MqttIntake:
    """A persistent subscription.

    The client has a persistent session at the broker and acknowledges each message after its commit. Messages
    that were not committed before a crash are sent again, and a repeated packet is stored once.
    """

    def __init__(self, service: Service, url: str) -> None:
        self.service = service
        self._inbox: queue.Queue[mqtt.MQTTMessage] = queue.Queue(maxsize=100_000)
        self._held: list[mqtt.MQTTMessage] = []
        self._heard: dict[str, float] = {}
        self._said: set[tuple[str, str]] = set()
        self.refused = 0
        place = urlsplit(url if "//" in url else f"mqtt://{url}")
        if place.scheme not in ("mqtt", "mqtts"):
            raise InputError(
                "not the address of a broker",
                field="mqtt",
                value=place.scheme,
                allowed="mqtt[s]://[USER@]HOST[:PORT]",
            )
        if place.password is not None:
            raise InputError(
                "every user of this machine can read a password in the address",
                field="mqtt",
                allowed="mqtt[s]://[USER@]HOST[:PORT]",
                remedy="give --mqtt-password-file, or JACKETTWIN_SERVE_MQTT_PASSWORD in the environment",
            )
        self._client = mqtt.Client(
            CallbackAPIVersion.VERSION2,
            client_id=_client_id(service),
            protocol=MQTTProtocolVersion.MQTTv311,
            clean_session=False,
            manual_ack=True,
        )
        given = service.settings
        if place.username:
            password = secret_of(given.mqtt_password_file, given.mqtt_password, what="password file")
            self._client.username_pw_set(unquote(place.username), password)
        if place.scheme == "mqtts":
            own = (given.mqtt_ca, given.mqtt_certificate, given.mqtt_key)
            self._client.tls_set_context(tls_context(*own, option="mqtt-"))
        self._client.reconnect_delay_set(1, 30)
        self._client.on_connect = self._subscribe
        self._client.on_connect_fail = lambda *_: log.warning("the broker does not answer; trying again")
        self._client.on_message = lambda _client, _data, message: self._inbox.put(message)
        self._place = (place.hostname or "127.0.0.1", place.port or _PORTS[place.scheme])
        self._client.connect_async(*self._place, keepalive=30)
        self._listening = False

    @property
    def connected(self) -> bool:
        """Whether the broker answers."""
        return bool(self._client.is_connected())

    def stop(self) -> None:
        """Disconnect; the broker stores messages meanwhile."""
        self._client.disconnect()
        self._client.loop_stop()
        self._listening = False

    def leave(self) -> None:
        """Disconnect so that another server can take over, which receives all messages not acknowledged."""
        if self._listening:
            self.stop()
            self._held.clear()
            with suppress(queue.Empty):
                while True:
                    self._inbox.get_nowait()

    def turn(self) -> None:
        """Commit received messages and acknowledge them; failed ones are tried again.

        Of several servers on one store only one subscribes, with the store's session at the broker.
        """
        if not self.service.has_intake:
            return self.leave()
        if not self._listening:
            self._listening = True
            self._client.connect_async(*self._place, keepalive=30)
            self._client.loop_start()  # it connects and reconnects in its own thread
        while self._held or not self._inbox.empty():
            self._held += list(_waiting(self._inbox, _BATCH - len(self._held)))
            packets = [packet for message in self._held for packet in self._packets(message)]
            with writing(self.service.database) as connection:
                known = set(assets.asset_names(connection, archived=False))
                ours = [p for p in packets if p.asset in known]
                misdated = streams.add_packets(connection, ours, self.service.now())
            self._leave_out(
                misdated, "their clock is days behind their stream, or ahead of it and of the server's"
            )
            self._leave_out(
                [p for p in packets if p.asset not in known], "there is no such asset, or it is archived"
            )
            for packet in packets:
                self._heard[packet.asset] = time.monotonic()
            for message in self._held:
                self._client.ack(message.mid, message.qos)
            self._held = []

    def _subscribe(self, client: mqtt.Client, _data: Any, _flags: Any, reason: Any, *_: Any) -> None:
        if reason.is_failure:
            log.warning("the broker refuses the connection: %s", reason)
        else:
            client.subscribe(f"{TOPIC}/#", qos=1)

    def _packets(self, message: mqtt.MQTTMessage) -> list[Packet]:
        """Return the packets of a message; none if it is not valid."""
        try:
            return read_packets(message.topic, message.payload)
        except InputError as error:
            self.refused += 1
            log.warning("%s", error)
            return []

    def _leave_out(self, packets: list[Packet], why: str) -> None:
        """Count rejected packets, and log the reason once for each asset."""
        self.refused += len(packets)
        for said in {(packet.asset, why) for packet in packets} - self._said:
            log.warning("packets of %s are rejected: %s", *said)
            if len(self._said) < _REMEMBERED:  # names come from outside, so their number is bounded
                self._said.add(said)

    def silent(self, asset: str) -> bool:
        """Return whether an asset has been silent so long that its stream has ended."""
        return time.monotonic() - self._heard.setdefault(asset, time.monotonic()) > SILENT_S


def _client_id(service: Service) -> str:
    """Return the client identifier of a store's session at the broker, common to all its servers."""
    with writing(service.database) as connection:
        found = settings.get(connection, settings.MQTT_CLIENT)
        if found is None:
            found = f"jackettwin-{secrets.token_hex(4)}"
            settings.put(connection, settings.MQTT_CLIENT, found)
    return str(found)


def _waiting(inbox: queue.Queue[mqtt.MQTTMessage], most: int) -> Iterable[mqtt.MQTTMessage]:
    for _ in range(most):
        try:
            yield inbox.get_nowait()
        except queue.Empty:
            return
