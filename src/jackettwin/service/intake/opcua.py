"""Streams by OPC UA: a connector that loads the user's own installation of asyncua, which is LGPL."""

from __future__ import annotations

import asyncio
import logging
import queue
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np
from pydantic import Field

from jackettwin.errors import InputError, MissingExtra, require
from jackettwin.files import Schema, read_mapping, validate
from jackettwin.service.credentials import secret_in
from jackettwin.service.intake.packets import SILENT_S
from jackettwin.store import Packet, assets, streams, writing

if TYPE_CHECKING:
    from jackettwin.service.context import Service

log = logging.getLogger(__name__)

_AGAIN_S = 10.0
"""Before a server is asked again that did not answer."""
_GAP = 1.5
"""Steps between two values from which on one is missing."""
Value = tuple[str, datetime, Any]
"""A channel, when it was measured, and a number or a list of them."""


class OpcUaSource(Schema):
    """A server, and which of its nodes are channels of which asset."""

    url: str
    asset: str
    rate_hz: float = Field(gt=0.0, le=1e5)
    """At which a node is sampled; of a node that is an array, the rate of its values."""
    channels: dict[str, str] = Field(min_length=1, max_length=200)
    """{channel: node}, such as ``ns=2;s=Tower.AccX``."""
    user: str | None = None
    password_file: Path | None = None
    """Its first line is the user's password; beside this file if the path is not absolute."""


def read_source(path: Path) -> OpcUaSource:
    """Return a file that describes a server.

    Raises
    ------
    InputError
        If it is not what it must be, or asyncua is not installed.
    """
    found = validate(OpcUaSource, read_mapping(path, what="OPC UA file"), file=path)
    place = urlsplit(found.url)
    good = place.scheme == "opc.tcp" and place.hostname and "@" not in place.netloc
    require(good, "no address of OPC UA", file=path, field="url", allowed="opc.tcp://HOST:PORT/PATH")
    assets.check_name(found.asset)
    try:
        secret_in(path.parent, found.password_file, "password_file")
        import_module("asyncua")
    except ImportError:
        raise MissingExtra(
            "OPC UA needs a client that is not part of jackettwin", remedy="pip install asyncua"
        ) from None
    except InputError as error:
        raise error.at(file=path) from None
    return found


class OpcUaIntake:
    """Listens to a server while it is this server's turn to, and keeps what it measures as packets."""

    def __init__(self, service: Service, file: Path) -> None:
        self._service, self._source, self._folder = service, read_source(file), file.parent
        self._values: queue.Queue[Value] = queue.Queue()
        self._held: list[Value] = []
        self._thread: Thread | None = None
        self._end = Event()
        self._heard = time.monotonic()
        self.connected = False

    def turn(self) -> None:
        """Commit what came; what cannot be committed now is tried again."""
        if not self._service.has_intake:
            return self.stop()
        if self._thread is None:
            self._end.clear()
            self._thread = Thread(target=self._run, name="opcua", daemon=True)
            self._thread.start()
        with suppress(queue.Empty):
            while True:
                self._held.append(self._values.get_nowait())
        if self._held:
            self._heard = time.monotonic()
            packets = packets_of(self._held, self._source.asset, self._source.rate_hz)
            with writing(self._service.database) as connection:
                known = self._source.asset in assets.asset_names(connection, archived=False)
                left_out = streams.add_packets(connection, packets if known else [], self._service.now())
            if left_out or not known:
                log.warning("values of %s are left out: no such asset, or a wrong clock", self._source.asset)
            self._held = []

    def stop(self) -> None:
        """Listen no more."""
        self._end.set()
        self._thread = None

    def silent(self, asset: str) -> bool:
        """Tell whether nothing came of an asset for so long that its stream has ended."""
        return asset != self._source.asset or time.monotonic() - self._heard > SILENT_S

    def _run(self) -> None:
        while not self._end.is_set():
            try:
                asyncio.run(self._listen(self._end))
            except Exception as error:  # whatever a client or a server of others raises: it is asked again
                log.warning("%s is asked again: %s", self._source.url, error or type(error).__name__)
            self.connected = False
            self._end.wait(_AGAIN_S)

    async def _listen(self, end: Event) -> None:
        source, asyncua = self._source, import_module("asyncua")
        client = asyncua.Client(source.url)
        if source.user is not None:
            client.set_user(source.user)
            client.set_password(secret_in(self._folder, source.password_file, "password_file") or "")
        async with client:
            nodes = {client.get_node(node): channel for channel, node in source.channels.items()}
            step_ms = 1000.0 / source.rate_hz
            told = await client.create_subscription(
                min(max(step_ms, 100.0), 1000.0), _Told(nodes, self._values)
            )
            await told.subscribe_data_change(list(nodes), queuesize=10_000, sampling_interval=step_ms)
            self.connected = True
            while not end.is_set():
                await asyncio.sleep(1.0)
                await client.check_connection()


class _Told:
    """Callback of asyncua for changed values."""

    def __init__(self, nodes: dict[Any, str], values: queue.Queue[Value]) -> None:
        self._nodes, self._values = nodes, values

    def datachange_notification(self, node: Any, value: Any, data: Any) -> None:
        """Keep a value with the time at which its source measured it."""
        measured = data.monitored_item.Value.SourceTimestamp or data.monitored_item.Value.ServerTimestamp
        if measured is not None and value is not None:
            zoned = measured if measured.tzinfo is not None else measured.replace(tzinfo=UTC)
            self._values.put((self._nodes[node], zoned, value))


def packets_of(values: Iterable[Value], asset: str, rate_hz: float) -> list[Packet]:
    """Return the packets of values that came one by one, or of arrays that begin at their time.

    Parameters
    ----------
    values : in any order; one that is no number is missing
    rate_hz : of the samples
    """
    by_channel: dict[str, dict[datetime, Sequence[float]]] = {}
    for channel, time_utc, value in values:
        row = value if isinstance(value, list | tuple) else [value]
        if row:
            by_channel.setdefault(channel, {})[time_utc] = [_number(x) for x in row]
    found = []
    for channel, known in by_channel.items():
        times = sorted(known)
        cuts = [
            0,
            *(k + 1 for k, (a, b) in enumerate(pairwise(times)) if _apart(a, b, known, rate_hz)),
            len(times),
        ]
        for first, last in pairwise(cuts):
            samples = np.concatenate([known[time] for time in times[first:last]])
            found.append(Packet(asset, channel, times[first], rate_hz, samples))
    return found


def _apart(a: datetime, b: datetime, known: dict[datetime, Sequence[float]], rate_hz: float) -> bool:
    """Tell whether values are missing between two times, or clocks do not agree with the rate."""
    steps = (b - a).total_seconds() * rate_hz
    return abs(steps - len(known[a])) > _GAP - 1.0


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        return np.nan
