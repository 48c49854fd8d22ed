"""Schemas of a twin file, one for each of its keys."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import AwareDatetime, BeforeValidator, Field

from jackettwin.decks import RnaSchema, StructureChoice
from jackettwin.errors import InputError, require
from jackettwin.files import Schema, one_of
from jackettwin.loads import WaterSchema
from jackettwin.quantities import plain_unit, vibration_of
from jackettwin.records import FileDefaults, read_zone
from jackettwin.response import Sensor, sensor_kinds
from jackettwin.structure import RayleighSchema
from jackettwin.twin.calibration import Calibration, Calibrations
from jackettwin.twin.config import (
    GivenRelaxation,
    Positive,
    ToleranceSchema,
    UpdateSettings,
    WatchSettings,
)
from jackettwin.twin.life.settings import LifeSettings
from jackettwin.twin.operation import OperationRule
from jackettwin.updating import Target

Vector = tuple[float, float, float]

_OF_RELAXATIONS = {"rate_rad_s", "rate_std_rad_s"}
"""Keys of targets that only relaxations have."""
_STANDARD_DEVIATIONS = {"frequency_hz": "frequency_std_hz", "damping_ratio": "damping_ratio_std"}


StructureOrName = Annotated[
    StructureChoice, BeforeValidator(lambda given: {"source": given} if isinstance(given, str) else given)
]


class DampingSchema(Schema):
    """``damping``."""

    rayleigh: RayleighSchema | None = None
    modes: dict[Annotated[int, Field(ge=1, le=50)], Annotated[float, Field(ge=0.0, lt=1.0)]] = {}
    """Ratios of the structure's own modes on pinned feet, by number."""


class SupportSchema(Schema):
    """``support``: the law to report first, the tie of the parameters, and pile heads that the laws scale.

    ``shared`` parameters have one value for all tie groups; ``scatter`` is the expected standard
    deviation of ln θ of the others between tie groups.
    """

    law: str | None = None
    tie: Literal["all", "horizontal-vertical", "per-leg", "per-leg-horizontal-vertical", "mudline"] = "all"
    stiffness: str | None = None
    shared: list[str] = []
    scatter: dict[str, Annotated[float, Field(gt=0.0, le=3.0)]] = {}


class CalibrationSchema(Schema):
    """Calibration for a period: the factor on the samples, and another position if the sensor was moved."""

    from_utc: AwareDatetime | None = None
    to_utc: AwareDatetime | None = None
    gain: Positive = 1.0
    sign: Literal[1, -1] = 1
    node: str | None = None
    height_m: float | None = None
    direction: Vector | None = None

    def build(self, sensor: Sensor) -> Calibration:
        """Return the calibration of a sensor, whose other data are those of ``sensor``."""
        moved = self.node is not None or self.height_m is not None
        then = replace(sensor, direction=self.direction or sensor.direction)
        if moved:
            then = replace(then, node=self.node, height_m=self.height_m, member=None)
        return Calibration(then, self.gain * self.sign, self.from_utc, self.to_utc)


def _since(calibration: Calibration) -> datetime:
    return calibration.from_utc or datetime.min.replace(tzinfo=UTC)


class SensorSchema(Schema):
    """A sensor: position, direction and measured quantity of a channel of the record."""

    channel: str
    node: str | None = None
    height_m: float | None = None
    member: str | None = None
    position: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    direction: Vector
    quantity: Annotated[str, one_of(sensor_kinds)] = "motion"
    calibrations: list[CalibrationSchema] = []

    def build(self) -> Sensor:
        """Return the sensor."""
        return Sensor(**self.model_dump(exclude={"calibrations"}))

    def history(self) -> Calibrations:
        """Return its calibrations, each with its period.

        Raises
        ------
        InputError
            If two calibrations hold at the same time.
        """
        found = sorted((c.build(self.build()) for c in self.calibrations), key=_since)
        for before, after in pairwise(found):
            require(
                before.to_utc is not None and _since(after) >= before.to_utc,
                "two calibrations hold at the same time",
                field=f"sensors.{self.channel}.calibrations",
                value=str(after.from_utc),
                remedy="end the earlier one (to_utc) where the later one begins (from_utc)",
            )
        return tuple(found)


class LoggerSchema(Schema):
    """Unit, gain, clock and rate of records whose files do not state them."""

    unit: str | None = None
    gain: float | None = None
    clock: str | None = None
    sample_rate_hz: Positive | None = None

    def build(self) -> FileDefaults:
        """Return the properties in the form of the readers.

        Raises
        ------
        InputError
            If the unit is not one of a vibration, or the time zone is unknown.
        """
        if self.unit is not None:
            vibration_of(plain_unit(self.unit))
        if self.clock is not None:
            read_zone(self.clock)
        return FileDefaults(self.sample_rate_hz, self.unit, self.gain, self.clock)


class TargetSchema(Schema):
    """A target: a mode, or a relaxation (``rate_rad_s``), either with its shape at the sensors if known."""

    mode: Annotated[int, Field(ge=1, le=50)] | str | None = None
    frequency_hz: Positive | None = None
    frequency_std_hz: Positive | None = None
    damping_ratio: Annotated[float, Field(gt=0.0, lt=1.0)] | None = None
    damping_ratio_std: Positive | None = None
    correlation: Annotated[float, Field(gt=-1.0, lt=1.0)] = 0.0
    rate_rad_s: Positive | None = None
    rate_std_rad_s: Positive | None = None
    mode_shape: dict[str, float | tuple[float, float]] = {}

    def build(self, channels: list[str]) -> Target | GivenRelaxation:
        """Return the target.

        Parameters
        ----------
        channels : of the twin's sensors

        Raises
        ------
        InputError
            If it is neither a mode nor a relaxation, or its shape has other channels than the sensors.
        """
        given = {name for name in self.model_fields_set if getattr(self, name) is not None}
        for value, std in _STANDARD_DEVIATIONS.items():
            require(
                std not in given or value in given,
                "a standard deviation is given without its value",
                field=std,
                value=getattr(self, std),
                remedy=f"give {value}, or leave {std} out",
            )
        strangers = [channel for channel in self.mode_shape if channel not in channels]
        require(
            not strangers,
            "no sensor of the twin has this channel",
            field="mode_shape",
            value=strangers,
            allowed=", ".join(channels) or None,
            remedy="give its position under sensors:",
        )
        if isinstance(self.mode, int) and not given & _OF_RELAXATIONS:
            values = self.model_dump(exclude={*_OF_RELAXATIONS, "mode", "mode_shape"})
            return Target(mode=self.mode, **values)
        if self.rate_rad_s is None or given - _OF_RELAXATIONS - {"mode_shape"}:
            raise InputError(
                "a target must be either a mode or a relaxation",
                value=sorted(given),
                remedy="a mode: {mode, frequency_hz, …}; a relaxation: {rate_rad_s, rate_std_rad_s}",
            )
        return GivenRelaxation(self.rate_rad_s, self.rate_std_rad_s, self.shape)

    @property
    def is_unnamed(self) -> bool:
        """Whether it gives a frequency without naming a mode."""
        return self.mode is None and self.frequency_hz is not None and self.rate_rad_s is None

    @property
    def number(self) -> int | None:
        """The mode's number; None for a relaxation, or a mode with a name that has no number yet."""
        return self.mode if isinstance(self.mode, int) else None

    @property
    def shape(self) -> dict[str, complex]:
        """The shape at the sensors; empty if it is not given."""
        return {n: complex(*v) if isinstance(v, tuple) else complex(v) for n, v in self.mode_shape.items()}


class SeaSchema(Schema):
    """``sea``: the mean sea of the records, a JONSWAP spectrum."""

    hs_m: Positive
    tp_s: Positive
    direction_deg: float = 0.0


class TwinSchema(Schema):
    """A twin file."""

    structure: StructureOrName
    rna: RnaSchema | None = None
    beam: Literal["euler-bernoulli", "timoshenko"] | None = None
    rotary_inertia: bool | None = None
    subdivide: Annotated[int, Field(ge=1, le=1000)] | None = None
    gravity: bool = True
    damping: DampingSchema | None = None
    water: WaterSchema | None = None
    sea: SeaSchema | None = None
    support: SupportSchema = SupportSchema()
    sensors: list[SensorSchema] = []
    records: list[str] = []
    logger: LoggerSchema = LoggerSchema()
    targets: list[TargetSchema] = []
    rotor_speed_rpm: tuple[Positive, Positive] | None = None
    identification: dict[str, Any] = {}
    update: UpdateSettings = UpdateSettings()
    tolerances: Literal["none"] | dict[str, Annotated[float, Field(ge=0.0)] | ToleranceSchema] = {}
    operation: OperationRule = OperationRule()
    watch: WatchSettings = WatchSettings()
    life: LifeSettings | None = None
