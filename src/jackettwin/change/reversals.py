"""Changes that are known already: one that takes back an earlier one, or one that comes again.

A repair takes back what it repairs; ice, or a state of operation without a column, comes and goes. Each is a
cause like others, whose direction and size are those of the earlier change with their uncertainty.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from jackettwin.arrays import BoolArray, FloatArray
from jackettwin.intervals import NORMAL_90
from jackettwin.watching import CLEAR, Cause, CauseVerdict

Way = Literal["takes_back", "again"]
_PRIOR = 10.0
"""Prior weight of a known change beside that of a cause of which nothing is known. What stands is repaired,
and what came and went within a year does so again within about another, while new changes are decades
apart."""


@dataclass(frozen=True)
class Recurrence:
    """What a change is to an earlier one: it takes it back or is the same once more.

    Attributes
    ----------
    time_utc : of the alarm of the earlier one
    """

    way: Way
    time_utc: str


@dataclass(frozen=True)
class EarlierAlarm:
    """An earlier alarm.

    Attributes
    ----------
    size, size_std : (m,) change of each quantity as it last looked, of the logarithm or an angle [rad]
    sized : whether it has a size; more scatter has none
    """

    time_utc: str
    size: FloatArray
    size_std: FloatArray
    sized: bool
    answer: Recurrence | None = None


def past_of(alarm: Mapping[str, Any]) -> EarlierAlarm:
    """Return an earlier alarm from its document."""
    sized = list(alarm["by_quantity"].values())
    rows = np.array([[one["size"], *one["interval_90"]] for one in sized])
    turned = np.array([one["unit"] == "deg" for one in sized])[:, None]
    size, low, high = np.where(turned, np.radians(rows), np.log1p(np.where(turned, 0.0, rows))).T
    std = (high - low) / (2.0 * NORMAL_90)
    ways: tuple[Way, ...] = ("takes_back", "again")
    answer = next((Recurrence(way, alarm[f"{way}_utc"]) for way in ways if alarm.get(f"{way}_utc")), None)
    return EarlierAlarm(alarm["time_utc"], size, std, alarm["kind"] != "scatter", answer)


def known_changes(past: Sequence[EarlierAlarm]) -> dict[str, tuple[Recurrence, EarlierAlarm]]:
    """Return by its name what a next change may be to earlier ones: each is undone, or comes once more."""
    first: dict[str, str] = {}  # the time of the first of equal changes, by the time of each
    last: dict[str, tuple[EarlierAlarm, bool]] = {}  # by that time: the last of them, and whether it went
    for one in past:
        known = one.answer is not None and one.answer.time_utc in first
        of = first[one.answer.time_utc] if known and one.answer is not None else one.time_utc
        first[one.time_utc] = of
        gone = known and one.answer is not None and one.answer.way == "takes_back"
        last[of] = (last[of][0], True) if gone else (one, False)
    found = {}
    for time, (one, gone) in last.items():
        if one.sized:
            day = (time if gone else one.time_utc)[:10]
            name = f"the change of {day} {'again' if gone else 'taken back'}"
            found[name] = (Recurrence("again" if gone else "takes_back", time if gone else one.time_utc), one)
    return found


def known_causes(
    known: Mapping[str, tuple[Recurrence, EarlierAlarm]], chosen: BoolArray
) -> tuple[Cause, ...]:
    """Return known changes as causes over chosen quantities."""
    found = []
    for name, (answer, of) in known.items():
        way = -1.0 if answer.way == "takes_back" else 1.0
        draws = _draws(way * of.size[chosen], of.size_std[chosen])
        found.append(Cause(name, draws, np.ones(1), np.zeros(1), prior=_PRIOR, misfit=0.0))
    return tuple(found)


def answer_of(
    named: Sequence[CauseVerdict], known: Mapping[str, tuple[Recurrence, EarlierAlarm]]
) -> Recurrence | None:
    """Return what a change is to an earlier one, if that is clear."""
    (best, *others) = named
    return known[best.cause][0] if best.cause in known and not others and best.probability >= CLEAR else None


def _draws(mean: FloatArray, std: FloatArray) -> FloatArray:
    """Return 2m draws of independent quantities with exactly these means and standard deviations."""
    apart = np.sqrt(mean.size - 0.5) * np.diag(std)
    return np.asarray(mean + np.concatenate([apart, -apart]))
