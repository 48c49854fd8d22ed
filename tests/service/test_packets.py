"""Packets to records.

Whatever order they come in, nothing twice, gaps stay gaps, one clock for all channels.
"""

import json
import random
from datetime import UTC, datetime, timedelta

import cbor2
import numpy as np
import pytest
from paho.mqtt.client import MQTTMessage

from jackettwin.errors import InputError
from jackettwin.service.context import Service
from jackettwin.service.intake.mqtt import MqttIntake
from jackettwin.service.intake.packets import read_packets
from jackettwin.service.work.stream_windows import assembled, on_grid
from jackettwin.store import reading, streams
from jackettwin.store.streams import WINDOW, Packet, window_start

START = datetime(2025, 3, 1, 12, 10, tzinfo=UTC)
RATE = 20.0
N = 12_000


def motion(t: np.ndarray) -> np.ndarray:
    """Two modes, below a fifth of the sampling rate as what is identified is."""
    return np.sin(2 * np.pi * 0.31 * t) + 0.2 * np.cos(2 * np.pi * 1.9 * t)


def packets(
    channel: str = "a", *, first_s: float = -5.0, last_s: float = 605.0, size_s: float = 2.0, ppm: float = 0.0
) -> list[Packet]:
    """What a logger sends whose clock is fast by some parts in a million."""
    found, own = [], RATE * (1.0 + ppm * 1e-6)
    k = 0
    while (t0 := first_s + k * size_s) < last_s:
        t = t0 + np.arange(int(size_s * RATE)) / own
        found.append(Packet("wtg", channel, START + timedelta(seconds=t0), own, motion(t)))
        k += 1
    return found


def test_order_and_doubles_do_not_count() -> None:
    sent = packets()
    expected = assembled(sent, START, {}, "x")
    assert expected is not None
    np.testing.assert_allclose(expected.data[0], motion(np.arange(N) / RATE), atol=1e-12)
    shuffled = random.Random(3).sample([*sent, *sent[::3]], len(sent) + len(sent[::3]))
    again = assembled(shuffled, START, {}, "x")
    assert again is not None
    np.testing.assert_array_equal(again.data, expected.data)


def test_lost_packets_are_gaps() -> None:
    sent = packets()
    del sent[100:104]  # 195 to 203 s
    found = assembled(sent, START, {}, "x")
    assert found is not None
    lost = np.isnan(found.data[0])
    assert lost.sum() == 160
    np.testing.assert_array_equal(np.flatnonzero(lost), np.arange(195 * 20, 203 * 20))


def test_a_clock_that_drifts_is_brought_onto_the_grid() -> None:
    """50 ppm: over a day's packets 0.03 s an hour, over one packet 0.1 ms; each packet says when it began."""
    found = on_grid(packets(ppm=50.0), START, RATE, N)
    known = np.isfinite(found)
    assert known.mean() > 0.99
    # a sample that is 2 % of a step off its place is wrong by 2π·1.9·0.2·0.001 of the faster mode
    np.testing.assert_allclose(found[known], motion(np.arange(N) / RATE)[known], atol=4e-3)


def test_a_clock_off_the_grid_is_interpolated() -> None:
    shifted = [
        Packet(p.asset, p.channel, p.t0_utc + timedelta(milliseconds=20), p.rate_hz, p.samples)
        for p in packets()
    ]
    found = on_grid(shifted, START, RATE, N)
    inside = slice(10, N - 10)
    expected = motion(np.arange(N) / RATE - 0.02)
    # cubic splines at a tenth of the sampling rate: (2π·0.095)⁴/384 · … of 0.2, well below 1e-3
    np.testing.assert_allclose(found[inside], expected[inside], atol=1e-3)


def test_one_lost_sample_of_a_clock_off_the_grid_is_not_bridged() -> None:
    """The two grid points beside a lost sample have a measurement on one side only: they stay empty."""
    sent = packets()
    cut = sent[100]  # 195 to 197 s
    sent[100] = Packet(cut.asset, cut.channel, cut.t0_utc, cut.rate_hz, cut.samples[:-1])
    late = timedelta(milliseconds=20)
    shifted = [Packet(p.asset, p.channel, p.t0_utc + late, p.rate_hz, p.samples) for p in sent]
    found = on_grid(shifted, START, RATE, N)
    lost = 197 * 20 - 1
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(found[10:-10])) + 10, [lost, lost + 1])


def test_channels_of_their_own_share_the_window() -> None:
    found = assembled([*packets("a"), *packets("b", first_s=100.0)], START, {}, "x")
    assert found is not None
    assert found.channel_names == ("a", "b")
    assert np.isnan(found.data[1, : int(100 * RATE)]).all()
    assert np.isfinite(found.data[0]).all()


def test_windows_stand_on_utc_boundaries() -> None:
    assert window_start(START + timedelta(seconds=599.99)) == START
    assert window_start(START + WINDOW) == START + WINDOW


@pytest.mark.parametrize(
    ("topic", "payload", "field"),
    [
        ("other/wtg", b"{}", "topic"),
        ("jackettwin/wtg/a/b", b"{}", "topic"),
        ("jackettwin/../etc", b"{}", "name"),
        ("jackettwin/wtg/a", b"\xff\x00", "payload"),
        ("jackettwin/wtg/a", b'{"t0_utc": "2025-03-01T00:00:00", "rate_hz": 20, "samples": [1]}', "t0_utc"),
        ("jackettwin/wtg/a", b'{"t0_utc": "2025-03-01T00:00:00Z", "rate_hz": 0, "samples": [1]}', "rate_hz"),
        ("jackettwin/wtg/a", b'{"t0_utc": "2025-03-01T00:00:00Z", "rate_hz": 20, "samples": []}', "rate_hz"),
        ("jackettwin/wtg", b'{"t0_utc": "2025-03-01T00:00:00Z", "rate_hz": 20, "samples": [1]}', "payload"),
    ],
)
def test_what_is_no_packet_is_refused_by_field(topic: str, payload: bytes, field: str) -> None:
    with pytest.raises(InputError) as caught:
        read_packets(topic, payload)
    assert caught.value.field == field


def test_packets_that_are_not_kept_are_counted_and_said_once(service: Service, caplog) -> None:
    """Of a turbine that is misspelt, of a clock that jumped, and rubbish; an operator can alarm on them."""
    intake = MqttIntake(service, "mqtt://127.0.0.1")
    service.has_intake = True  # of several servers on a store, the one that listens
    good, jumped = (
        json.dumps({"t0_utc": t0, "rate_hz": 20.0, "channels": {"a": [1.0]}}).encode()
        for t0 in ("2025-03-01T12:00:00Z", "2095-03-01T12:00:00Z")
    )
    for topic, payload in [("wtg", good), ("wtg", jumped), ("wgt", good), ("wgt", good), ("wtg", b"x")]:
        message = MQTTMessage(topic=f"jackettwin/{topic}".encode())
        message.payload = payload
        intake._inbox.put(message)
    intake.turn()
    intake.stop()
    assert intake.refused == 4
    about_packets = [record.message[:14] for record in caplog.records if "broker" not in record.message]
    assert about_packets == [
        "payload: not a",
        "packets of wtg",
        "packets of wgt",
    ]
    with reading(service.database) as connection:
        assert streams.newest_packet(connection, "wtg") == datetime(2025, 3, 1, 12, tzinfo=UTC)


def test_json_and_cbor_say_the_same() -> None:
    body = {"t0_utc": "2025-03-01T12:00:00Z", "rate_hz": 20.0, "channels": {"a": [1.0, 2.0], "b": [3.0]}}
    one = read_packets("jackettwin/wtg", json.dumps(body).encode())
    two = read_packets("jackettwin/wtg", cbor2.dumps(body))
    assert [(p.channel, p.t0_utc, p.samples.tolist()) for p in one] == [
        (p.channel, p.t0_utc, p.samples.tolist()) for p in two
    ]
