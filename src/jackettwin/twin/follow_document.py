"""What a followed twin remembers from day to day, as one JSON document: written, shown and read again."""

from __future__ import annotations

import json
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import AwareDatetime, Field

from jackettwin.errors import InputError
from jackettwin.files import Schema, validate
from jackettwin.identification import ModalEstimate
from jackettwin.response.sensors import Sensor
from jackettwin.twin.config import GivenRelaxation
from jackettwin.twin.followed import Day, Followed, RecordModes
from jackettwin.twin.measure import Sighting
from jackettwin.updating.drift import Drift
from jackettwin.version import __version__

Positive = Annotated[float, Field(gt=0.0)]
ShapeSchema = dict[str, tuple[float, float]]
"""A shape, {channel: (re, im)}."""


class ModeSchema(Schema):
    """``days[].records[].modes[]``: a mode of the model as one record shows it."""

    mode: Annotated[int, Field(ge=1)]
    frequency_hz: Positive
    damping_ratio: Positive
    log_covariance: tuple[tuple[float, float], tuple[float, float]] | None
    mac: float
    duration_s: Positive
    wind_speed_m_s: float | None
    mode_shape: ShapeSchema = {}

    def build(self) -> Sighting:
        """Return the sighting."""
        covariance = None if self.log_covariance is None else np.array(self.log_covariance)
        estimate = ModalEstimate(
            self.frequency_hz,
            self.damping_ratio,
            np.array([complex(*value) for value in self.mode_shape.values()], complex),
            1.0,
            0.0,
            1.0,
            log_covariance=covariance,
        )
        return Sighting(estimate, self.mac, self.duration_s, self.wind_speed_m_s, tuple(self.mode_shape))


class RealPoleSchema(Schema):
    """``days[].records[].real_poles[]``."""

    rate_rad_s: Positive
    rate_std_rad_s: Positive | None
    mode_shape: ShapeSchema = {}

    def build(self) -> GivenRelaxation:
        """Return the relaxation."""
        shape = {name: complex(*value) for name, value in self.mode_shape.items()}
        return GivenRelaxation(self.rate_rad_s, self.rate_std_rad_s, shape)


class SensorSchema(Schema):
    """``days[].records[].sensors[]``: where a channel sits, turned as the record was."""

    channel: str
    direction: tuple[float, float, float]
    node: str | None
    height_m: float | None

    def build(self) -> Sensor:
        """Return the sensor."""
        return Sensor(self.channel, self.direction, self.node, self.height_m)


class RecordSchema(Schema):
    """``days[].records[]``; runs before shapes were followed have no sensors."""

    name: str
    time_utc: AwareDatetime
    modes: list[ModeSchema]
    sensors: list[SensorSchema] = []
    real_poles: list[RealPoleSchema] = []

    def build(self) -> RecordModes:
        """Return what the record shows."""
        return RecordModes(
            self.name,
            self.time_utc,
            {mode.mode: mode.build() for mode in self.modes},
            tuple(sensor.build() for sensor in self.sensors),
            tuple(pole.build() for pole in self.real_poles),
        )


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
        return Day(
            tuple(record.build() for record in self.records),
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
                "sensors": [
                    {
                        "channel": s.channel,
                        "direction": list(s.direction),
                        "node": s.node,
                        "height_m": s.height_m,
                    }
                    for s in record.sensors
                ],
                "real_poles": [
                    {
                        "rate_rad_s": r.rate_rad_s,
                        "rate_std_rad_s": r.rate_std_rad_s,
                        "mode_shape": _shape(tuple(r.shape), r.shape.values()),
                    }
                    for r in record.relaxations
                ],
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
        "mode_shape": _shape(seen.channels, e.mode_shape.tolist()) if seen.channels else {},
    }


def _shape(channels: tuple[str, ...], values: Iterable[complex]) -> dict[str, list[float]]:
    return {name: [value.real, value.imag] for name, value in zip(channels, values, strict=True)}


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
