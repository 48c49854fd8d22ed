"""Records of ten minutes from the packets of a stream.

Packets are sorted and used once, gaps remain, and all channels have a common time grid.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.records import Channel, Record
from jackettwin.service.intake.examination import profile
from jackettwin.service.intake.files import accept
from jackettwin.service.work import consequences
from jackettwin.service.workers.tasks import stored
from jackettwin.store import Packet, reading, streams, writing
from jackettwin.store.streams import KEPT, WINDOW

if TYPE_CHECKING:
    from jackettwin.service.context import Service

GRACE = timedelta(seconds=30)
"""Time by the stream's clock after a window's end at which it is closed; it is also closed if the stream is
silent."""
_EVERY_S = 2.0
_ON_GRID = 0.02
"""Share of a step within which samples count as on the common grid. At a fifth of the sampling rate, the
highest identified frequency, the phase error is then 0.7 degrees."""
_LEAST = 8
"""Least number of consecutive samples that are interpolated."""


class StreamWindows:
    """Makes records of finished windows, every few seconds."""

    def __init__(self, service: Service, silent: Callable[[str], bool]) -> None:
        self._service, self._silent = service, silent
        self._last = 0.0

    def turn(self) -> None:
        """Close the finished windows if it is due."""
        if time.monotonic() - self._last >= _EVERY_S:
            self._last = time.monotonic()
            close_windows(self._service, self._silent)


def close_windows(service: Service, silent: Callable[[str], bool]) -> None:
    """Make records of finished windows, also again for a window that has received late packets."""
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
    """Make the record of a window, replacing an earlier one with fewer packets in the same transaction."""
    with reading(service.database) as connection:
        packets = streams.packets_of(connection, window.asset, window.window_utc)
        channels = profile(connection, service, window.asset).channels
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
            why = f"superseded by {number}, which includes late packets"
            consequences.set_aside(connection, service, window.asset, window.record_id, why)
        accept(now, connection, window.asset, parsed, "stream")
        streams.close_window(connection, window, number)


def assembled(
    packets: Sequence[Packet], window_utc: datetime, channels: dict[str, Channel], name: str
) -> Record | None:
    """Return the record of a window, or None if no packet reaches into it.

    Parameters
    ----------
    packets : of one asset, by channel and time
    channels : {channel: properties from the twin}; channels without properties are taken as accelerations
    """
    rates = [packet.rate_hz for packet in packets]
    if not rates:
        return None
    rate = float(np.median(rates))
    n = round(WINDOW.total_seconds() * rate)
    rows, described = [], []
    for channel in sorted({packet.channel for packet in packets}):
        row = on_grid([p for p in packets if p.channel == channel], window_utc, rate, n)
        if np.isfinite(row).any():
            rows.append(row)
            described.append(channels.get(channel, Channel(channel)))
    if not rows:
        return None
    return Record(np.array(rows), rate, tuple(described), window_utc, {}, {"source": "stream"}, name)


def on_grid(packets: Sequence[Packet], start: datetime, rate: float, n: int) -> FloatArray:
    """Return the samples of one channel on the window's grid (n,), NaN where there are none.

    Of overlapping packets the one that began first is used. Samples off the grid, as of a drifting clock, are
    interpolated by a cubic spline in each run without gaps.
    """
    times = (
        np.concatenate([_seconds(p, start) + np.arange(p.samples.size) / p.rate_hz for p in packets]) * rate
    )
    values = np.concatenate([p.samples for p in packets]).astype(float)
    order = np.argsort(times, kind="stable")
    times, values = times[order], values[order]
    new = np.concatenate([[True], np.diff(times) > 0.5])
    times, values = times[new], values[new]
    row = np.full(n, np.nan)
    for run in np.split(np.arange(times.size), np.flatnonzero(np.diff(times) > 1.5) + 1):
        _place(row, times[run], values[run])
    return row


def _place(row: FloatArray, times: FloatArray, values: FloatArray) -> None:
    """Write one run without gaps, with times in steps of the grid, into the window's row."""
    off = times - np.round(times)
    if np.abs(off).max() <= _ON_GRID or times.size < _LEAST:
        at = np.round(times).astype(int)
        inside = (at >= 0) & (at < row.size)
        row[at[inside]] = values[inside]
        return
    from scipy.interpolate import CubicSpline  # half a CPU second of a server's start, if it were above

    first, last = max(int(np.ceil(times[0])), 0), min(int(np.floor(times[-1])), row.size - 1)
    if first <= last:
        grid = np.arange(first, last + 1)
        row[grid] = CubicSpline(times, values)(grid)


def _seconds(packet: Packet, start: datetime) -> float:
    return (packet.t0_utc - start).total_seconds()
