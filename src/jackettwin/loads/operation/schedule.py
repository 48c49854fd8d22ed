"""Rotor speed and pitch by wind speed, as a turbine's table gives them."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located, require

COLUMNS = ("wind_speed_m_s", "rotor_speed_rpm", "pitch_deg")
_RPM = np.pi / 30.0


class Schedule(NamedTuple):
    """Wind speed [m/s], rotor speed [rad/s] and pitch [rad], each (n,), the wind rising."""

    wind_speed: FloatArray
    rotor_speed: FloatArray
    pitch: FloatArray

    def at(self, wind_speed: float) -> tuple[float, float]:
        """Return rotor speed [rad/s] and pitch [rad], straight between the rows.

        Raises
        ------
        InputError
            If the table does not reach that wind.
        """
        low, high = float(self.wind_speed[0]), float(self.wind_speed[-1])
        require(
            low <= wind_speed <= high,
            "the schedule does not reach this wind",
            field="wind_speed_m_s",
            value=wind_speed,
            allowed=f"{low:g} to {high:g} m/s",
            remedy="add rows to the schedule, or take another wind",
        )
        return (
            float(np.interp(wind_speed, self.wind_speed, self.rotor_speed)),
            float(np.interp(wind_speed, self.wind_speed, self.pitch)),
        )


def read_schedule(path: Path) -> Schedule:
    """Return the schedule of a CSV file with the columns wind_speed_m_s, rotor_speed_rpm, pitch_deg.

    Raises
    ------
    InputError
        If the file is missing, lacks a column, or holds no numbers, falling winds or a rotor at rest.
    """
    with located(file=path):
        try:
            text = path.read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError("cannot be read", remedy="name a CSV file") from error
        rows = list(csv.DictReader(text.splitlines()))
        missing = [name for name in COLUMNS if not rows or name not in rows[0]]
        if missing:
            raise InputError(
                "no schedule", field=", ".join(missing), remedy=f"head the columns {','.join(COLUMNS)}"
            )
        wind, speed, pitch = (
            np.array([_number(row, k, name) for k, row in enumerate(rows)]) for name in COLUMNS
        )
        for name, values, good, allowed in (
            ("wind_speed_m_s", wind, np.all(np.diff(wind) > 0.0) and wind[0] > 0.0, "above 0, rising"),
            ("rotor_speed_rpm", speed, np.all((speed > 0.0) & (speed < 100.0)), "above 0, below 100"),
            ("pitch_deg", pitch, np.all(np.abs(pitch) <= 90.0), "−90 to 90"),
        ):
            require(bool(good), "out of range", field=name, value=values.tolist(), allowed=allowed)
    return Schedule(wind, _RPM * speed, np.radians(pitch))


def _number(row: dict[str, str | None], k: int, name: str) -> float:
    try:
        value = float(row[name] or "")
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError("no number", field=f"{name}, row {k + 1}", value=row[name], allowed="a number")
    return value
