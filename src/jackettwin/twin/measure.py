"""Records to measured modes that carry the model's numbers and labels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from jackettwin.errors import InputError, did_you_mean, located
from jackettwin.identification import Identification, ModalEstimate, identify
from jackettwin.records import Record, read_record
from jackettwin.response.modal import UndampedModes
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure import Assembly
from jackettwin.twin.config import TwinConfig
from jackettwin.updating.pairing import pair

FloatArray = npt.NDArray[np.float64]

_MOTION = ("acceleration", "velocity", "displacement")


@dataclass(frozen=True)
class Sighting:
    """A model mode seen in one record."""

    estimate: ModalEstimate
    mac: float
    duration_s: float


@dataclass(frozen=True)
class Measured:
    """What the records say.

    Attributes
    ----------
    record : Record
        The first one.
    sensors : tuple of Sensor
    identifications : one a record
    sightings : {mode number from 1: its sightings, one a record at most}
    unpaired : identified modes without a counterpart in the model
    """

    record: Record
    sensors: tuple[Sensor, ...]
    identifications: tuple[Identification, ...]
    sightings: dict[int, tuple[Sighting, ...]]
    unpaired: tuple[ModalEstimate, ...]


def measure(
    config: TwinConfig,
    assembly: Assembly,
    numbered: UndampedModes,
    *,
    step: Callable[[str], None],
) -> Measured:
    """Return the measured modes of every record of a twin, paired with the numbered modes of its model.

    Raises
    ------
    InputError
        If a record cannot be read or identified, or a sensor and a channel disagree; names file and field.
    """
    records, identifications, sensors = [], [], config.sensors
    for path in config.records:
        step(f"identify {path.name}")
        record = _usable(read_record(path), config.sensors, path)
        with located(file=path):
            identifications.append(identify(record, config.identification))
        records.append(record)
        sensors = sensors or _sensors_of(record)
    sightings: dict[int, list[Sighting]] = {}
    unpaired: list[ModalEstimate] = []
    for found, record in zip(identifications, records, strict=True):
        by_channel = {s.channel: s for s in (config.sensors or _sensors_of(record))}
        seen_by = tuple(by_channel[c.name] for c in found.channels)
        shapes = observation_matrix(assembly, seen_by) @ numbered.shapes
        pairs = pair(found.modes, numbered.frequency_hz, shapes)
        for mode, (index, likeness) in pairs.items():
            sightings.setdefault(mode + 1, []).append(
                Sighting(found.modes[index], likeness, found.duration_s)
            )
        used = {index for index, _ in pairs.values()}
        unpaired += [e for i, e in enumerate(found.modes) if i not in used]
    return Measured(
        records[0],
        sensors,
        tuple(identifications),
        {mode: tuple(seen) for mode, seen in sorted(sightings.items())},
        tuple(unpaired),
    )


def fuse(sightings: tuple[Sighting, ...]) -> tuple[float, float, float, float]:
    """Return (f, std f, ζ, std ζ) over records: precision-weighted logarithms with between-record scatter.

    The scatter is DerSimonian and Laird's (1986) moment estimate; a record without a standard deviation takes
    Au's long-data limits, CoV f = √(ζ/2πfT) and CoV ζ = 1/√(2πζfT).
    """
    f = np.array([s.estimate.frequency_hz for s in sightings])
    zeta = np.array([s.estimate.damping_ratio for s in sightings])
    T = np.array([s.duration_s for s in sightings])
    limit_f, limit_zeta = np.sqrt(zeta / (2 * np.pi * f * T)), 1.0 / np.sqrt(2 * np.pi * zeta * f * T)
    known_f = [s.estimate.frequency_std_hz for s in sightings]
    known_zeta = [s.estimate.damping_ratio_std for s in sightings]
    cov_f = np.array(
        [limit if std is None else std / v for std, v, limit in zip(known_f, f, limit_f, strict=True)]
    )
    cov_zeta = np.array(
        [
            limit if std is None else std / v
            for std, v, limit in zip(known_zeta, zeta, limit_zeta, strict=True)
        ]
    )
    mean_f, std_f = _pooled(np.log(f), cov_f)
    mean_zeta, std_zeta = _pooled(np.log(zeta), cov_zeta)
    F, Z = float(np.exp(mean_f)), float(np.exp(mean_zeta))
    return F, F * std_f, Z, Z * std_zeta


def _pooled(values: FloatArray, std: FloatArray) -> tuple[float, float]:
    """Return mean and standard deviation of the mean under a random-effects model."""
    w = std**-2.0
    mean = float(w @ values / w.sum())
    if values.size > 1:
        excess = w @ (values - mean) ** 2 - (values.size - 1)
        scatter = max(0.0, float(excess / (w.sum() - w @ w / w.sum())))
        w = 1.0 / (std**2 + scatter)
        mean = float(w @ values / w.sum())
    return mean, float(w.sum() ** -0.5)


def _usable(record: Record, sensors: tuple[Sensor, ...], path: Path) -> Record:
    """Return the record with the channels that sensors name, or all that measure motion."""
    if not sensors:
        names = [c.name for c in record.channels if c.quantity in _MOTION]
        if not names:
            raise InputError(
                "no channel measures motion",
                file=path,
                field="channels",
                value=record.channel_names,
                allowed=", ".join(_MOTION),
                remedy="name the quantity of each channel, or list sensors in the twin file",
            )
        return record.select(names)
    for sensor in sensors:
        if sensor.channel not in record.channel_names:
            raise InputError(
                f"sensor's channel is not in the record {path.name}",
                field=f"sensors.{sensor.channel}.channel",
                value=sensor.channel,
                allowed=", ".join(record.channel_names),
                remedy=did_you_mean(sensor.channel, record.channel_names),
            )
    return record.select([s.channel for s in sensors])


def _sensors_of(record: Record) -> tuple[Sensor, ...]:
    return tuple(Sensor(c.name, c.direction, c.node, None if c.node else c.height_m) for c in record.channels)
