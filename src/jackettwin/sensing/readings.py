"""Readings of a record at places of a structure, evenly sampled and without gaps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, radians
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray, IntArray
from jackettwin.constants import GRAVITY_M_S2
from jackettwin.errors import require
from jackettwin.loads import Coefficients
from jackettwin.quantities import VIBRATIONS
from jackettwin.records import Record, decimate
from jackettwin.response import Sensor, observation_matrix
from jackettwin.sensing.rotor_by_wind import RotorAtTop, RotorByWind
from jackettwin.sensing.wind_forces import USUAL_RADIUS_M
from jackettwin.structure import Assembly

ACCELERATION = 2
_DERIVATIVE = {"acceleration": ACCELERATION, "velocity": 1}
_MOST_MISSING = 0.02
RATE_HZ = 10.0
"""At which motion is followed: of ranges at 1 Hz a sixtieth is lost in the mean."""
_CALM_M = 0.02
"""Significant height of a sea that is said to be without waves."""


@dataclass(frozen=True)
class SensorReadings:
    """Readings of sensors, and the motion of a structure that they measure.

    Attributes
    ----------
    y : (n_channels, n_samples), means removed
    step_s : float
    rows : (n_channels, n_dof) what each sees of a displacement
    tilt : (n_channels, n_dof) what it sees beside of a displacement itself: gravity, as it leans
    derivative : (n_channels,) of the displacement that it measures: 0, 1 or 2
    groups : (n_channels,) channels of one quantity share one noise
    """

    y: FloatArray
    step_s: float
    rows: FloatArray
    tilt: FloatArray
    derivative: tuple[int, ...]
    groups: tuple[int, ...]


@dataclass(frozen=True)
class Weather:
    """Wind and sea of a record, as far as they are known: None is not.

    Attributes
    ----------
    wind_m_s : mean at the hub
    wave_height_m, wave_period_s : significant height and peak period
    wave_direction_rad : towards which waves run, anticlockwise from x seen from above
    depth_m : of the water; None takes the structure's lowest node for the bed
    coefficients : drag, added mass and growth of the members; None are those of bare ones
    working : whether the rotor turns and produces
    heading_rad : towards which its wind blows, anticlockwise from x seen from above
    rotor : what it does at the tower top in this wind; None is a usual rotor
    hub, radius_m : of the rotor, from the tower top (3,) and its blades' length
    """

    wind_m_s: float | None = None
    wave_height_m: float | None = None
    wave_period_s: float | None = None
    wave_direction_rad: float = 0.0
    depth_m: float | None = None
    coefficients: Coefficients | None = None
    working: bool = False
    heading_rad: float = 0.0
    rotor: RotorAtTop | None = None
    hub: tuple[float, float, float] = (0.0, 0.0, 0.0)
    radius_m: float = USUAL_RADIUS_M

    @classmethod
    def of(
        cls,
        conditions: Mapping[str, Any],
        depth_m: float | None = None,
        coefficients: Coefficients | None = None,
        rotor: RotorByWind | None = None,
    ) -> Weather:
        """Return the wind and sea that a record's conditions state, and what a known rotor does in them."""

        def number(name: str) -> float | None:
            value = conditions.get(name)
            return float(value) if isinstance(value, (int, float)) and value > 0.0 else None

        calm = conditions.get("wave_height_m") == 0.0 or conditions.get("waves") == "none"
        working, wind = conditions.get("state") == "operating", number("mean_wind_speed_m_s")
        direction, heading = (conditions.get(name) for name in ("wave_direction_deg", "yaw_deg"))
        return cls(
            wind,
            _CALM_M if calm else number("wave_height_m"),
            number("wave_period_s"),
            radians(float(direction)) if isinstance(direction, (int, float)) else 0.0,
            depth_m,
            coefficients,
            working,
            radians(float(heading)) if isinstance(heading, (int, float)) else 0.0,
            rotor.at(wind) if rotor is not None and working and wind is not None else None,
            (0.0, 0.0, 0.0) if rotor is None else rotor.hub,
            USUAL_RADIUS_M if rotor is None else rotor.rotor.radius,
        )


def readings_of(
    record: Record,
    sensors: tuple[Sensor, ...],
    assembly: Assembly,
    *,
    rate_hz: float = RATE_HZ,
    feel_gravity: bool = False,
) -> SensorReadings:
    """Return the vibrations of a record at a rate not far above ``rate_hz``.

    Parameters
    ----------
    sensors : where the record's channels sit, in their order
    feel_gravity : whether accelerometers pass constant acceleration, so that they read −g times their lean

    Raises
    ------
    InputError
        If no channel measures the structure's motion, a sensor has no place, or too much is missing.
    """
    wanted = [i for i, channel in enumerate(record.channels) if channel.quantity in VIBRATIONS]
    require(
        wanted,
        "no channel measures motion",
        file=record.name,
        field="channels",
        value=", ".join(record.channel_names),
        allowed=", ".join(VIBRATIONS),
        remedy="name the channels' quantities",
    )
    if record.sample_rate_hz >= 2.0 * rate_hz:
        step = int(record.sample_rate_hz / rate_hz + 1e-9)
        record = decimate(record, sample_rate_hz=record.sample_rate_hz / step)
    data, quantities = record.data[wanted], [record.channels[i].quantity for i in wanted]
    missing = np.isnan(data).mean(axis=1)
    require(
        missing.max() <= _MOST_MISSING,
        "too many samples are missing to follow the motion",
        file=record.name,
        field="channels",
        value=record.channels[wanted[int(missing.argmax())]].name,
        allowed=f"up to {100 * _MOST_MISSING:g} % missing",
        remedy="leave the channel out, or cut the record where it is whole",
    )
    at = tuple(sensors[i] for i in wanted)
    kinds = list(dict.fromkeys(quantities))
    feel = [feel_gravity and quantity == "acceleration" for quantity in quantities]
    return SensorReadings(
        np.array([_centred(row) for row in data]),
        1.0 / record.sample_rate_hz,
        observation_matrix(assembly, at).toarray(),
        np.array(
            [_lean(assembly, s) if f else np.zeros(assembly.n_dof) for s, f in zip(at, feel, strict=True)]
        ),
        tuple(_DERIVATIVE.get(quantity, 0) for quantity in quantities),
        tuple(kinds.index(quantity) for quantity in quantities),
    )


def _centred(row: FloatArray) -> FloatArray:
    """Return a series less its mean, short gaps bridged by straight lines."""
    known = np.isfinite(row)
    t = np.arange(row.size)
    return np.asarray(np.interp(t, t[known], row[known]) - row[known].mean())


def _lean(assembly: Assembly, sensor: Sensor) -> FloatArray:
    """Return −g times the lean of an accelerometer towards where it points, (n_dof,)."""
    x, y, _ = sensor.direction
    flat = float(np.hypot(x, y))
    if flat == 0.0:
        return np.zeros(assembly.n_dof)
    inclined = Sensor(
        sensor.channel,
        (x, y, 0.0),
        sensor.node,
        sensor.height_m,
        sensor.member,
        sensor.position,
        "inclination",
    )
    share = flat / float(np.linalg.norm(sensor.direction))
    return np.asarray(-GRAVITY_M_S2 * share * observation_matrix(assembly, (inclined,)).toarray()[0])


def thinned(n_samples: int, step_s: float, below_hz: float) -> IntArray:
    """Return which of the FFT's frequencies tell levels: all of the slow ones, every few of the others."""
    f = np.fft.rfftfreq(n_samples, step_s)
    slow = int(np.searchsorted(f, 0.3))
    stride = max(1, ceil((np.searchsorted(f, below_hz) - slow) / 250))
    return np.concatenate([np.arange(1, slow), np.arange(slow, int(np.searchsorted(f, below_hz)), stride)])
