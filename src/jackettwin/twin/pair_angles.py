"""Direction of the lower mode of a bending pair, which changes if one side of a jacket is weakened."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.identification import ModalEstimate
from jackettwin.response import Sensor, principal_direction
from jackettwin.twin.observation import Observation

MOST_STD_RAD = float(np.radians(20.0))
"""Largest standard deviation of a usable direction; a uniformly distributed one has 52°."""
_LEVEL = 0.1
"""Vertical component of a sensor's direction from which it does not count as horizontal."""

Stations = list[tuple[list[int], FloatArray]]


def pair_angles(seen: Observation) -> dict[str, tuple[float, float]]:
    """Return the lower mode's direction and standard deviation [rad], from x towards y, by its label.

    The axes are those of the record's identification: the rotor's, if its yaw is known. A pair is omitted if
    its frequencies differ by less than their uncertainty, which leaves the direction undefined, or if no
    position has two horizontal sensors.
    """
    sensors = {sensor.channel: sensor for sensor in seen.sensors}
    places = stations([sensors.get(channel.name) for channel in seen.identification.channels])
    modes = seen.named_modes
    found = {}
    for label in modes if places else ():
        partner = label.replace("fore_aft_", "side_side_")
        if partner == label or partner not in modes:
            continue
        lower, upper = sorted((label, partner), key=lambda name: modes[name].frequency_hz)
        angle, std = _direction(modes[lower], modes[upper], places)
        if std < MOST_STD_RAD:
            found[lower] = angle, std
    return found


def stations(sensors: Sequence[Sensor | None]) -> Stations:
    """Return positions with sensors in two horizontal directions: their channels and directions (n, 2).

    Parameters
    ----------
    sensors : of each channel; None without a position
    """
    places: dict[object, list[tuple[int, FloatArray]]] = {}
    for row, sensor in enumerate(sensors):
        if sensor is None or sensor.quantity != "motion":
            continue
        along = np.array(sensor.direction) / np.linalg.norm(sensor.direction)
        if abs(along[2]) < _LEVEL:
            where = sensor.node, sensor.height_m, sensor.member, sensor.position
            places.setdefault(where, []).append((row, along[:2]))
    both = [([row for row, _ in at], np.array([along for _, along in at])) for at in places.values()]
    return [(rows, along) for rows, along in both if np.linalg.matrix_rank(along, tol=0.5) == 2]


def _direction(lower: ModalEstimate, upper: ModalEstimate, places: Stations) -> tuple[float, float]:
    """Return the direction of the lower mode [rad] and its standard deviation.

    To first order, a perturbation mixes two modes by its ratio to the difference of their frequencies; here
    the perturbation is the uncertainty of the identification. The shape's uncertainty is added.
    """
    if lower.frequency_std_hz is None or upper.frequency_std_hz is None:
        return 0.0, np.inf
    aligned = lower.mode_shape_unaligned is None
    shape = lower.mode_shape if aligned else lower.mode_shape_unaligned
    moved = [np.linalg.lstsq(along, shape[rows], rcond=None)[0] for rows, along in places]  # type: ignore[index]
    angle, square = principal_direction(np.array(moved))
    own = 0.0
    if lower.mode_shape_std is not None:
        unsure = np.array([np.mean(lower.mode_shape_std[rows] ** 2) for rows, _ in places])
        own = float(np.sum(np.sum(np.abs(moved) ** 2, axis=1) * unsure)) / square**2
    apart = upper.frequency_hz - lower.frequency_hz
    mixed = np.hypot(lower.frequency_std_hz, upper.frequency_std_hz) / max(apart, 1e-12)
    return angle, float(np.sqrt(mixed**2 + own))
