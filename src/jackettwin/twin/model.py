"""Data of a twin for observing and advancing, made once from its file and the same in every process."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from jackettwin.arrays import FloatArray
from jackettwin.errors import located, require
from jackettwin.files import digest
from jackettwin.identification import Examination, IdentificationSettings, Pick
from jackettwin.records import Channel, Record
from jackettwin.response import Sensor, UndampedModes, mode_kinds, mode_labels, observation_matrix, sees
from jackettwin.structure import Assembly
from jackettwin.twin.calibration import Calibrations, sensors_at
from jackettwin.twin.config import PAIRED_MODES, TwinConfig, assembled, assembled_dry
from jackettwin.twin.life.likely_structures import StressModel
from jackettwin.twin.life.weld_map import RestingLoads
from jackettwin.twin.operation import OperationRule
from jackettwin.twin.rotor_at_work import rotor_by_wind
from jackettwin.twin.tolerances.registry import AT_WORK, TOLERANCES, directions, stiffer_at_work
from jackettwin.updating import Direction, Feet, modes_by_foot_stiffness, numbered_modes, pairing_score

_DECIMALS = 6
"""Decimals of a matrix that make its identity: processors differ by 1e-13 of a freedom's own stiffness."""


def _content(matrix: sp.csc_array) -> list[FloatArray]:
    r"""Return the diagonal and the scaled entries of a symmetric matrix, equal on every processor.

    An entry :math:`a_{ij}` is divided by :math:`\sqrt{a_{ii} a_{jj}}` and rounded; what is rounded to zero
    is not there.
    """
    whole = matrix.tocoo()
    diagonal = np.abs(matrix.diagonal())
    own = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    value = np.round(whole.data / (own[whole.row] * own[whole.col]), _DECIMALS)
    row, column, value = (part[value != 0.0] for part in (whole.row, whole.col, value))
    order = np.lexsort((row, column))
    digits = np.array([float(f"{v:.{_DECIMALS}e}") for v in diagonal])
    return [digits, value[order], row[order], column[order]]


@dataclass(frozen=True)
class TwinModel:
    """Model with which records are observed and to which a state belongs, without paths, records or laws.

    Attributes
    ----------
    name : str
    assembly : Assembly or None
        The structure whose modes are recognised; with None no mode is.
    numbered : UndampedModes or None
        Its modes on pinned feet.
    feet : tuple of Feet
        These modes on increasingly soft feet; measured modes are recognised on the most similar.
    labels : tuple of str
        Labels of the numbered modes.
    identification : IdentificationSettings
    sensors : tuple of Sensor
        The channels used and their positions; if empty, all that measure motion, as the record states.
    picks : tuple of Pick
        Poles to take instead of the automatic selection, for the records they name.
    by_wind : bool
        Whether the state separates wind speeds, to distinguish the rotor's damping from the ground's.
    with_shapes : bool
        Whether the state stores the best shapes, to fit them.
    calibrations : tuple of Calibration
        Calibrations of sensors, each for a period, which replace ``sensors``.
    operation : OperationRule
        Rule for the state of operation of a record, and whether it may update the supports.
    stress : StressModel or None
        Model of the damage at welds; None computes none.
    """

    name: str
    assembly: Assembly | None = None
    numbered: UndampedModes | None = None
    feet: tuple[Feet, ...] = ()
    labels: tuple[str, ...] = ()
    identification: IdentificationSettings = IdentificationSettings()
    sensors: tuple[Sensor, ...] = ()
    picks: tuple[Pick, ...] = ()
    by_wind: bool = False
    with_shapes: bool = False
    calibrations: Calibrations = ()
    operation: OperationRule = OperationRule()
    stress: StressModel | None = None

    def __repr__(self) -> str:
        modes = ", ".join(self.labels)
        return f"TwinModel({self.name!r}, {self.assembly!r}, {len(self.sensors)} sensors; modes {modes})"

    @cached_property
    def model_hash(self) -> str:
        """Identity of structure, sensors and contents of a state; only states of equal models are merged."""
        parts: dict[str, object] = {
            "sensors": self.sensors,
            "by_wind": self.by_wind,
            "with_shapes": self.with_shapes,
        }
        if self.calibrations:
            parts["calibrations"] = self.calibrations
        if self.operation.states:
            parts["operation"] = self.operation.states
        if self.stress is not None:
            parts["life"] = [self.stress.settings.curve, self.stress.settings.edition]
        if self.assembly is not None:
            for name in ("mass", "stiffness"):
                parts[name] = _content(getattr(self.assembly, name))
            parts["nodes"] = {
                name: list(map(float, at)) for name, at in self.assembly.structure.nodes.items()
            }
        return digest(parts)

    @cached_property
    def numbering(self) -> str:
        """Identity of the model's modes on all feet, by which measured modes are recognised."""
        return digest([self.labels, [[f.frequency_hz, f.shapes] for f in self.feet]])

    @property
    def structure(self) -> Assembly:
        """The assembled structure of a model that has one."""
        if self.assembly is None:
            raise ValueError("this model has no structure")
        return self.assembly

    @property
    def modes(self) -> UndampedModes:
        """The numbered modes of a model that has a structure."""
        if self.numbered is None:
            raise ValueError("this model has no structure")
        return self.numbered

    def settings_hash(self, record: str) -> str:
        """Identity of the settings and picks for the identification of a record of this name."""
        picks = [pick for pick in self.picks if pick.record in (None, record)]
        return digest([dict(self.identification), picks])

    def with_picks(self, picks: tuple[Pick, ...]) -> TwinModel:
        """Return the model with other manually chosen poles."""
        return replace(self, picks=picks)

    def directed(self, record: Record) -> Record:
        """Return a record whose channels sit and point as their sensors do at its start."""
        given = {s.channel: s for s in sensors_at(self.sensors, self.calibrations, record.start_utc)}

        def as_given(channel: Channel) -> Channel:
            sensor = given.get(channel.name)
            if sensor is None:
                return channel
            x, y, z = np.asarray(sensor.direction) / (np.linalg.norm(sensor.direction) or 1.0)
            along = float(x), float(y), float(z)
            return replace(channel, node=sensor.node, height_m=sensor.height_m, direction=along)

        return replace(record, channels=tuple(map(as_given, record.channels)))

    def felt(self, record: Record) -> Record:
        """Return a record without the channels that are no sensors, such as wind; all without sensors.

        Raises
        ------
        InputError
            If no channel is a sensor.
        """
        names = {sensor.channel for sensor in self.sensors}
        here = [name for name in record.channel_names if name in names]
        require(
            here or not names,
            "has none of the twin's sensors",
            file=record.name,
            field="channels",
            value=", ".join(record.channel_names),
            allowed=", ".join(sorted(names)),
            remedy="name the channels in the twin as in the record",
        )
        return record.select(here) if names else record

    def placed(self, record: Record) -> tuple[Sensor, ...]:
        """Return the sensors of a record's channels, with positions at its start."""
        return placed_sensors(sensors_at(self.sensors, self.calibrations, record.start_utc), record)

    def sees(self, seen: Examination) -> sp.csr_array:
        """Return the observation matrix of a record's identified channels, (n_channels, n_dof).

        Raises
        ------
        InputError
            If a sensor sits where the structure has no place.
        """
        by_channel = {s.channel: s for s in self.placed(seen.record)}
        return observation_matrix(
            self.structure, tuple(by_channel[c.name] for c in seen.identification.channels)
        )

    def most_likely_feet(self, seen: Examination) -> Feet | None:
        """Return the feet on which the model is most similar to a record's modes; the stiffest of equals.

        Raises
        ------
        InputError
            If a sensor sits where the structure has no place.
        """
        if not self.feet:
            return None
        at = self.sees(seen)
        return max(
            self.feet,
            key=lambda feet: pairing_score(seen.identification.modes, feet.frequency_hz, at @ feet.shapes),
        )


def placed_sensors(given: tuple[Sensor, ...], record: Record) -> tuple[Sensor, ...]:
    """Return the sensors of the channels, with the directions of the record's channels after rotation."""
    by_channel = {sensor.channel: sensor for sensor in given}
    return tuple(
        replace(by_channel[c.name], direction=c.direction)
        if given
        else Sensor(c.name, c.direction, c.node, None if c.node else c.height_m, quantity=sees(c.quantity))
        for c in record.channels
    )


def twin_model(config: TwinConfig) -> TwinModel:
    """Return the model of a twin.

    Raises
    ------
    InputError
        If a sensor sits where the structure has no place.
    """
    assembly = assembled(config)
    if config.sensors:  # report wrong positions as errors of the twin file, not of the first record
        with located(file=config.path):
            observation_matrix(assembly, config.sensors)
    number = max([PAIRED_MODES, *(target.mode + 2 for target in config.targets)])
    numbered = numbered_modes(assembly, number)
    return TwinModel(
        name=config.name,
        assembly=assembly,
        numbered=numbered,
        feet=modes_by_foot_stiffness(assembly, numbered),
        labels=mode_labels(mode_kinds(assembly, numbered.shapes, numbered.frequency_hz)),
        identification=config.identification,
        sensors=config.sensors,
        picks=config.picks,
        by_wind="c_side_side" in config.update.dashpots,
        with_shapes=config.update.fits_shapes,
        calibrations=config.calibrations,
        operation=config.operation,
        stress=_stress_model(config, assembly, numbered),
    )


def _stress_model(config: TwinConfig, assembly: Assembly, numbered: UndampedModes) -> StressModel | None:
    """Return what damage is told with, if the twin asks for it."""
    if config.life is None:
        return None
    return StressModel(
        config.life,
        assembly,
        RestingLoads.of(assembled_dry(config), config.water),
        config.rayleigh,
        numbered,
        directions(config, assembly),
        None if config.water is None else config.water.depth_m,
        None if config.water is None else config.water.coefficients,
        _at_work(config, assembly),
        rotor_by_wind(config, float(numbered.frequency_hz[0])),
    )


def _at_work(config: TwinConfig, assembly: Assembly) -> Direction | None:
    """Return what the rotor at work does to the structure of its records, if the twin says which rotor."""
    known = TOLERANCES[AT_WORK].tolerance
    # a closed tolerance leaves the stiffness itself: it is then known to a thousandth
    std = max(config.tolerances.std(AT_WORK, known.std), 1e-3)
    return next(iter(stiffer_at_work(config, assembly, replace(known, std=std))), None)
