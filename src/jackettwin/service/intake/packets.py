"""Parsing of loggers' messages into packets of one channel's samples."""

from __future__ import annotations

import json
from datetime import datetime
from typing import Any

import cbor2
import numpy as np

from jackettwin.errors import InputError
from jackettwin.service.workers.tasks import EARLIEST
from jackettwin.store import Packet, assets
from jackettwin.store.streams import LONGEST

TOPIC = "jackettwin"
SILENT_S = 120.0
"""Time without packets, by the monotonic clock of the server, after which a stream is silent."""


def read_packets(topic: str, payload: bytes | bytearray) -> list[Packet]:
    """Return the packets of a message.

    Parameters
    ----------
    topic : ``jackettwin/{asset}/{channel}`` or ``jackettwin/{asset}``
    payload : JSON or CBOR ``{t0_utc, rate_hz, channels: {name: [...]}}``; for one channel, ``samples``
        instead of ``channels``

    Raises
    ------
    InputError
        If the topic or the payload has another form.
    """
    parts = topic.split("/")
    if len(parts) not in (2, 3) or parts[0] != TOPIC:
        raise InputError(
            "not a topic of this server", field="topic", value=topic, allowed="jackettwin/ASSET[/CHANNEL]"
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
    except Exception as error:  # any invalid message must not block later ones
        raise InputError(
            "not a packet",
            field="payload",
            value=type(error).__name__,
            allowed="{t0_utc, rate_hz, channels: {name: [..]}} as JSON or CBOR",
        ) from None
    if start.tzinfo is None:
        raise InputError(
            "the packet's time has no zone", field="t0_utc", value=body["t0_utc"], remedy="write ...Z"
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
