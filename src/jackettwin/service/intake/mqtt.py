"""Streams by MQTT: packets are acknowledged to the broker once they are committed, windows become records."""

from __future__ import annotations

import json
import logging
import queue
import ssl
import time
from collections.abc import Iterable
from datetime import datetime, timedelta
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote, urlsplit

import cbor2
import numpy as np
import paho.mqtt.client as mqtt
from paho.mqtt.enums import CallbackAPIVersion, MQTTProtocolVersion

from jackettwin.errors import InputError
from jackettwin.service.intake.files import accept
from jackettwin.service.intake.packets import assembled
from jackettwin.service.workers.tasks import EARLIEST, stored
from jackettwin.store import assets, reading, streams, writing
from jackettwin.store.streams import KEPT, LONGEST, WINDOW, Packet

if TYPE_CHECKING:
    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

TOPIC = "jackettwin"
GRACE = timedelta(seconds=30)
"""A window is closed when its stream's own clock is so far past its end."""
SILENT_S = 120.0
"""... or when nothing came for so long, by our stopwatch."""
_BATCH = 500
_CHORE_S = 2.0
_REMEMBERED = 1000


def read_packets(topic: str, payload: bytes | bytearray) -> list[Packet]:
    """Return the packets of a message.

    Parameters
    ----------
    topic : ``jackettwin/{asset}/{channel}`` or ``jackettwin/{asset}``
    payload : JSON or CBOR ``{t0_utc, rate_hz, channels: {name: [...]}}``; of one channel, ``samples`` will do

    Raises
    ------
    InputError
        If the topic or the payload is of another form.
    """
    parts = topic.split("/")
    if len(parts) not in (2, 3) or parts[0] != TOPIC:
        raise InputError(
            "not a topic of ours", field="topic", value=topic, allowed="jackettwin/ASSET[/CHANNEL]"
        )
    asset = assets.check_name(parts[1])
    try:
        body = json.loads(payload) if payload[:1] in (b"{", b" ", b"\n") else cbor2.loads(payload)
        start = datetime.fromisoformat(str(body["t0_utc"]).replace("Z", "+00:00"))
        rate = float(body["rate_hz"])
        named: dict[str, Any] = body["channels"] if "channels" in body else {parts[2]: body["samples"]}
        found = [
            Packet(asset, str(channel)[:128], start, rate, np.asarray(samples, dtype=float).ravel())
            for channel, samples in named.items()
        ]
    except Exception as error:  # whatever a stranger sends: one message must not hold up those behind it
        raise InputError(
            "not a packet",
            field="payload",
            value=type(error).__name__,
            allowed="{t0_utc, rate_hz, channels: {name: [..]}} as JSON or CBOR",
        ) from None
    if start.tzinfo is None:
        raise InputError(
            "a packet's clock has no zone", field="t0_utc", value=body["t0_utc"], remedy="write ...Z"
        )
    if (
        not all(packet.channel and packet.channel.isprintable() for packet in found)
        or not EARLIEST.year <= start.year <= 9000
    ):
        raise InputError("a channel's name or a clock is out of range", field="payload", value=topic)
    longest = max((p.samples.size for p in found), default=0)
    if not 1e-3 <= rate <= 1e5 or not 0 < longest <= LONGEST.total_seconds() * rate:
        raise InputError(
            "the packet's rate or length is out of range",
            field="rate_hz",
            value=f"{rate:g} Hz, {longest} samples",
            allowed="0.001 to 1e5 Hz, up to an hour",
        )
    return found


class MqttIntake:
    """A subscription that survives reconnects, and the chore that makes records of what it brought.

    The client keeps its session at the broker, and acknowledges by hand after the commit: what was on its way
    when we died is sent again, and a packet that comes twice is one packet.
    """

    def __init__(self, service: Service, url: str) -> None:
        self.service = service
        self._inbox: queue.Queue[mqtt.MQTTMessage] = queue.Queue(maxsize=100_000)
        self._held: list[mqtt.MQTTMessage] = []
        self._heard: dict[str, float] = {}
        self._last_chore = 0.0
        self._said: set[tuple[str, str]] = set()
        self.refused = 0
        place = urlsplit(url if "//" in url else f"mqtt://{url}")
        if place.scheme not in ("mqtt", "mqtts"):
            raise InputError(
                "not a broker's address",
                field="mqtt",
                value=url,
                allowed="mqtt[s]://[USER:PASSWORD@]HOST[:PORT]",
            )
        self._client = mqtt.Client(
            CallbackAPIVersion.VERSION2,
            client_id=f"jackettwin-{service.settings.store.resolve().name}-{service.settings.port}",
            protocol=MQTTProtocolVersion.MQTTv311,
            clean_session=False,
            manual_ack=True,
        )
        if place.username:
            self._client.username_pw_set(unquote(place.username), unquote(place.password or ""))
        if place.scheme == "mqtts":
            self._client.tls_set(cert_reqs=ssl.CERT_REQUIRED)
        self._client.reconnect_delay_set(1, 30)
        self._client.on_connect = self._subscribe
        self._client.on_connect_fail = lambda *_: log.warning("the broker does not answer; it is asked again")
        self._client.on_message = lambda _client, _data, message: self._inbox.put(message)
        self._client.connect_async(place.hostname or "127.0.0.1", place.port or 1883, keepalive=30)

    @property
    def connected(self) -> bool:
        """Whether the broker answers."""
        return bool(self._client.is_connected())

    def start(self) -> None:
        """Connect, and reconnect for ever, in a thread of its own."""
        self._client.loop_start()

    def stop(self) -> None:
        """Disconnect; the broker keeps what comes meanwhile."""
        self._client.disconnect()
        self._client.loop_stop()

    def turn(self) -> None:
        """Commit what came, acknowledge it, and make records of windows that are over."""
        self._commit()
        if time.monotonic() - self._last_chore >= _CHORE_S:
            self._last_chore = time.monotonic()
            close_windows(self.service, self._silent)

    def _subscribe(self, client: mqtt.Client, _data: Any, _flags: Any, reason: Any, *_: Any) -> None:
        if reason.is_failure:
            log.warning("the broker refuses us: %s", reason)
        else:
            client.subscribe(f"{TOPIC}/#", qos=1)

    def _commit(self) -> None:
        """Commit what came; a message that could not be committed is held until it can be."""
        while self._held or not self._inbox.empty():
            self._held += list(_waiting(self._inbox, _BATCH - len(self._held)))
            packets = [packet for message in self._held for packet in self._packets(message)]
            with writing(self.service.database) as connection:
                known = set(assets.asset_names(connection, archived=False))
                ours = [p for p in packets if p.asset in known]
                misdated = streams.add_packets(connection, ours, self.service.now())
            self._leave_out(misdated, "their clock is days behind their stream, or ahead of it and of ours")
            self._leave_out([p for p in packets if p.asset not in known], "there is no such living asset")
            for packet in packets:
                self._heard[packet.asset] = time.monotonic()
            for message in self._held:
                self._client.ack(message.mid, message.qos)
            self._held = []

    def _packets(self, message: mqtt.MQTTMessage) -> list[Packet]:
        """Return the packets of a message, none of one that is no message of ours."""
        try:
            return read_packets(message.topic, message.payload)
        except InputError as error:
            self.refused += 1
            log.warning("%s", error)
            return []

    def _leave_out(self, packets: list[Packet], why: str) -> None:
        """Count packets that are not kept; why is said once of each asset."""
        self.refused += len(packets)
        for said in {(packet.asset, why) for packet in packets} - self._said:
            log.warning("packets of %s are left out: %s", *said)
            if len(self._said) < _REMEMBERED:  # names are strangers' to choose
                self._said.add(said)

    def _silent(self, asset: str) -> bool:
        return time.monotonic() - self._heard.setdefault(asset, time.monotonic()) > SILENT_S


def close_windows(service: Service, silent: Any) -> None:
    """Make records of the windows that are over; one whose packets have become more is made anew."""
    with reading(service.database) as connection:
        open_now = streams.open_windows(connection)
        newest = {w.asset: streams.newest_packet(connection, w.asset) for w in open_now}
    for window in open_now:
        clock = newest[window.asset]
        over = clock is not None and clock >= window.window_utc + WINDOW + GRACE
        if over or silent(window.asset):
            close_window(service, window)
    with writing(service.database) as connection:
        for asset, clock in newest.items():
            if clock is not None and asset:
                streams.forget_packets(connection, asset, clock - KEPT)


def close_window(service: Service, window: streams.OpenWindow) -> None:
    """Make the record of a window.

    In place of an earlier one of fewer packets, with all consequences at once.
    """
    from jackettwin.service.intake import bundles
    from jackettwin.service.work import consequences
    from jackettwin.service.workers import engine

    with reading(service.database) as connection:
        packets = streams.packets_of(connection, window.asset, window.window_utc)
        channels = engine.channels(bundles.adopted_twin(connection, service, window.asset).config)
    record = assembled(
        packets, window.window_utc, channels, f"{window.asset}_{window.window_utc:%Y%m%dT%H%M}"
    )
    if record is None:
        with writing(service.database) as connection:
            streams.close_window(connection, window, None)
        return
    parsed, now = stored(record, window.asset, service.settings.store), service.now()
    number = parsed.record_id
    with writing(service.database) as connection:
        if window.record_id is not None and window.record_id != number:
            why = f"superseded by {number}, which has packets that came late"
            consequences.set_aside(connection, service, window.asset, window.record_id, why)
        accept(now, connection, window.asset, parsed, "stream")
        streams.close_window(connection, window, number)


def _waiting(inbox: queue.Queue[mqtt.MQTTMessage], most: int) -> Iterable[mqtt.MQTTMessage]:
    for _ in range(most):
        try:
            yield inbox.get_nowait()
        except queue.Empty:
            return
