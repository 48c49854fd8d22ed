"""Measured data of an update: modes paired with those of the model, and relaxations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from jackettwin.arrays import ComplexArray
from jackettwin.identification import ModalEstimate
from jackettwin.response import Sensor
from jackettwin.twin import Observation


@dataclass(frozen=True)
class MeasuredMode:
    """A measured mode paired with a mode of the model.

    Attributes
    ----------
    mode : int
        Number on pinned supports, from 1.
    label : str
        ``fore_aft_1``, ``side_side_2``, ``torsion_1`` …
    estimate : ModalEstimate or None
        The identified mode; None if the value was given as a target.
    mac : float or None
        Between the measured shape and the model's at the sensors.
    fits_frequency, fits_damping : bool
        Whether the value was fitted in the update.
    correlation : float
        Correlation of the logarithms of frequency and damping ratio.
    """

    mode: int
    label: str
    frequency_hz: float | None
    frequency_std_hz: float | None
    damping_ratio: float | None
    damping_ratio_std: float | None
    estimate: ModalEstimate | None
    mac: float | None
    fits_frequency: bool
    fits_damping: bool
    correlation: float = 0.0


@dataclass(frozen=True)
class MeasuredRelaxation:
    """A measured real pole, exp(−at).

    Attributes
    ----------
    name : str
        ``a1``, ``a2``, … by rate.
    rate_rad_s : float
    rate_std_rad_s : float or None
    channels : where its shape is known
    shape : (n_channels,) complex, empty if it is not known
    records : int
        Number of records in which it was found; 0 if it was given as a target.
    """

    name: str
    rate_rad_s: float
    rate_std_rad_s: float | None
    channels: tuple[str, ...]
    shape: ComplexArray
    records: int


def sensors_of(
    m: MeasuredMode, observations: Sequence[Observation]
) -> tuple[tuple[Sensor, ...], list[int]] | None:
    """Return the sensors that a mode's shape was seen at, and their rows in it; None without a record."""
    for one in observations:
        estimate, _ = one.modes.get(m.mode, (None, None))
        if estimate is not None and estimate is m.estimate:
            order = {c.name: i for i, c in enumerate(one.identification.channels)}
            sensors = tuple(sensor for sensor in one.sensors if sensor.channel in order)
            return (sensors, [order[sensor.channel] for sensor in sensors]) if sensors else None
    return None
