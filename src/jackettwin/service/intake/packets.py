"""Packets to records of ten minutes.

Put in order, doubled ones once, gaps left open, channels on one clock.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

import numpy as np
from scipy.interpolate import CubicSpline

from jackettwin.arrays import FloatArray
from jackettwin.records import Channel, Record
from jackettwin.store.streams import WINDOW, Packet

_ON_GRID = 0.02
"""Samples nearer to the common grid than this share of a step stand on it: at the fifth of the sampling rate,
where identification ends, they are 0.7 degrees off."""
_LEAST = 8
"""Fewer samples in a row are not worth an interpolation."""


def assembled(
    packets: Sequence[Packet], window_utc: datetime, channels: dict[str, Channel], name: str
) -> Record | None:
    """Return the record of a window, or None if no packet reaches into it.

    Parameters
    ----------
    packets : of one asset, by channel and time
    channels : {channel: what the twin says of it}; channels it does not name are taken to be accelerations
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

    Overlapping packets of one clock agree; of the same instant the packet that began first is kept. A clock
    that stands off the grid or drifts is brought onto it by a cubic spline through each unbroken run.
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
    """Write one unbroken run, with times in steps of the grid, into the window's row."""
    off = times - np.round(times)
    if np.abs(off).max() <= _ON_GRID or times.size < _LEAST:
        at = np.round(times).astype(int)
        inside = (at >= 0) & (at < row.size)
        row[at[inside]] = values[inside]
        return
    first, last = max(int(np.ceil(times[0])), 0), min(int(np.floor(times[-1])), row.size - 1)
    if first <= last:
        grid = np.arange(first, last + 1)
        row[grid] = CubicSpline(times, values)(grid)


def _seconds(packet: Packet, start: datetime) -> float:
    return (packet.t0_utc - start).total_seconds()
