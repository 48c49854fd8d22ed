"""Waves with given kinematics at one place, over height and time, from another program or a measurement.

The kinematics travel along the waves' heading unchanged: those at x are those at the given place, delayed by
x/c.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.errors import InputError, located
from jackettwin.files import read_text
from jackettwin.loads.sea.given_waves import FIELD, Elevation, require_physical

_LONGEST = 5_000_000
"""Largest number of rows of a file; ten minutes at 10 Hz on a hundred levels have 600,000."""
_FASTEST_M_S2 = 200.0
"""Largest plausible value of velocity and acceleration (twenty times gravity); larger ones have another
unit."""
_HIGHEST_PA = 1e8
REQUIRED = (
    "time_s",
    "z_m",
    "elevation_m",
    "velocity_m_s",
    "vertical_velocity_m_s",
    "acceleration_m_s2",
    "vertical_acceleration_m_s2",
)
PRESSURE = "pressure_pa"


@dataclass(frozen=True, eq=False)
class Kinematics:
    """Kinematics of the water at one place.

    Attributes
    ----------
    elevation : Elevation
        Surface elevation at the n times.
    z_m : (m,) ascending heights from still water [m]
    velocity, acceleration : (n, m, 2) along the heading and up [m/s, m/s²]
    pressure_pa : (n, m) dynamic pressure, if it is given
    """

    elevation: Elevation
    z_m: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    pressure_pa: FloatArray | None = None

    def __post_init__(self) -> None:
        require_physical("velocity", self.velocity, _FASTEST_M_S2, "m/s")
        require_physical("acceleration", self.acceleration, _FASTEST_M_S2, "m/s²")
        if self.pressure_pa is not None:
            require_physical("pressure", self.pressure_pa, _HIGHEST_PA, "Pa")


@dataclass(frozen=True, eq=False)
class TravellingKinematics:
    """Waves (``Waves``) from kinematics at the origin, periodic with ``period`` [s].

    Attributes
    ----------
    celerity_m_s : speed at which the kinematics travel
    direction : heading from +x [rad]
    density_kg_m3 : density of the water, for its pressure
    """

    given: Kinematics
    period: float
    celerity_m_s: float
    direction: float
    density_kg_m3: float

    def elevation(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return η [m] above points (n, 2 or 3) at times (m,), shape (m, n)."""
        eta = self.given.elevation
        return np.asarray(np.interp(self._local(points, t), eta.time_s, eta.eta_m))

    def surface(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return the elevation, up to which the kinematics of the highest level apply."""
        return self.elevation(points, t)

    def motion(self, points: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return velocity and acceleration, each (m, n, 3), interpolated linearly over height and time."""
        local = self._local(points, t)
        heading = np.array([np.cos(self.direction), np.sin(self.direction)])
        both = []
        for field in (self.given.velocity, self.given.acceleration):
            along, up = (self._between(field[..., k], points[:, 2], local) for k in range(2))
            both.append(np.concatenate([along[..., None] * heading, up[..., None]], axis=-1))
        return both[0], both[1]

    def pressure(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return the dynamic pressure over the density [m²/s²], (m, n).

        Raises
        ------
        InputError
            If the file has no pressure.
        """
        if self.given.pressure_pa is None:
            raise InputError(
                "the pressure on the ends of members is not given",
                field=f"waves.{FIELD}",
                remedy=f"add the column {PRESSURE}, or leave water.ends.pressure out",
            )
        p = self._between(self.given.pressure_pa, points[:, 2], self._local(points, t))
        return p / self.density_kg_m3

    def _local(self, points: FloatArray, t: FloatArray) -> FloatArray:
        """Return the time at the given place of the kinematics at points, (m, n) [s] within the period."""
        along = points[:, 0] * np.cos(self.direction) + points[:, 1] * np.sin(self.direction)
        return np.asarray(np.mod(np.atleast_1d(t)[:, None] - along / self.celerity_m_s, self.period))

    def _between(self, field: FloatArray, z: FloatArray, local: FloatArray) -> FloatArray:
        """Return a field (n_times, n_heights) at heights (n,) and times (m, n); constant beyond the grid."""
        time, levels = self.given.elevation.time_s, self.given.z_m
        low = np.clip(np.searchsorted(levels, z) - 1, 0, levels.size - 2)
        share = np.clip((z - levels[low]) / (levels[low + 1] - levels[low]), 0.0, 1.0)
        at_height = (1.0 - share) * field[:, low] + share * field[:, low + 1]
        columns = [np.interp(local[:, i], time, at_height[:, i]) for i in range(z.size)]
        return np.stack(columns, axis=1)


def read_kinematics(path: Path) -> Kinematics:
    """Read a CSV with one row per time and height, and the same heights at every time.

    Raises
    ------
    InputError
        If columns are missing, values are not numbers, or the rows do not form a grid.
    """
    reader = csv.reader(read_text(path, what="file of wave kinematics").splitlines()[: _LONGEST + 1])
    header = [name.strip() for name in next(reader, [])]
    missing = [name for name in REQUIRED if name not in header]
    if missing:
        raise InputError(
            "columns are missing",
            file=path,
            field=FIELD,
            value=", ".join(missing),
            allowed=f"{', '.join(REQUIRED)}, and {PRESSURE} if ends are loaded",
            remedy="name the columns in the first line",
        )
    try:
        table = np.array([[float(cell) for cell in row] for row in reader if row])
    except ValueError as error:
        raise InputError("not a number", file=path, field=FIELD, value=str(error)) from None
    if table.ndim != 2 or table.shape[1] != len(header):
        raise InputError(
            "no rows, or rows of other lengths",
            file=path,
            field=FIELD,
            value=len(table),
            allowed=f"{len(header)} numbers a row",
        )
    with located(file=path):
        return _gridded({name: table[:, k] for k, name in enumerate(header)})


def _gridded(column: dict[str, FloatArray]) -> Kinematics:
    """Return the kinematics of columns whose rows are a grid in any order."""
    order = np.lexsort((column["z_m"], column["time_s"]))
    times, heights = np.unique(column["time_s"]), np.unique(column["z_m"])
    shape = (times.size, heights.size)
    grid = {name: values[order] for name, values in column.items()}
    whole = order.size == times.size * heights.size and heights.size > 1
    if not whole or np.any(grid["z_m"].reshape(shape) != heights):
        raise InputError(
            "rows do not form a grid of times and heights",
            field=FIELD,
            value=f"{order.size} rows, {times.size} times, {heights.size} heights",
            allowed="the same two or more heights at every time",
        )
    eta = grid["elevation_m"].reshape(shape)
    if np.ptp(eta, axis=1).max() > 1e-6:
        raise InputError("the elevation depends on the height", field=FIELD, value=float(np.ptp(eta)))
    velocity, acceleration = (
        np.stack([grid[name].reshape(shape) for name in pair], axis=-1)
        for pair in (REQUIRED[3:5], REQUIRED[5:7])
    )
    pressure = grid[PRESSURE].reshape(shape) if PRESSURE in grid else None
    return Kinematics(Elevation(times, eta[:, 0]), heights, velocity, acceleration, pressure)
