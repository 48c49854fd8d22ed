"""Calibration of a sensor during a period: its gain, sign, position and direction."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from jackettwin.findings import Finding
from jackettwin.records import Record
from jackettwin.response import Sensor


@dataclass(frozen=True)
class Calibration:
    """Calibration of a sensor from one time to another.

    Attributes
    ----------
    sensor : Sensor
        The sensor's position and direction in this period.
    factor : float
        Factor on the logger's samples: gain and sign.
    from_utc, to_utc : datetime or None
        Time zone aware; applies to records that begin at or after the first and before the second. None means
        no limit.
    """

    sensor: Sensor
    factor: float = 1.0
    from_utc: datetime | None = None
    to_utc: datetime | None = None

    def holds_at(self, time: datetime | None) -> bool:
        """Return whether it applies at a time; without a start, only a calibration without limits does."""
        if time is None:
            return self.from_utc is None and self.to_utc is None
        started = self.from_utc is None or self.from_utc <= time
        return started and (self.to_utc is None or time < self.to_utc)


Calibrations = tuple[Calibration, ...]


def holding(calibrations: Iterable[Calibration], time: datetime | None) -> dict[str, Calibration]:
    """Return the calibration of each channel at a time, {channel: calibration}."""
    return {c.sensor.channel: c for c in calibrations if c.holds_at(time)}


def calibrated(record: Record, calibrations: Calibrations) -> Record:
    """Return a record with samples corrected by the calibrations of its sensors at its start."""
    held = holding(calibrations, record.start_utc)
    factors = np.array([held[c].factor if c in held else 1.0 for c in record.channel_names])
    if np.all(factors == 1.0):
        return record
    return replace(record, data=record.data * factors[:, None])


def sensors_at(
    sensors: tuple[Sensor, ...], calibrations: Calibrations, time: datetime | None
) -> tuple[Sensor, ...]:
    """Return the sensors with their positions and directions at a time."""
    held = holding(calibrations, time)
    return tuple(held[s.channel].sensor if s.channel in held else s for s in sensors)


def uncalibrated(calibrations: Calibrations, time: datetime | None) -> tuple[Finding, ...]:
    """Return findings on the sensors with calibrations of which none applies at a time."""
    held = holding(calibrations, time)
    channels = dict.fromkeys(c.sensor.channel for c in calibrations)
    return tuple(Finding("sensor_uncalibrated", channel) for channel in channels if channel not in held)
