"""Clock and sensitivity errors of one record: rows, times and sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.findings import Finding

if TYPE_CHECKING:
    from jackettwin.records.record import Record


@dataclass(frozen=True)
class LateClock:
    """Channels that are late by a constant or growing delay.

    Attributes
    ----------
    rows : tuple of int
    delay_s, delay_std_s : float
        Delay at the beginning of the record; negative if early.
    drift, drift_std : float
        Growth of the delay at the beginning [s/s]; 0 if it is constant.
    certain : bool
        Whether complex modes are excluded as an explanation.
    bend : float
        Half of the rate at which the drift changes [1/s]; 0 if the clock's rate is constant.
    """

    rows: tuple[int, ...]
    delay_s: float
    delay_std_s: float
    drift: float = 0.0
    drift_std: float = 0.0
    certain: bool = True
    bend: float = 0.0

    def delay_at(self, time_s: float) -> float:
        """Return the delay at a time from the beginning of the record [s].

        >>> LateClock((0,), 1.0, 0.0, drift=0.5, bend=0.25).delay_at(2.0)
        3.0
        """
        return self.delay_s + self.drift * time_s + self.bend * time_s**2


@dataclass(frozen=True)
class ClockJump:
    """Channels whose delay jumps between two samples."""

    rows: tuple[int, ...]
    start: int
    stop: int
    by_s: float


@dataclass(frozen=True)
class LostTime:
    """Channels that lost a number of samples between two others; gained if negative."""

    rows: tuple[int, ...]
    start: int
    stop: int
    samples: int


@dataclass(frozen=True)
class GainJump:
    """Channels whose sensitivity is multiplied before ``start`` (factor[0]) or from ``stop`` on (factor[1]).

    One factor is 1; the other is negative if the sign reverses. Between ``start`` and ``stop`` it is unknown.
    """

    rows: tuple[int, ...]
    start: int
    stop: int
    factor: tuple[float, float]


@dataclass(frozen=True)
class GrowingGain:
    """Channels whose relative sensitivity grows steadily, by e to this rate times the duration."""

    rows: tuple[int, ...]
    rate: float


@dataclass(frozen=True)
class Strangers:
    """Channels with the spectrum of the others but no coherence with them at any delay.

    Attributes
    ----------
    rows : tuple of int
    backwards : bool
        Whether they are coherent once reversed in time.
    fewer : bool
        Whether they are fewer than the others, and therefore the ones at fault.
    perhaps_across : bool
        Whether they may as well measure another direction, since directions are not stated.
    """

    rows: tuple[int, ...]
    backwards: bool
    fewer: bool = True
    perhaps_across: bool = False


@dataclass(frozen=True)
class LoggerClocks:
    """Clock errors derived from phases.

    Attributes
    ----------
    late : tuple of LateClock
    jumps : tuple of ClockJump
    start, stop : int
        Samples of the longest part without a jump, to which ``late`` applies.
    judged : bool
        False if no part between jumps is long enough to be judged.
    gains : tuple of GainJump
        Channels whose sensitivity, or sign, jumps.
    growing : tuple of GrowingGain
    strangers : tuple of Strangers
        Channels of another time; the rest is judged without them, or after they are reversed.
        Those perhaps across are judged with the rest.
    lost : tuple of LostTime
        Losses to be corrected before any other error.
    """

    late: tuple[LateClock, ...] = ()
    jumps: tuple[ClockJump, ...] = ()
    start: int = 0
    stop: int = 0
    judged: bool = True
    gains: tuple[GainJump, ...] = ()
    growing: tuple[GrowingGain, ...] = ()
    strangers: tuple[Strangers, ...] = ()
    lost: tuple[LostTime, ...] = ()

    def of_rows(self, rows: Sequence[int]) -> LoggerClocks:
        """Return the same result for channels that are these rows of a larger record."""
        named: dict[str, Any] = {
            key: tuple(replace(one, rows=tuple(rows[i] for i in one.rows)) for one in getattr(self, key))
            for key in ("late", "jumps", "gains", "growing", "strangers", "lost")
        }
        return replace(self, **named)


def clock_findings(record: Record, clocks: LoggerClocks) -> Iterator[Finding]:
    """Yield findings on the clocks."""
    rate = record.sample_rate_hz
    alike: dict[tuple[bool, bool, bool], tuple[int, ...]] = {}
    for one in clocks.strangers:
        kind = (one.perhaps_across, one.backwards, one.fewer and not one.perhaps_across)
        alike[kind] = (*alike.get(kind, ()), *one.rows)
    for (across, backwards, fewer), rows in alike.items():
        yield _strangers(record, rows, across=across, backwards=backwards, fewer=fewer)
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
        yield _gain(record, gain)
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


def _gain(record: Record, gain: GainJump) -> Finding:
    rate = record.sample_rate_hz
    times = {"from_s": gain.start / rate, "to_s": gain.stop / rate}
    if min(gain.factor) < 0.0:
        return _said("sign_turns", True, channels=_names(record, gain.rows), **times)
    at, factor = ("from", gain.factor[1]) if gain.factor[0] == 1.0 else ("until", gain.factor[0])
    time_s = times["to_s" if at == "from" else "from_s"]
    names = _names(record, gain.rows)
    return _said("gain_jump", True, channels=names, factor=factor, at=at, time_s=time_s, **times)


def _strangers(
    record: Record, rows: tuple[int, ...], *, across: bool, backwards: bool, fewer: bool
) -> Finding:
    names = _names(record, rows)
    if across:
        return _said("direction_unknown", channels=names)
    if backwards:
        return _said("stored_backwards", fewer, channels=names)
    stated = all(any(record.channels[i].direction) for i in rows)
    unless = "" if stated else " (unless they point across: state their directions)"
    return _said("another_time", fewer, channels=names, unless=unless)


def _late(record: Record, late: LateClock) -> Finding:
    names = _names(record, late.rows)
    middle = late.delay_at(0.5 * record.duration_s)
    common: dict[str, float | str] = {
        "channels": names,
        "delay_s": abs(middle),
        "late": "later" if middle > 0.0 else "earlier",
    }
    if not late.certain:
        return _said("clock_late_or_complex", False, **common)
    if late.bend:
        at = [late.delay_at(share * record.duration_s) for share in (0.0, 0.5, 1.0)]
        return _said("clock_curve", True, channels=names, begin_s=at[0], middle_s=at[1], end_s=at[2])
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
