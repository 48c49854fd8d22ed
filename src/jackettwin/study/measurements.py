"""Measured data of an update: modes paired with those of the model, and relaxations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from jackettwin.arrays import ComplexArray
from jackettwin.identification import ModalEstimate
from jackettwin.response import Sensor
from jackettwin.twin import Observation

_TWO_MODES = {"perhaps_two", "hidden_mode"}
"""Findings of a record on a second mode beside one that it has."""
_SAME = 0.01
"""Relative difference of frequencies within which a finding is of a mode; or its bandwidth, if wider."""


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
    one = _record_of(m, observations)
    if one is None:
        return None
    order = {c.name: i for i, c in enumerate(one.identification.channels)}
    sensors = tuple(sensor for sensor in one.sensors if sensor.channel in order)
    return (sensors, [order[sensor.channel] for sensor in sensors]) if sensors else None


def may_be_two(m: MeasuredMode, observations: Sequence[Observation]) -> bool:
    """Tell whether the record of a mode's shape says that it may be a mixture of two modes.

    Such a shape is no mode's of the model, so that it says nothing about it.
    """
    one, e = _record_of(m, observations), m.estimate
    if one is None or e is None:
        return False
    near = (
        float(f.params["frequency_hz"]) / e.frequency_hz - 1.0  # type: ignore[arg-type]
        for f in one.identification.findings
        if f.code in _TWO_MODES
    )
    return any(abs(off) <= max(2.0 * e.damping_ratio, _SAME) for off in near)


def _record_of(m: MeasuredMode, observations: Sequence[Observation]) -> Observation | None:
    """Return the record that a mode's shape was seen in; None if it was in none."""
    for one in observations:
        estimate, _ = one.modes.get(m.mode, (None, None))
        if estimate is not None and estimate is m.estimate:
            return one
    return None
