"""A twin followed through time: its state, what is known after each day, and whether it drifts."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located
from jackettwin.files import StoredSchema
from jackettwin.soil import parameter_words
from jackettwin.study.in_time.stiffness import Reference, Sensitivity, Span3, StiffnessLevel
from jackettwin.study.in_time.track import SuddenChange, Tracked
from jackettwin.twin import TwinState
from jackettwin.updating import Drift
from jackettwin.version import __version__

FEWEST_DAYS = 3
"""Days with data before a drift is looked for."""
STIFFNESS = "N/m"
"""Unit of the parameters that may drift."""
SECONDS_A_DAY = 86400.0
_BLIND = 100.0
"""Per cent a day: where no smaller drift would be seen, nothing can be said of any."""


@dataclass(frozen=True)
class Known:
    """What is known of the parameters after a day: of stiffness as it is then, of others by all days so far.

    Attributes
    ----------
    date : str
        UTC, ISO.
    time_utc : datetime
        The middle of the day's records.
    records : int
        Of the day.
    evidence : str
        Identity of the state it was estimated from: another one makes it out of date.
    median : {parameter: value}
    interval_90 : {parameter: (low, high)}
    status : str
        ``"ok"``, or why there is no posterior; then median and interval are Laplace's.
    relative : (low, median, high) or None
        The stiffness of the day over that of the first, 90 %.
    """

    date: str
    time_utc: datetime
    records: int
    evidence: str
    median: Mapping[str, float]
    interval_90: Mapping[str, tuple[float, float]]
    status: str = "ok"
    relative: Span3 | None = None


@dataclass(frozen=True)
class Pooled:
    """What all records up to the end of a day say together: asked when they have grown by a third.

    Attributes
    ----------
    records : how many there were
    median, interval_90, status : of every parameter, as of :class:`Known`
    about : how frequencies follow the stiffness there, or None if no mode can be followed
    reference : draws of the stiffness
    """

    records: int
    median: Mapping[str, float]
    interval_90: Mapping[str, tuple[float, float]]
    status: str
    about: Sensitivity | None
    reference: Reference


@dataclass(frozen=True)
class Followed:
    """A twin followed through time: what the next day starts from.

    Attributes
    ----------
    law : str
    reference_hz : float
        The first frequency on pinned feet: it tells a changed structure.
    wind_m_s : float or None
        That nacelle dashpots are stated at.
    units : {parameter: unit}
    days : in the order of time
    drift : Drift or None
        Of all stiffness together, from the first day on; None before the third day.
    state : TwinState
        Of all records.
    warnings : sentences
    pooled : {date: Pooled}
        On the days after which all records together were asked.
    track : Tracked or None
        What the stiffness is followed on from.
    smoothed : {date: StiffnessLevel}
        The stiffness on each day, by all days together.
    ahead : {days: StiffnessLevel}
        What is to be expected so many days after the last one.
    """

    name: str
    law: str
    reference_hz: float
    wind_m_s: float | None
    units: Mapping[str, str]
    days: tuple[Known, ...]
    drift: Drift | None
    state: TwinState
    warnings: tuple[str, ...] = field(default=())
    pooled: Mapping[str, Pooled] = field(default_factory=dict)
    track: Tracked | None = None
    smoothed: Mapping[str, StiffnessLevel] = field(default_factory=dict)
    ahead: Mapping[int, StiffnessLevel] = field(default_factory=dict)

    def __repr__(self) -> str:
        last = "" if not self.days else ", ".join(f"{k} {v:.3g}" for k, v in self.days[-1].median.items())
        return f"Followed({self.name!r}, {self.law}, {len(self.days)} days; last: {last})"

    @property
    def moments(self) -> str:
        """What is followed from one to the next: ``day``, or ``record``."""
        return "record" if any("T" in day.date for day in self.days) else "day"

    @property
    def stiffness(self) -> tuple[str, ...]:
        """Names of the stiffness parameters: those that may drift."""
        return tuple(name for name, unit in self.units.items() if unit == STIFFNESS)

    @property
    def days_since_first(self) -> FloatArray:
        """Times of the days [d], (n_days,)."""
        return since_first([day.time_utc for day in self.days])

    @property
    def changes(self) -> tuple[SuddenChange, ...]:
        """Sudden changes of the stiffness."""
        return () if self.track is None else self.track.changes

    @property
    def window_begins_after(self) -> str:
        """The day before those that are taken again by the next run; empty before the first."""
        before = 0 if self.track is None else self.track.days
        tracked = [day.date for day in self.days if day.relative is not None]
        return tracked[before - 1] if before else ""

    @property
    def statement(self) -> str:
        """What is known of the stiffness through time: one slope unless it jumped, and where it is now."""
        return " ".join(filter(None, (self._slope, self.stiffness_statement)))

    @property
    def stiffness_statement(self) -> str:
        """When the stiffness jumped, and where it is now."""
        last = next(iter(self.days[-1:]), None)
        if last is None or last.relative is None or len(self.days) < FEWEST_DAYS:
            return ""
        low, middle, high = (f"{x:.3f}" for x in last.relative)
        now = (
            f"On {last.time_utc:%Y-%m-%d} the stiffness is {middle} of what it was on the first day, "
            f"90 % interval {low} to {high}."
        )
        return " ".join((*map(_sudden, self.changes), now))

    @property
    def _slope(self) -> str:
        if self.changes:  # a slope through a step says nothing
            return ""
        if self.drift is None:
            return f"Too early to speak of a drift: {FEWEST_DAYS} days with data are needed."
        slope, low, high = 100.0 * np.expm1([self.drift.slope_per_day, *self.drift.interval_90])
        what, most = " and ".join(map(parameter_words, self.stiffness)), max(abs(low), abs(high))
        over = f"{round(self.days_since_first[-1], 1):g} days"
        if not self.drift.detected and most > _BLIND:
            return (
                f"Too early to speak of a drift of {what}: in {over} not even a doubling a day would be seen."
            )
        found = "No drift found" if not self.drift.detected else "Rising" if low > 0.0 else "Falling"
        change = "changes" if len(self.stiffness) == 1 else "change"
        said = (
            f"{found}: {what} {change} by {slope:+.2g} % a day, 90 % interval {low:+.2g} to {high:+.2g} %, "
            f"over {over}."
        )
        return (
            said if self.drift.detected else f"{said} A drift of more than {most:.2g} % a day would be seen."
        )


def _sudden(change: SuddenChange) -> str:
    """Return what is said of a sudden change."""
    first, when, last = (f"{day_utc(x):%Y-%m-%d}" for x in change.days)
    low, middle, high = (100.0 * (x - 1.0) for x in change.factor)
    verb = "fell" if middle < 0.0 else "rose"
    about = f"on {when}" if first == last else f"about {when} (between {first} and {last})"
    return f"The stiffness {verb} by {abs(middle):.2g} % {about}, 90 % interval {low:+.2g} to {high:+.2g} %."


def day_utc(day: float) -> datetime:
    """Return a time that is given in days since 1970."""
    return datetime(1970, 1, 1, tzinfo=UTC) + timedelta(days=day)


def since_first(times: Sequence[datetime]) -> FloatArray:
    """Return times after the first [d], (n_times,)."""
    return np.array([(time - times[0]).total_seconds() / SECONDS_A_DAY for time in times])


FOLLOWED = StoredSchema("followed", Followed)
"""``followed.json``."""
STORED = "state"
"""Key of what the next run goes on from."""


def follow_document(followed: Followed) -> dict[str, Any]:
    """Return the document of ``jackettwin follow``, with what the next day starts from."""
    drift = followed.drift
    return {
        "name": followed.name,
        "law": followed.law,
        "reference_frequency_hz": followed.reference_hz,
        "wind_speed_m_s": followed.wind_m_s,
        "units": dict(followed.units),
        "days": days_document(followed),
        "drift": None
        if drift is None
        else {
            "parameters": list(followed.stiffness),
            "log_slope_per_day": drift.slope_per_day,
            "log_slope_per_day_std": drift.std_per_day,
            "log_slope_per_day_interval_90": list(drift.interval_90),
            "detected": drift.detected,
            "scatter": drift.scatter,
            "line": {
                name: [
                    {"median": m, "interval_90": [a, b]}
                    for m, a, b in drift.line(name, followed.days_since_first).tolist()
                ]
                for name in followed.stiffness
            },
        },
        "stiffness_in_time": in_time_document(followed),
        "statement": followed.statement,
        "warnings": list(followed.warnings),
        "code_version": __version__,
        STORED: FOLLOWED.dump(followed),
    }


def _span(span: Span3) -> dict[str, Any]:
    return {"median": span[1], "interval_90": [span[0], span[2]]}


def days_document(followed: Followed) -> list[dict[str, Any]]:
    """Return what was known after each day."""
    return [
        {
            "time_utc": day.time_utc.isoformat(),
            "records": day.records,
            "status": day.status,
            "relative_stiffness": None if day.relative is None else _span(day.relative),
            "parameters": {
                name: {"median": median, "interval_90": list(day.interval_90[name])}
                for name, median in day.median.items()
            },
        }
        for day in followed.days
    ]


def in_time_document(followed: Followed) -> dict[str, Any]:
    """Return the stiffness of each day by all days, what jumped, and what to expect; over the first day's."""
    return {
        "smoothed": {date: _span(level.relative) for date, level in followed.smoothed.items()},
        "changes": [
            {
                "time_utc": day_utc(change.days[1]).isoformat(),
                "time_utc_interval_90": [day_utc(change.days[i]).isoformat() for i in (0, 2)],
                "factor": _span(change.factor),
                "probability": change.probability,
            }
            for change in followed.changes
        ],
        "forecast": [{"days": days, **_span(level.relative)} for days, level in followed.ahead.items()],
    }


def read_followed(path: Path) -> Followed:
    """Read what an earlier run of ``jackettwin follow`` left.

    Raises
    ------
    InputError
        If the file is not what ``jackettwin follow`` writes.
    """
    remedy = "give the followed.json of an earlier run"
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError):
        raise InputError("not a JSON document", file=path, remedy=remedy) from None
    if not isinstance(document, dict) or STORED not in document:
        raise InputError("required key is missing", file=path, field=STORED, remedy=remedy)
    with located(file=path, field=STORED):
        return FOLLOWED.load(document[STORED])
