"""Records to measured modes that carry the model's numbers and labels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf

import scipy.sparse as sp

from jackettwin.errors import located
from jackettwin.identification import Identification, ModalEstimate
from jackettwin.identification.many_records.fusion import average
from jackettwin.identification.many_records.sightings import sightings as columns
from jackettwin.records import Record
from jackettwin.response.modal import UndampedModes
from jackettwin.response.sensors import Sensor, observation_matrix
from jackettwin.structure import Assembly
from jackettwin.twin.config import GivenRelaxation, TwinConfig
from jackettwin.twin.many import Failed, failure
from jackettwin.twin.observe import Observation, observe
from jackettwin.twin.sensor_polarity import sensor_polarity
from jackettwin.updating import Target
from jackettwin.updating.pairing import Held, held_against, likeness, pair
from jackettwin.updating.softer_feet import Feet, softer_feet


@dataclass(frozen=True)
class Sighting:
    """A model mode seen in one record; ``channels`` are those of its shape."""

    estimate: ModalEstimate
    mac: float
    duration_s: float
    wind_m_s: float | None = None
    channels: tuple[str, ...] = ()


@dataclass(frozen=True)
class Measured:
    """What the records say.

    Attributes
    ----------
    observations : one a record
    sensors : tuple of Sensor
    sightings : {mode number from 1: its sightings, one a record at most}
    numbers : for each record, the mode number of each identified mode; None if the model lacks it
    relaxations : for each record, the real poles it shows
    turned : what the model's shapes say against the signs of sensors
    failed : records that could not be identified, and why; the others go on without them
    held : for each record, what each identified mode was held against in the model
    feet_stiffness_n_m : of the model's feet on which it is most like the measured modes; inf: as numbered
    """

    observations: tuple[Observation, ...]
    sensors: tuple[Sensor, ...]
    sightings: dict[int, tuple[Sighting, ...]]
    numbers: tuple[tuple[int | None, ...], ...]
    relaxations: tuple[tuple[GivenRelaxation, ...], ...] = ()
    turned: tuple[str, ...] = ()
    failed: tuple[Failed, ...] = ()
    held: tuple[tuple[Held, ...], ...] = ()
    feet_stiffness_n_m: float = inf

    def of_record(self, i: int) -> dict[int, Sighting]:
        """Return the modes seen in one record, {mode number: sighting}."""
        own = {id(mode) for mode in self.observations[i].identification.modes}
        return {m: s for m, seen in self.sightings.items() for s in seen if id(s.estimate) in own}


def measure(
    config: TwinConfig,
    assembly: Assembly,
    numbered: UndampedModes,
    *,
    compare: bool = False,
    step: Callable[[str], None],
) -> Measured:
    """Return the measured modes of every record of a twin, paired with the numbered modes of its model.

    Raises
    ------
    InputError
        If no record can be read and identified, or a sensor and a channel disagree; names file and field.
    """
    observations, failed = _observed(config, compare=compare, step=step)
    seeing = [_seeing(config, assembly, seen) for seen in observations]
    feet = _likest(observations, seeing, softer_feet(assembly, numbered))
    sightings: dict[int, list[Sighting]] = {}
    numbers, held = [], []
    turned: list[str] = []
    for seen, at_sensors in zip(observations, seeing, strict=True):
        found, names = seen.identification, tuple(c.name for c in seen.identification.channels)
        shapes = at_sensors @ feet.shapes
        pairs = pair(found.modes, feet.frequency_hz, shapes)
        held.append(held_against(found.modes, feet.frequency_hz, shapes))
        for mode, (index, subspace_mac) in pairs.items():
            sightings.setdefault(mode + 1, []).append(
                Sighting(found.modes[index], subspace_mac, found.duration_s, _wind(seen.record), names)
            )
        turned += [
            f"{seen.record.name}: {one.described(names)}"
            for one in sensor_polarity(found.modes, feet.frequency_hz, shapes)
        ]
        number_of = {index: mode + 1 for mode, (index, _) in pairs.items()}
        numbers.append(tuple(number_of.get(i) for i in range(len(found.modes))))
    return Measured(
        tuple(observations),
        placed_sensors(config, observations[0].record),
        {mode: tuple(seen) for mode, seen in sorted(sightings.items())},
        tuple(numbers),
        tuple(_relaxations(seen.identification) for seen in observations),
        tuple(turned),
        failed,
        tuple(held),
        feet.stiffness_n_m,
    )


def _seeing(config: TwinConfig, assembly: Assembly, seen: Observation) -> sp.csr_array:
    """Return what the identified channels of a record see of every motion, (n_channels, n_dof)."""
    by_channel = {s.channel: s for s in placed_sensors(config, seen.record)}
    with located(file=config.path):
        return observation_matrix(assembly, tuple(by_channel[c.name] for c in seen.identification.channels))


def _likest(
    observations: Sequence[Observation], seeing: Sequence[sp.csr_array], path: Sequence[Feet]
) -> Feet:
    """Return the feet on which the model is most like what all records show; the stiffest of equals."""
    return max(
        path,
        key=lambda feet: sum(
            likeness(seen.identification.modes, feet.frequency_hz, at_sensors @ feet.shapes)
            for seen, at_sensors in zip(observations, seeing, strict=True)
        ),
    )


def _observed(
    config: TwinConfig, *, compare: bool, step: Callable[[str], None]
) -> tuple[list[Observation], tuple[Failed, ...]]:
    """Return what the records show, and those that show nothing; the error of the first if none does."""
    observations: list[Observation] = []
    failed: list[Failed] = []
    first: Exception | None = None
    for path in config.records:
        step(f"identify {path.name}")
        try:
            seen = observe(
                path,
                config.identification,
                sensors=config.sensors,
                picks=config.picks,
                compare=compare and not observations,
            )
        except Exception as error:  # of many records, one that fails must not stop the others
            if not path.exists():
                raise
            first = first or error
            failed.append(failure(path, error))
        else:
            observations.append(seen)
    if first is not None and not observations:
        raise first
    return observations, tuple(failed)


def _relaxations(found: Identification) -> tuple[GivenRelaxation, ...]:
    names = [channel.name for channel in found.channels]
    return tuple(
        GivenRelaxation(
            pole.rate_rad_s,
            pole.rate_std_rad_s,
            dict(zip(names, map(complex, pole.mode_shape), strict=True)),
        )
        for pole in found.real_poles
    )


def _wind(record: Record) -> float | None:
    value = record.conditions.get("mean_wind_speed_m_s")
    return None if value is None else float(value)


def fuse(mode: int, sightings: tuple[Sighting, ...]) -> Target:
    """Return one mode over records as a target, averaged as ``identification.fuse`` does."""
    mean = average(columns([s.estimate for s in sightings], [s.duration_s for s in sightings]))
    f, zeta = mean.frequency_hz, mean.damping_ratio
    return Target(mode, f, f * mean.log_std[0], zeta, zeta * mean.log_std[1], mean.correlation)


def placed_sensors(config: TwinConfig, record: Record) -> tuple[Sensor, ...]:
    """Return the sensors behind the channels; they point as the record's channels do once turned."""
    given = {s.channel: s for s in config.sensors}
    return tuple(
        replace(given[c.name], direction=c.direction)
        if given
        else Sensor(c.name, c.direction, c.node, None if c.node else c.height_m)
        for c in record.channels
    )
