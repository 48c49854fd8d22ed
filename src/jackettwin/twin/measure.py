"""Records to measured modes that carry the model's numbers and labels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

from jackettwin.errors import located
from jackettwin.identification import Identification, ModalEstimate
from jackettwin.identification.many_records.fusion import average
from jackettwin.identification.many_records.sightings import sightings as columns
from jackettwin.records import Record, read_record
from jackettwin.response.sensors import Sensor
from jackettwin.structure import Assembly
from jackettwin.twin.config import GivenRelaxation, TwinConfig
from jackettwin.twin.examine import Examination
from jackettwin.twin.many import Failed, failure
from jackettwin.twin.model import TwinModel, twin_model
from jackettwin.twin.observe import examined, observed
from jackettwin.updating import Target
from jackettwin.updating.pairing import Held


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

    observations: tuple[Examination, ...]
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
    model = twin_model(config, assembly)
    records, examinations, failed = _examined(config, model, compare=compare, step=step)
    with located(file=config.path):
        feet = model.likest_feet(examinations)
        observations = [
            observed(record, seen, model, feet) for record, seen in zip(records, examinations, strict=True)
        ]
    sightings: dict[int, list[Sighting]] = {}
    for one in observations:
        names = tuple(c.name for c in one.identification.channels)
        for mode, (estimate, known) in one.modes.items():
            sighting = Sighting(estimate, known.mac, one.duration_s, one.wind_m_s, names)
            sightings.setdefault(mode, []).append(sighting)
    return Measured(
        tuple(examinations),
        observations[0].sensors,
        {mode: tuple(seen) for mode, seen in sorted(sightings.items())},
        tuple(tuple(None if r is None else r.mode for r in one.recognised) for one in observations),
        tuple(_relaxations(one.identification) for one in observations),
        tuple(
            f"{one.name}: {f}"
            for one in observations
            for f in one.findings
            if f.code == "sensor_against_model"
        ),
        failed,
        tuple(one.held for one in observations),
        inf if feet is None else feet.stiffness_n_m,
    )


def _examined(
    config: TwinConfig, model: TwinModel, *, compare: bool, step: Callable[[str], None]
) -> tuple[list[Record], list[Examination], tuple[Failed, ...]]:
    """Return what the records show, and those that show nothing; the error of the first if none does."""
    records: list[Record] = []
    examinations: list[Examination] = []
    failed: list[Failed] = []
    first: Exception | None = None
    for path in config.records:
        step(f"identify {path.name}")
        try:
            record = read_record(path, config.unsaid)
            with located(file=path):
                seen = examined(record, model, compare=compare and not examinations)
        except Exception as error:  # of many records, one that fails must not stop the others
            if not path.exists():
                raise
            first = first or error
            failed.append(failure(path, error))
        else:
            records.append(record)
            examinations.append(seen)
    if first is not None and not records:
        raise first
    return records, examinations, tuple(failed)


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


def fuse(mode: int, sightings: tuple[Sighting, ...]) -> Target:
    """Return one mode over records as a target, averaged as ``identification.fuse`` does."""
    mean = average(columns([s.estimate for s in sightings], [s.duration_s for s in sightings]))
    f, zeta = mean.frequency_hz, mean.damping_ratio
    return Target(mode, f, f * mean.log_std[0], zeta, zeta * mean.log_std[1], mean.correlation)
