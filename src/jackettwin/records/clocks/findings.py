"""What is said of clocks that are not in step, and which samples are left."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.findings import Finding
from jackettwin.quantities import VIBRATIONS
from jackettwin.records.clocks.found import LateClock, LoggerClocks
from jackettwin.records.clocks.loggers import logger_clocks
from jackettwin.records.clocks.lost_time import rejoined
from jackettwin.records.clocks.shift import earlier
from jackettwin.records.processing.filters import bridge
from jackettwin.records.quality.faults import is_constant

if TYPE_CHECKING:
    from jackettwin.records.record import Record


LEAST_PRESENT = 0.75
"""Share of the samples of a channel whose clock can be judged: a longer gap, bridged, looks like another
time."""


def clocks_of(record: Record, slow_free: FloatArray) -> LoggerClocks:
    """Return what the vibrations of a record say of the clocks of its loggers.

    Parameters
    ----------
    slow_free : (n_channels, n_samples)
        Its samples without mean and drift; NaN marks missing ones.
    """
    rows = [
        i
        for i, channel in enumerate(record.channels)
        if channel.quantity in VIBRATIONS
        and np.isfinite(slow_free[i]).mean() > LEAST_PRESENT
        and not is_constant(slow_free[i])
    ]
    if len(rows) < 2:
        return LoggerClocks(stop=record.data.shape[1])
    found = logger_clocks(
        np.array([bridge(slow_free[i]) for i in rows]),
        record.sample_rate_hz,
        velocity=[record.channels[i].quantity == "velocity" for i in rows],
        places=[record.channels[i].node or record.channels[i].height_m for i in rows],
        directions=[record.channels[i].direction for i in rows],
    )
    return found.of_rows(rows)


def in_step(data: FloatArray, clocks: LoggerClocks, sample_rate_hz: float) -> FloatArray:
    """Return samples with what is certainly late brought into step, NaN where no clock is known."""
    data = data.copy()
    for i in (i for one in clocks.strangers if one.backwards for i in one.rows):
        data[i] = data[i, ::-1]
    for lost in clocks.lost:
        for i in lost.rows:
            data[i] = rejoined(data[i], lost)
    out = data.copy()
    for late in clocks.late:
        if late.certain:
            for i in late.rows:
                out[i] = earlier(data[i], late.delay_s * sample_rate_hz, late.drift)
    for jump in clocks.gains:
        rows = list(jump.rows)
        out[rows, : jump.start] /= jump.factor[0]
        out[rows, jump.stop :] /= jump.factor[1]
        out[rows, jump.start : jump.stop] = np.nan
    time = np.linspace(-0.5, 0.5, data.shape[1])
    for gain in clocks.growing:
        out[list(gain.rows)] *= np.exp(-gain.rate * time)
    out[:, : clocks.start] = np.nan
    out[:, clocks.stop :] = np.nan
    return out


def stretch(clocks: LoggerClocks, n_samples: int, sample_rate_hz: float) -> tuple[int, int]:
    """Return first and last sample (excluded) that all channels have once they are in step."""
    ends = [
        (late.delay_s + late.drift * t) * sample_rate_hz
        for late in clocks.late
        if late.certain
        for t in (0.0, n_samples / sample_rate_hz)
    ]
    first = max(clocks.start, int(np.ceil(-min(ends, default=0.0))))
    last = min(clocks.stop, n_samples - int(np.ceil(max(ends, default=0.0))))
    return max(first, 0), last


def clock_findings(record: Record, clocks: LoggerClocks) -> Iterator[Finding]:
    """Yield what is worth saying about the clocks."""
    rate = record.sample_rate_hz
    for stranger in clocks.strangers:
        code = "stored_backwards" if stranger.backwards else "another_time"
        yield _said(code, stranger.fewer, channels=_names(record, stranger.rows))
    for lost in clocks.lost:
        yield _said(
            "time_lost",
            True,
            channels=_names(record, lost.rows),
            lost_s=abs(lost.samples) / rate,
            lost="lost" if lost.samples > 0 else "gained",
            from_s=lost.start / rate,
            to_s=lost.stop / rate,
        )
    for growing in clocks.growing:
        yield _said(
            "gain_grows", True, channels=_names(record, growing.rows), factor=float(np.exp(growing.rate))
        )
    for gain in clocks.gains:
        if min(gain.factor) < 0.0:
            yield _said(
                "sign_turns",
                True,
                channels=_names(record, gain.rows),
                from_s=gain.start / rate,
                to_s=gain.stop / rate,
            )
            continue
        at, factor = ("from", gain.factor[1]) if gain.factor[0] == 1.0 else ("until", gain.factor[0])
        yield _said(
            "gain_jump",
            True,
            channels=_names(record, gain.rows),
            factor=factor,
            at=at,
            time_s=(gain.stop if at == "from" else gain.start) / rate,
            from_s=gain.start / rate,
            to_s=gain.stop / rate,
        )
    for jump in clocks.jumps:
        yield _said(
            "clock_jump",
            channels=_names(record, jump.rows),
            by_s=jump.by_s,
            from_s=jump.start / rate,
            to_s=jump.stop / rate,
        )
    if not clocks.judged:
        yield _said("clocks_wander")
        return
    if clocks.jumps:
        yield _said("clock_cut", True, from_s=clocks.start / rate, to_s=clocks.stop / rate)
    for late in clocks.late:
        yield _late(record, late)


def _late(record: Record, late: LateClock) -> Finding:
    names = _names(record, late.rows)
    middle = late.delay_s + 0.5 * late.drift * record.duration_s
    common: dict[str, float | str] = {
        "channels": names,
        "delay_s": abs(middle),
        "late": "later" if middle > 0.0 else "earlier",
    }
    if not late.certain:
        return _said("clock_late_or_complex", False, **common)
    if late.drift:
        return _said(
            "clock_drift",
            True,
            channels=names,
            drift_ppm=1e6 * abs(late.drift),
            std_ppm=1e6 * late.drift_std,
            slow="slow" if late.drift > 0.0 else "fast",
            delay_s=middle,
        )
    return _said("clock_late", True, std_s=late.delay_std_s, **common)


def _said(code: str, repaired: bool = False, **params: float | str) -> Finding:
    return Finding(code, None, params, repaired)


def _names(record: Record, rows: tuple[int, ...]) -> str:
    return ", ".join(record.channels[i].name for i in rows)
