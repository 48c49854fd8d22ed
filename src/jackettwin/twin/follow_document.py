"""What a followed twin remembers from day to day, as one JSON document: written, shown and read again."""

from __future__ import annotations

import json
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import AwareDatetime, Field

from jackettwin.errors import InputError
from jackettwin.files import Schema, validate
from jackettwin.identification import ModalEstimate
from jackettwin.twin.followed import Day, Followed, RecordModes
from jackettwin.twin.measure import Sighting
from jackettwin.updating.drift import Drift
from jackettwin.version import __version__

Positive = Annotated[float, Field(gt=0.0)]


class ModeSchema(Schema):
    """``days[].records[].modes[]``: a mode of the model as one record shows it."""

    mode: Annotated[int, Field(ge=1)]
    frequency_hz: Positive
    damping_ratio: Positive
    log_covariance: tuple[tuple[float, float], tuple[float, float]] | None
    mac: float
    duration_s: Positive
    wind_speed_m_s: float | None

    def build(self) -> Sighting:
        """Return the sighting; its shape is not kept."""
        covariance = None if self.log_covariance is None else np.array(self.log_covariance)
        estimate = ModalEstimate(
            self.frequency_hz,
            self.damping_ratio,
            np.zeros(0, complex),
            1.0,
            0.0,
            1.0,
            log_covariance=covariance,
        )
        return Sighting(estimate, self.mac, self.duration_s, self.wind_speed_m_s)


class RecordSchema(Schema):
    """``days[].records[]``."""

    name: str
    time_utc: AwareDatetime
    modes: list[ModeSchema]


class ParameterSchema(Schema):
    """``days[].parameters``."""

    median: Positive
    interval_90: tuple[Positive, Positive]


class DaySchema(Schema):
    """``days[]``."""

    time_utc: datetime
    records: list[RecordSchema] = Field(min_length=1)
    parameters: dict[str, ParameterSchema]

    def build(self) -> Day:
        """Return the day."""
        records = tuple(
            RecordModes(r.name, r.time_utc, {m.mode: m.build() for m in r.modes}) for r in self.records
        )
        return Day(
            records,
            {name: p.median for name, p in self.parameters.items()},
            {name: p.interval_90 for name, p in self.parameters.items()},
        )


class FollowedSchema(Schema):
    """The document."""

    name: str
    law: str
    reference_frequency_hz: Positive
    wind_speed_m_s: float | None
    units: dict[str, str] = Field(min_length=1)
    days: list[DaySchema] = Field(min_length=1)
    drift: dict[str, Any] | None
    statement: str
    warnings: list[str]
    code_version: str


def follow_document(followed: Followed) -> dict[str, Any]:
    """Return the document of ``jackettwin follow``: what the next day starts from."""
    return {
        "name": followed.name,
        "law": followed.law,
        "reference_frequency_hz": followed.reference_hz,
        "wind_speed_m_s": followed.wind_m_s,
        "units": dict(followed.units),
        "days": [_day(day) for day in followed.days],
        "drift": None if followed.drift is None else _drift(followed, followed.drift),
        "statement": followed.statement,
        "warnings": list(followed.warnings),
        "code_version": __version__,
    }


def read_followed(path: Path) -> Followed:
    """Read what an earlier run of ``jackettwin follow`` left; its drift is fitted anew when it goes on.

    Raises
    ------
    InputError
        If the file is not what ``jackettwin follow`` writes.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError):
        raise InputError(
            "not a JSON document", file=path, remedy="give the followed.json of an earlier run"
        ) from None
    schema = validate(FollowedSchema, data, file=path)
    return Followed(
        name=schema.name,
        law=schema.law,
        reference_hz=schema.reference_frequency_hz,
        wind_m_s=schema.wind_speed_m_s,
        units=schema.units,
        days=tuple(day.build() for day in schema.days),
        drift=None,
        warnings=(),
    )


def _day(day: Day) -> dict[str, Any]:
    return {
        "time_utc": day.time_utc.isoformat(),
        "records": [
            {
                "name": record.name,
                "time_utc": record.time_utc.isoformat(),
                "modes": [_mode(mode, seen) for mode, seen in record.sightings.items()],
            }
            for record in day.records
        ],
        "parameters": {
            name: {"median": median, "interval_90": list(day.interval_90[name])}
            for name, median in day.median.items()
        },
    }


def _mode(mode: int, seen: Sighting) -> dict[str, Any]:
    e = seen.estimate
    return {
        "mode": mode,
        "frequency_hz": e.frequency_hz,
        "damping_ratio": e.damping_ratio,
        "log_covariance": None if e.log_covariance is None else e.log_covariance.tolist(),
        "mac": seen.mac,
        "duration_s": seen.duration_s,
        "wind_speed_m_s": seen.wind_m_s,
    }


def _drift(followed: Followed, drift: Drift) -> dict[str, Any]:
    return {
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
    }
