"""What held of a sensor for a while: its gain and sign, and where it sat."""

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
    """A sensor from one time to another.

    Attributes
    ----------
    sensor : Sensor
        Where it sat, and which way it pointed.
    factor : float
        What the logger's samples are multiplied by: gain and sign.
    from_utc, to_utc : datetime or None
        Time zone aware; records that begin from the first on and before the second. None is for ever.
    """

    sensor: Sensor
    factor: float = 1.0
    from_utc: datetime | None = None
    to_utc: datetime | None = None

    def holds_at(self, time: datetime | None) -> bool:
        """Tell whether it holds at a time; of a record without a start, only what holds for ever does."""
        if time is None:
            return self.from_utc is None and self.to_utc is None
        started = self.from_utc is None or self.from_utc <= time
        return started and (self.to_utc is None or time < self.to_utc)


Calibrations = tuple[Calibration, ...]


def holding(calibrations: Iterable[Calibration], time: datetime | None) -> dict[str, Calibration]:
    """Return what holds of each channel at a time, {channel: calibration}."""
    return {c.sensor.channel: c for c in calibrations if c.holds_at(time)}


def calibrated(record: Record, calibrations: Calibrations) -> Record:
    """Return a record with its samples as its sensors' calibrations at its start correct them."""
    held = holding(calibrations, record.start_utc)
    factors = np.array([held[c].factor if c in held else 1.0 for c in record.channel_names])
    if np.all(factors == 1.0):
        return record
    return replace(record, data=record.data * factors[:, None])


def sensors_at(
    sensors: tuple[Sensor, ...], calibrations: Calibrations, time: datetime | None
) -> tuple[Sensor, ...]:
    """Return where the sensors sat at a time."""
    held = holding(calibrations, time)
    return tuple(held[s.channel].sensor if s.channel in held else s for s in sensors)


def uncalibrated(calibrations: Calibrations, time: datetime | None) -> tuple[Finding, ...]:
    """Name the sensors that have a history of calibrations, but none that holds at a time."""
    held = holding(calibrations, time)
    channels = dict.fromkeys(c.sensor.channel for c in calibrations)
    return tuple(Finding("sensor_uncalibrated", channel) for channel in channels if channel not in held)
