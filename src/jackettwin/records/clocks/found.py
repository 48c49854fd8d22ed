"""What is found of the clocks and sensitivities of the loggers of one record: rows, times and sizes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class LateClock:
    """Channels that are late by a delay that stays or grows.

    Attributes
    ----------
    rows : tuple of int
    delay_s, delay_std_s : float
        At the beginning of the record; negative if they are early.
    drift, drift_std : float
        Seconds a second by which the delay grows; 0 if it does not.
    certain : bool
        Whether no complex modes could look like it.
    """

    rows: tuple[int, ...]
    delay_s: float
    delay_std_s: float
    drift: float = 0.0
    drift_std: float = 0.0
    certain: bool = True


@dataclass(frozen=True)
class ClockJump:
    """Channels whose delay jumps by so much between two samples."""

    rows: tuple[int, ...]
    start: int
    stop: int
    by_s: float


@dataclass(frozen=True)
class LostTime:
    """Channels that lost so many samples between two of theirs; gained, if negative."""

    rows: tuple[int, ...]
    start: int
    stop: int
    samples: int


@dataclass(frozen=True)
class GainJump:
    """Channels so many times as sensitive before ``start`` (factor[0]) or from ``stop`` on (factor[1]).

    One of the factors is 1, the other negative where a sign turns; what lies between is not known.
    """

    rows: tuple[int, ...]
    start: int
    stop: int
    factor: tuple[float, float]


@dataclass(frozen=True)
class GrowingGain:
    """Channels whose sensitivity grows steadily against the others', by e to this times the duration."""

    rows: tuple[int, ...]
    rate: float


@dataclass(frozen=True)
class Strangers:
    """Channels that have the spectrum of the others and nothing in common with them at any delay.

    Attributes
    ----------
    rows : tuple of int
    backwards : bool
        Whether they have, stored from the end to the beginning.
    fewer : bool
        Whether they are fewer than those they are held against: then it is they.
    """

    rows: tuple[int, ...]
    backwards: bool
    fewer: bool = True


@dataclass(frozen=True)
class LoggerClocks:
    """What the phases say of the clocks.

    Attributes
    ----------
    late : tuple of LateClock
    jumps : tuple of ClockJump
    start, stop : int
        Samples of the longest stretch without a jump, for which ``late`` holds.
    judged : bool
        False if no stretch between jumps is long enough to be judged.
    gains : tuple of GainJump
        Channels whose sensitivity, or sign, jumps.
    growing : tuple of GrowingGain
    strangers : tuple of Strangers
        Channels of another time; the rest is judged without them, or after they are turned.
    lost : tuple of LostTime
        To be given back before anything else here is taken back.
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
        """Return the same of channels that are these rows of a larger record."""
        named: dict[str, Any] = {
            key: tuple(replace(one, rows=tuple(rows[i] for i in one.rows)) for one in getattr(self, key))
            for key in ("late", "jumps", "gains", "growing", "strangers", "lost")
        }
        return replace(self, **named)
