"""Result of following a twin through time: its state, the estimate after each day, and the drift."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, date, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import DAY_S
from jackettwin.errors import InputError, located
from jackettwin.files import StoredSchema
from jackettwin.soil import parameter_words
from jackettwin.study.in_time.stiffness import Reference, Sensitivity, Span3, StiffnessLevel
from jackettwin.study.in_time.track import SuddenChange, Tracked
from jackettwin.twin import TwinState
from jackettwin.updating import Drift
from jackettwin.version import __version__

FEWEST_DAYS = 3
"""Days with data that the estimate of a drift needs."""
STIFFNESS = "N/m"
"""Unit of the parameters that may drift."""
_BLIND = 100.0
"""Smallest detectable drift in per cent a day above which no statement on drift is made."""


@dataclass(frozen=True)
class DayEstimate:
    """Estimate of the parameters after a day: stiffness on that day, others over all days so far.

    Attributes
    ----------
    date : str
        UTC, ISO.
    time_utc : datetime
        The middle of the day's records.
    records : int
        Number of records of the day.
    evidence : str
        Identity of the state that it was estimated from; it is outdated if the state has another.
    median : {parameter: value}
    interval_90 : {parameter: (low, high)}
    status : str
        ``"ok"``, or the reason for a missing posterior; then median and interval are by Laplace's method.
    relative : (low, median, high) or None
        Ratio of the day's stiffness to the first day's: median and 90 % interval.
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
class PooledEstimate:
    """Estimate from all records up to the end of a day, made when their number has grown by a third.

    Attributes
    ----------
    records : number of records
    median, interval_90, status : of every parameter, as of :class:`DayEstimate`
    about : sensitivity of frequencies to the stiffness there, or None if no mode can be followed
    reference : draws of the stiffness
    centre, covariance : (d,), (d, d) of ln θ, from which the next estimate is drawn; empty in older files
    """

    records: int
    median: Mapping[str, float]
    interval_90: Mapping[str, tuple[float, float]]
    status: str
    about: Sensitivity | None
    reference: Reference
    centre: FloatArray = field(default_factory=lambda: np.empty(0))
    covariance: FloatArray = field(default_factory=lambda: np.empty((0, 0)))


@dataclass(frozen=True)
class Followed:
    """Result of following a twin through time, from which the next run continues.

    Attributes
    ----------
    law : str
    reference_hz : float
        The first frequency on pinned feet, by which a changed structure is detected.
    wind_m_s : float or None
        Wind speed at which nacelle dashpots are stated.
    units : {parameter: unit}
    days : in order of time
    drift : Drift or None
        Of the common stiffness since the first day; None before the third day.
    state : TwinState
        Of all records.
    warnings : sentences
    pooled : {date: PooledEstimate}
        On the days after which all records were evaluated together.
    track : Tracked or None
        State from which the tracking of the stiffness continues.
    smoothed : {date: StiffnessLevel}
        The stiffness on each day, estimated from all days.
    ahead : {days: StiffnessLevel}
        Forecast so many days after the last one.
    """

    name: str
    law: str
    reference_hz: float
    wind_m_s: float | None
    units: Mapping[str, str]
    days: tuple[DayEstimate, ...]
    drift: Drift | None
    state: TwinState
    warnings: tuple[str, ...] = field(default=())
    pooled: Mapping[str, PooledEstimate] = field(default_factory=dict)
    track: Tracked | None = None
    smoothed: Mapping[str, StiffnessLevel] = field(default_factory=dict)
    ahead: Mapping[int, StiffnessLevel] = field(default_factory=dict)

    def __repr__(self) -> str:
        last = "" if not self.days else ", ".join(f"{k} {v:.3g}" for k, v in self.days[-1].median.items())
        return f"Followed({self.name!r}, {self.law}, {len(self.days)} days; last: {last})"

    @property
    def moments(self) -> str:
        """The interval between estimates: ``day`` or ``record``."""
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
        """The last day before those that the next run evaluates again; empty if there is none."""
        before = 0 if self.track is None else self.track.days
        tracked = [day.date for day in self.days if day.relative is not None]
        return tracked[before - 1] if before else ""

    @property
    def statement(self) -> str:
        """Sentences on the stiffness over time: one slope without a sudden change, and its latest value."""
        return " ".join(filter(None, (self._slope, self.stiffness_statement)))

    @property
    def stiffness_statement(self) -> str:
        """Sentences on sudden changes of the stiffness and its present value."""
        last = next(iter(self.days[-1:]), None)
        if last is None or last.relative is None or len(self.days) < FEWEST_DAYS:
            return ""
        low, middle, high = (f"{x:.3f}" for x in last.relative)
        now = (
            f"On {last.time_utc:%Y-%m-%d} the stiffness is {middle} of that of the first day, "
            f"90 % interval {low} to {high}."
        )
        dates = [day.date[:10] for day in self.days if day.relative is not None]
        return " ".join((*(_sudden(change, dates) for change in self.changes), now))

    @property
    def _slope(self) -> str:
        if self.changes:  # a slope across a step has no meaning
            return ""
        if self.drift is None:
            return f"Too early to estimate a drift: {FEWEST_DAYS} days with data are needed."
        slope, low, high = 100.0 * np.expm1([self.drift.slope_per_day, *self.drift.interval_90])
        what, most = " and ".join(map(parameter_words, self.stiffness)), max(abs(low), abs(high))
        over = f"{round(self.days_since_first[-1], 1):g} days"
        if not self.drift.detected and most > _BLIND:
            return f"Too early to estimate a drift of {what}: {over} would not reveal even a doubling a day."
        found = "No drift found" if not self.drift.detected else "Rising" if low > 0.0 else "Falling"
        change = "changes" if len(self.stiffness) == 1 else "change"
        said = (
            f"{found}: {what} {change} by {slope:+.2g} % a day, 90 % interval {low:+.2g} to {high:+.2g} %, "
            f"over {over}."
        )
        return (
            said
            if self.drift.detected
            else f"{said} A drift of more than {most:.2g} % a day would be detected."
        )


def _sudden(change: SuddenChange, dates: Sequence[str]) -> str:
    """Return the sentence on a sudden change, which lies after the last of the dates before it."""
    first, when, last = (f"{day_utc(x):%Y-%m-%d}" for x in change.days)
    before = max((d for d in dates if d < first), default=first)
    low, middle, high = (100.0 * (x - 1.0) for x in change.factor)
    verb = "fell" if middle < 0.0 else "rose"
    about = f"on {when}" if first == last else f"about {when} (between {first} and {last})"
    if (date.fromisoformat(first) - date.fromisoformat(before)).days > 1:  # nothing was estimated since
        about = f"between {before} and {last}"
    return f"The stiffness {verb} by {abs(middle):.2g} % {about}, 90 % interval {low:+.2g} to {high:+.2g} %."


def day_utc(day: float) -> datetime:
    """Return the UTC time of a number of days since 1970."""
    return datetime(1970, 1, 1, tzinfo=UTC) + timedelta(days=day)


def since_first(times: Sequence[datetime]) -> FloatArray:
    """Return times since the first [d], (n_times,)."""
    return np.array([(time - times[0]).total_seconds() / DAY_S for time in times])


FOLLOWED = StoredSchema("followed", Followed)
"""``followed.json``."""
STORED = "state"
"""Key of the state from which the next run continues."""


def follow_document(followed: Followed) -> dict[str, Any]:
    """Return the document of ``jackettwin follow``, with the state from which the next run continues."""
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
    """Return the estimate after each day."""
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
    """Return the smoothed stiffness of each day, its jumps and forecast, as ratios to the first day's."""
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
    """Read the result of an earlier run of ``jackettwin follow``.

    Raises
    ------
    InputError
        If ``jackettwin follow`` did not write the file.
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
