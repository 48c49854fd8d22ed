"""OPC UA: values to packets, and a real server on loopback where the user has installed asyncua."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from importlib.util import find_spec
from pathlib import Path
from threading import Event, Thread
from typing import Any

import numpy as np
import pytest
from tests.service.conftest import NOON
from tests.service.servers import free_port

from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.intake.opcua import OpcUaIntake, packets_of, read_source
from jackettwin.store import reading, streams

RATE = 20.0
N = 60


def at(k: float) -> Any:
    return NOON + timedelta(seconds=k / RATE)


def test_values_one_by_one_are_unbroken_packets_whatever_their_order() -> None:
    """Clocks that jitter by a tenth of a step do not break one; a value that is missing does."""
    rng = np.random.default_rng(1)
    jitter = rng.uniform(-0.1, 0.1, N)
    values = [("acc_top_x", at(k + jitter[k]), float(k)) for k in range(N) if k != 25]
    rng.shuffle(values)
    first, second = packets_of(values, "wtg", RATE)
    assert first.samples.tolist() == list(range(25))
    assert second.samples.tolist() == list(range(26, N))
    assert (first.t0_utc, second.t0_utc) == (at(jitter[0]), at(26 + jitter[26]))


def test_arrays_begin_at_their_time_and_what_is_no_number_is_missing() -> None:
    values = [("a", at(0), [0.0, 1.0, None]), ("a", at(3), (3.0, "x")), ("b", at(0), 7), ("b", at(9), [])]
    a, b = packets_of(values, "wtg", RATE)
    np.testing.assert_array_equal(a.samples, [0.0, 1.0, np.nan, 3.0, np.nan])
    assert b.samples.tolist() == [7.0]


def source(folder: Path, **changes: Any) -> Path:
    import yaml

    given = {"url": "opc.tcp://127.0.0.1:4840", "asset": "wtg", "rate_hz": RATE, "channels": {"a": "i=1"}}
    file = folder / "nodes.yaml"
    file.write_text(yaml.safe_dump({**given, **changes}))
    return file


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"url": "http://127.0.0.1"}, "no address of OPC UA"),
        ({"url": "opc.tcp://me:secret@127.0.0.1"}, "no address of OPC UA"),
        ({"channels": {}}, "channels"),
        ({"asset": "../x"}, "asset"),
        ({"rate_hz": 0.0}, "rate_hz"),
    ],
)
def test_a_file_that_is_wrong_is_refused(tmp_path: Path, changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        read_source(source(tmp_path, **changes))


@pytest.mark.skipif(find_spec("asyncua") is not None, reason="asyncua is installed")
def test_it_is_said_what_to_install(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="pip install asyncua"):
        read_source(source(tmp_path))


@contextmanager
def real_server(port: int) -> Iterator[None]:
    """A server with a number and an array, each written with the time at which it was measured."""
    asyncua = pytest.importorskip("asyncua", reason="LGPL: the user installs it")
    ready, end = Event(), Event()

    async def serve() -> None:
        server = asyncua.Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{port}")
        place = await server.register_namespace("turbine")
        single = await server.nodes.objects.add_variable(f"ns={place};s=Single", "Single", 0.0)
        block = await server.nodes.objects.add_variable(f"ns={place};s=Block", "Block", [0.0])
        async with server:
            ready.set()
            k = 0
            while not end.is_set():
                await asyncio.sleep(1.0 / RATE)
                if k < N:
                    await single.write_value(
                        asyncua.ua.DataValue(asyncua.ua.Variant(float(k)), SourceTimestamp=at(k))
                    )
                    if k % 20 == 0:
                        row = asyncua.ua.Variant([k + i / 100 for i in range(20)])
                        await block.write_value(asyncua.ua.DataValue(row, SourceTimestamp=at(k)))
                    k += bool(listening)

    listening: list[bool] = []
    thread = Thread(target=lambda: asyncio.run(serve()), daemon=True)
    thread.start()
    assert ready.wait(60.0)
    try:
        yield listening  # type: ignore[misc]
    finally:
        end.set()
        thread.join(30.0)


@pytest.mark.filterwarnings("ignore")  # those of asyncua
def test_a_real_server_is_listened_to(service: Service, tmp_path: Path) -> None:
    port = free_port()
    service.has_intake, service.now = True, lambda: NOON
    with real_server(port) as listening:
        channels = {"acc_top_x": "ns=2;s=Single", "acc_top_y": "ns=2;s=Block"}
        intake = OpcUaIntake(service, source(tmp_path, url=f"opc.tcp://127.0.0.1:{port}", channels=channels))
        try:
            end = time.monotonic() + 120.0
            while time.monotonic() < end:
                intake.turn()
                if intake.connected:
                    listening.append(True)
                with reading(service.database) as connection:
                    packets = streams.packets_of(connection, "wtg", NOON)
                if {x for p in packets for x in p.samples} >= {float(N - 1), 40.19}:
                    break
                time.sleep(0.2)
        finally:
            intake.stop()
    for channel, expected in (("acc_top_x", {float(k) for k in range(1, N)}), ("acc_top_y", {20.0, 40.19})):
        mine = [p for p in packets if p.channel == channel]
        assert expected <= {x for p in mine for x in p.samples}
    places = {
        round((p.t0_utc - NOON).total_seconds() * RATE) + i: x
        for p in packets
        if p.channel == "acc_top_x"
        for i, x in enumerate(p.samples)
    }
    assert all(places[k] == float(k) for k in range(1, N))  # each at the time of its source
