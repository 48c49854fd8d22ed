"""Packets: each once, each window told how many it has, late ones put in, clocks gone wild left out."""

from datetime import UTC, datetime, timedelta

import numpy as np
from sqlalchemy import Engine

from jackettwin.store import assets, streams, writing
from jackettwin.store.streams import Packet

NOON = datetime(2025, 3, 1, 12, tzinfo=UTC)


def packet(minute: float, *, seconds: int = 60) -> Packet:
    return Packet("wtg", "a", NOON + timedelta(minutes=minute), 1.0, np.arange(float(seconds)))


def windows(database: Engine, *packets: Packet) -> dict[str, int]:
    """Return how many packets each open window has, after some more have come."""
    with writing(database) as c:
        if not assets.asset_names(c):
            assets.add_version(
                c, "wtg", {"twin.yaml": b""}, model_hash="m", settings_hash="s", by="me", now=NOON
            )
        streams.add_packets(c, packets, NOON)
        return {f"{w.window_utc:%H:%M}": w.n_known for w in streams.open_windows(c)}


def test_a_packet_counts_once_in_every_window_it_reaches(database: Engine) -> None:
    assert windows(database, packet(0), packet(0), packet(1)) == {"12:00": 2}
    assert windows(database, packet(9.5)) == {"12:00": 3, "12:10": 1}
    assert windows(database, packet(9.5)) == {"12:00": 3, "12:10": 1}
    assert windows(database, packet(15, seconds=1800))["12:40"] == 1


def test_a_window_opens_again_for_what_comes_late(database: Engine) -> None:
    windows(database, packet(0), packet(1))
    with writing(database) as c:
        (window,) = streams.open_windows(c)
        streams.close_window(c, window, "r")
        assert streams.open_windows(c) == []
    assert windows(database, packet(2)) == {"12:00": 3}
    with writing(database) as c:
        (window,) = streams.open_windows(c)
        assert window.record_id == "r"
        assert len(streams.packets_of(c, "wtg", NOON)) == 3


def test_packets_of_the_window_before_reach_in(database: Engine) -> None:
    windows(database, packet(-20, seconds=1800), packet(-20.5, seconds=60))
    with writing(database) as c:
        found = streams.packets_of(c, "wtg", NOON)
    assert [p.samples.size for p in found] == [1800]


def test_a_clock_that_jumps_ahead_does_not_make_all_others_late(database: Engine) -> None:
    assert windows(database, packet(60 * 24 * 400)) == {}
    assert windows(database, packet(0)) == {"12:00": 1}
