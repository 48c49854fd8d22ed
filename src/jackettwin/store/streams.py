"""Packets of streams and conditions of the site, stored until records are made from them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from itertools import pairwise
from typing import TYPE_CHECKING

from sqlalchemy import Connection, delete, func, insert, select, update

from jackettwin.store.database import insert_new
from jackettwin.store.tables import conditions, packets, windows

if TYPE_CHECKING:
    from jackettwin.arrays import FloatArray

WINDOW = timedelta(minutes=10)
"""Length of the records made from streams, which begin at whole multiples of it in UTC."""
KEPT = timedelta(days=2)
"""Largest delay of a packet that is still added to its record."""
INTERVAL = timedelta(minutes=10)
"""Longest interval for which a row of conditions is valid, that of the usual ten-minute statistics."""
LONGEST = timedelta(hours=1)
"""Longest duration of a packet."""
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


@dataclass(frozen=True)
class Packet:
    """Samples of one channel of one asset from ``t0_utc`` on."""

    asset: str
    channel: str
    t0_utc: datetime
    rate_hz: float
    samples: FloatArray

    @property
    def end_utc(self) -> datetime:
        """End of the step of its last sample."""
        return self.t0_utc + timedelta(seconds=self.samples.size / self.rate_hz)


def add_packets(connection: Connection, new: Iterable[Packet], now: datetime) -> list[Packet]:
    """Store new packets, by asset, channel and start; return the rejected ones.

    A packet that begins :data:`KEPT` before the newest of its asset is rejected, since the other packets of
    its window were deleted. So is one that is as far ahead of its asset's stream and of the server's clock,
    since a logger's clock that jumped into the future must not make all later packets too late.
    """
    left_out = []
    newest: dict[str, datetime | None] = {}
    for packet in new:
        if packet.asset not in newest:
            newest[packet.asset] = newest_packet(connection, packet.asset)
        clock = newest[packet.asset]
        if not (clock or packet.t0_utc) - KEPT <= packet.t0_utc <= max(now, clock or now) + KEPT:
            left_out.append(packet)
            continue
        row = {
            "asset": packet.asset,
            "channel": packet.channel,
            "t0_utc": packet.t0_utc,
            "window_utc": window_start(packet.t0_utc),
            "rate_hz": packet.rate_hz,
            "samples": packet.samples.astype("<f8").tobytes(),
        }
        if insert_new(connection, packets, row):
            for window_utc in _reached(packet):
                _count(connection, packet.asset, window_utc)
    return left_out


@dataclass(frozen=True)
class OpenWindow:
    """A window with more packets than its record contains."""

    asset: str
    window_utc: datetime
    n_known: int
    record_id: str | None


def window_start(time: datetime) -> datetime:
    """Return the start of the window that contains a time."""
    return _EPOCH + (time - _EPOCH) // WINDOW * WINDOW


def open_windows(connection: Connection) -> list[OpenWindow]:
    """Return the windows with packets that no record contains yet, oldest first."""
    columns = (windows.c.asset, windows.c.window_utc, windows.c.n_known, windows.c.record_id)
    query = select(*columns).where(windows.c.n_known != windows.c.n_packets)
    return [OpenWindow(*row) for row in connection.execute(query.order_by(windows.c.window_utc))]


def newest_packet(connection: Connection, asset: str) -> datetime | None:
    """Return the start of the newest packet of an asset: the stream's own clock."""
    # the last window in which a packet began is found by the index
    last = select(func.max(packets.c.window_utc)).where(packets.c.asset == asset).scalar_subquery()
    where = (packets.c.asset == asset, packets.c.window_utc == last)
    newest: datetime | None = connection.scalar(
        select(func.max(packets.c.t0_utc, type_=packets.c.t0_utc.type)).where(*where)
    )
    return newest


def packets_of(connection: Connection, asset: str, window_utc: datetime) -> list[Packet]:
    """Return every packet that may overlap a window, by channel and time."""
    import numpy as np

    near = packets.c.window_utc.between(window_utc - LONGEST, window_utc)
    order = (packets.c.channel, packets.c.t0_utc)
    rows = connection.execute(select(packets).where(packets.c.asset == asset, near).order_by(*order))
    found = [
        Packet(row.asset, row.channel, row.t0_utc, row.rate_hz, np.frombuffer(row.samples, dtype="<f8"))
        for row in rows
    ]
    return [packet for packet in found if packet.end_utc > window_utc]


def packets_after(
    connection: Connection, asset: str, after: int | None, most: int = 1000
) -> tuple[int, list[Packet]]:
    """Return the packets that came after a number, and the newest number; none at all before the first call.

    Parameters
    ----------
    after : number that an earlier call returned; None asks for the newest number alone
    """
    import numpy as np

    own = packets.c.asset == asset
    if after is None:
        return connection.scalar(select(func.max(packets.c.id)).where(own)) or 0, []
    rows = connection.execute(
        select(packets).where(own, packets.c.id > after).order_by(packets.c.id).limit(most)
    ).all()
    found = [Packet(r.asset, r.channel, r.t0_utc, r.rate_hz, np.frombuffer(r.samples, "<f8")) for r in rows]
    return rows[-1].id if rows else after, found


def close_window(connection: Connection, window: OpenWindow, record_id: str | None) -> None:
    """Store the record of a window, and the number of its packets."""
    same = (windows.c.asset == window.asset, windows.c.window_utc == window.window_utc)
    made = {"n_packets": window.n_known, "record_id": record_id}
    connection.execute(update(windows).where(*same).values(**made))


def forget_packets(connection: Connection, asset: str, before: datetime) -> None:
    """Delete the packets and windows of an asset that begin before a time."""
    for table in (packets, windows):
        connection.execute(delete(table).where(table.c.asset == asset, table.c.window_utc < before))


def put_conditions(
    connection: Connection, asset: str, name: str, values: Mapping[datetime, float | str | None]
) -> set[datetime]:
    """Store a condition of the site over time; return the times at which it is new or changed."""
    if not values:
        return set()
    same = (conditions.c.asset == asset, conditions.c.name == name)
    between = conditions.c.time_utc.between(min(values), max(values))
    rows = connection.execute(select(conditions).where(*same, between))
    known = {row.time_utc: row.value if row.text is None else row.text for row in rows}
    changed = {time: v for time, v in values.items() if time not in known or known[time] != v}
    gone = [time for time in changed if time in known]
    for i in range(0, len(gone), 500):
        part = conditions.c.time_utc.in_(gone[i : i + 500])
        connection.execute(delete(conditions).where(*same, part))
    key = {"asset": asset, "name": name}
    new = [
        {**key, "time_utc": time, "value": None if isinstance(v, str) else v, "text": _text(v)}
        for time, v in changed.items()
    ]
    if new:
        connection.execute(insert(conditions), new)
    return set(changed)


def _text(value: float | str | None) -> str | None:
    return value[:64] if isinstance(value, str) else None


def conditions_between(
    connection: Connection, asset: str, start: datetime, end: datetime
) -> dict[str, float | str]:
    """Return each condition during a record: the mean of numbers, or a text that does not change.

    A row is valid until the next one, for at most ten minutes. It is used if the record covers at least half
    of this interval, or the interval half of the record. Unknown conditions and texts that change are
    omitted.
    """
    import numpy as np

    near = conditions.c.time_utc.between(start - INTERVAL, end)
    where = (conditions.c.asset == asset, near)
    seen: dict[str, list[tuple[datetime, float | str]]] = {}
    for row in connection.execute(select(conditions).where(*where).order_by(conditions.c.time_utc)):
        value = row.text if row.text is not None else row.value
        if value is not None:
            seen.setdefault(row.name, []).append((row.time_utc, value))
    known: dict[str, float | str] = {}
    for name, rows in seen.items():
        values = _during(rows, start, end)
        numbers = [v for v in values if isinstance(v, float)]
        if values and len(numbers) == len(values):
            known[name] = float(np.mean(numbers))
        elif len(set(values)) == 1:
            known[name] = values[0]
    return known


def _during(rows: list[tuple[datetime, float | str]], start: datetime, end: datetime) -> list[float | str]:
    steps = [b - a for (a, _), (b, _) in pairwise(rows)]
    interval = min([*steps, INTERVAL])
    enough = 0.5 * min(interval, end - start)
    return [v for t, v in rows if min(t + interval, end) - max(t, start) >= enough]


def _reached(packet: Packet) -> Iterator[datetime]:
    """Yield the windows in which a packet has samples."""
    window_utc = window_start(packet.t0_utc)
    while window_utc < packet.end_utc:
        yield window_utc
        window_utc += WINDOW


def _count(connection: Connection, asset: str, window_utc: datetime) -> None:
    """Count one more packet of a window, so that a record of fewer packets is made again."""
    insert_new(connection, windows, {"asset": asset, "window_utc": window_utc, "n_packets": 0, "n_known": 0})
    same = (windows.c.asset == asset, windows.c.window_utc == window_utc)
    connection.execute(update(windows).where(*same).values(n_known=windows.c.n_known + 1))
