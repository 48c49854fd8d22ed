"""Checked configuration of a twin in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import date
from math import hypot
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from jackettwin.errors import require
from jackettwin.files import Schema
from jackettwin.identification import IdentificationSettings, Pick
from jackettwin.records import FileDefaults
from jackettwin.response import Sensor
from jackettwin.soil import DEFAULT_LAWS
from jackettwin.structure import Assembly, Rayleigh, Structure, assemble
from jackettwin.twin.calibration import Calibrations
from jackettwin.twin.life.settings import LifeSettings
from jackettwin.twin.operation import OperationRule
from jackettwin.twin.water import WaterConfig, in_water
from jackettwin.updating import MOST_EVALUATIONS, Problem, Target, points_of

Positive = Annotated[float, Field(gt=0.0)]
Ratio = Annotated[float, Field(ge=0.0, lt=1.0)]
Weight = Annotated[float, Field(ge=0.0, le=1e12)]
DEFAULT_STARTS = 32
PAIRED_MODES = 12
"""Number of the model's modes that measured modes may be paired with."""
USUAL_MODES = (1, 2, 3, 4, 5)
"""Numbers of both bending pairs and torsion."""


class ModelError(Schema):
    """Relative standard deviation of the model's error in some modes or in rates of relaxations."""

    modes: tuple[Annotated[int, Field(ge=1, le=50)], ...] = ()
    frequency: Ratio = 0.0
    damping: Ratio = 0.0
    rate: Ratio = 0.0


class ToleranceSchema(Schema):
    """A tolerance of ``tolerances``: its standard deviation, or a flag that it was weighed or inspected."""

    std: Annotated[float, Field(ge=0.0)] | None = None
    weighed: bool = False


@dataclass(frozen=True)
class TwinTolerances:
    """``tolerances`` of a twin file.

    Attributes
    ----------
    given : {name: standard deviation}
        Of the tolerances that the twin specifies; 0 closes one.
    others : bool
        Whether the tolerances that it does not specify are open.
    """

    given: Mapping[str, float] = field(default_factory=dict)
    others: bool = True

    def std(self, name: str, usual: float) -> float:
        """Return the standard deviation of a tolerance."""
        return self.given.get(name, usual if self.others else 0.0)


class LognormalPrior(Schema):
    """Lognormal prior of a parameter; the standard deviation is that of its logarithm."""

    median: Positive
    log_std: Positive


class Weights(Schema):
    """Weights of squared relative errors, w_ω and w_ζ of thesis (8.4): one number, or one for each mode.

    The default is 1; a value with weight 0 is not fitted.
    """

    frequency: Weight | dict[Annotated[int, Field(ge=1, le=50)], Weight] = 1.0
    damping: Weight | dict[Annotated[int, Field(ge=1, le=50)], Weight] = 1.0

    def of_mode(self, mode: int) -> tuple[float, float]:
        """Return the weights of a mode's frequency and damping ratio."""
        f, zeta = (
            given.get(mode, 1.0) if isinstance(given, dict) else given
            for given in (self.frequency, self.damping)
        )
        return f, zeta


@dataclass(frozen=True)
class GivenRelaxation:
    """A relaxation given as a target.

    Attributes
    ----------
    rate_rad_s : float
        a of exp(−at).
    rate_std_rad_s : float or None
    shape : {channel: value}
        At sensors of the twin; empty if it is not known.
    """

    rate_rad_s: float
    rate_std_rad_s: float | None = None
    shape: Mapping[str, complex] = field(default_factory=dict)


class UpdateSettings(Schema):
    """``update`` of a twin file: how the supports are updated.

    ``damping_of`` names the modes whose damping is fitted: ``fore_aft``, ``all``, ``none``,
    or labels; the default is all for targets and ``fore_aft`` for records. ``modes`` are the numbers of the
    fitted modes. The default is all for targets, and both bending pairs and torsion for records; higher modes
    depend more on blades and brace details than on supports.
    """

    laws: Annotated[tuple[str, ...], Field(min_length=1)] = DEFAULT_LAWS
    method: Literal["least-squares", "nelder-mead"] = "least-squares"
    starts: (
        Annotated[int, Field(ge=1, le=10000)]
        | Annotated[tuple[Annotated[dict[str, Positive], Field(min_length=1)], ...], Field(min_length=1)]
    ) = DEFAULT_STARTS
    """Number of scattered starting points of the search, or the points themselves. A law without a given
    point starts from the default number of scattered points."""
    most_evaluations: Annotated[int, Field(ge=1, le=10**9)] = MOST_EVALUATIONS
    """Number of model evaluations after which the search adds no further starts."""
    seed: Annotated[int, Field(ge=0)] = 0
    particles: Annotated[int, Field(ge=20, le=100000)] = 150
    sampler: Literal["smc", "nested"] = "smc"
    bounds: dict[str, tuple[float, float]] = {}
    priors: dict[str, LognormalPrior] = {}
    """Priors by parameter name; those of other parameters are flat in ln θ."""
    weighting: Literal["auto", "relative", "covariance"] = "auto"
    weights: Weights | None = None
    modes: tuple[Annotated[int, Field(ge=1)], ...] = USUAL_MODES
    damping_of: Literal["fore_aft", "all", "none"] | tuple[str, ...] = "fore_aft"
    model_errors: Annotated[tuple[ModelError, ...], Field(alias="model_error")] = ()
    mac_std: Positive | None = None
    """Standard deviation of 1 − MAC; with None, mode shapes are not fitted."""
    profile_std: Positive | None = None
    """Standard deviation of how far the place that moves least in a mode moves with the one that moves most;
    with None, it is not fitted."""
    dashpots: tuple[Literal["c_fore_aft", "c_side_side"], ...] = ()
    """Nacelle dashpots that are also updated, stated at the mean wind speed."""
    rotor: str | None = None
    """A windIO file or shipped rotor from which the dashpots' priors and patterns follow."""
    rotor_state: Literal["parked", "operating"] = "parked"
    """State of the rotor in the records that may update the supports."""
    rotor_schedule: str | None = None
    """A CSV of its speed and pitch by wind; None leaves them to the windIO file's control."""
    shaft: Literal["locked", "free"] | None = None
    """Whether the rotor turns with the nacelle: by default a parked one does, one at work does not."""
    wind_speed_m_s: Positive | None = None
    """Wind speed that replaces the mean over the records' conditions."""
    water: tuple[Literal["water_mass", "water_damping"], ...] = ()
    """Factors of the water that are also updated."""
    parameters: tuple[str, ...] = ()
    """Parameters of installed packages that are also updated."""
    steel_damping: Literal["fixed", "free"] = "fixed"
    """Whether ratio and frequency of the steel's minimum damping are also updated."""

    def starts_for(self, problem: Problem) -> int | tuple[Mapping[str, float], ...]:
        """Return the starting points of the search of one law, or their number."""
        if isinstance(self.starts, int):
            return self.starts
        return points_of(problem, self.starts) or DEFAULT_STARTS

    @property
    def fits_shapes(self) -> bool:
        """Whether mode shapes are fitted in any way."""
        return self.mac_std is not None or self.profile_std is not None

    def fits_damping(self, label: str) -> bool:
        """Return whether the damping of a mode is fitted."""
        if isinstance(self.damping_of, tuple):
            return label in self.damping_of
        return self.damping_of == "all" or label.startswith(self.damping_of)

    def model_error(self, mode: int) -> ModelError:
        """Return the model error of one mode (quadratic sum of all that name it)."""
        frequency = damping = 0.0
        for error in self.model_errors:
            if mode in error.modes:
                frequency, damping = hypot(frequency, error.frequency), hypot(damping, error.damping)
        return ModelError(modes=(mode,), frequency=frequency, damping=damping)

    @property
    def rate_error(self) -> float:
        """Relative standard deviation of the model's error in the rate of a relaxation."""
        return hypot(*(error.rate for error in self.model_errors))


class WatchSettings(Schema):
    """``watch`` of a twin file: baseline and false alarm rate of the monitoring for change."""

    baseline_days: Annotated[float, Field(ge=30.0, le=3653.0)] = 365.0
    """Length of the baseline from the first record in days; a year includes all seasons."""
    arl_years: Annotated[float, Field(ge=0.1, le=1000.0)] = 10.0
    """Mean time in years between false alarms of all quantities together."""
    relearn: date | None = None
    """First day of a new baseline that a person requested, as after a repair or a change."""


@dataclass(frozen=True)
class TwinConfig:
    """A checked twin file; relative paths are resolved."""

    name: str
    path: Path
    structure: Structure
    beam: str | None
    rotary_inertia: bool | None
    subdivide: int | None
    gravity: bool
    rayleigh: Rayleigh
    rayleigh_ratio: float
    water: WaterConfig | None
    tie: str
    shared: tuple[str, ...]
    """Parameters of the laws with one value for all legs."""
    scatter: Mapping[str, float]
    """Typical standard deviation of ln θ between legs, by parameter of the laws."""
    heads: str | None
    """Pile heads whose 6×6 stiffness the laws scale: a SUPPORT, ``own`` for the structure's."""
    sensors: tuple[Sensor, ...]
    records: tuple[Path, ...]
    targets: tuple[Target, ...]
    shapes: Mapping[int, Mapping[str, complex]]
    """Of targets, at sensors of the twin: {mode: {channel: value}}."""
    relaxations: tuple[GivenRelaxation, ...]
    """Targets that are relaxations."""
    identification: IdentificationSettings
    picks: tuple[Pick, ...]
    """Poles to take instead of the automatic selection, for the records they name."""
    update: UpdateSettings
    defaults: FileDefaults = FileDefaults()
    """Properties of records whose files do not state them."""
    calibrations: Calibrations = ()
    """Calibrations of the sensors, each for a period."""
    operation: OperationRule = OperationRule()
    """Rule for the state of operation of a record, and whether it may update the supports."""
    watch: WatchSettings = WatchSettings()
    """Settings of the monitoring for change."""
    tolerances: TwinTolerances = TwinTolerances()
    """Tolerances of drawings and sea."""
    life: LifeSettings | None = None
    """Settings of the damage at welds; None computes none."""
    rotor_speed_rpm: tuple[float, float] | None = None
    """Lowest and highest speed of the rotor in operation; with None, that of ``update.rotor``."""
    mode_damping: Mapping[int, float] = field(default_factory=dict)
    """Damping ratios of the structure's own modes on pinned feet, by number."""
    assigned: tuple[int, ...] = ()
    """Modes that were assigned to targets without a mode's name or number."""
    of_records: tuple[str, ...] = ()
    """Keys of the model (``gravity``, …) that the file omits and the records state."""

    def require_records(self) -> None:
        """Raise an error if the file of any record is missing, before reading any.

        Raises
        ------
        InputError
            If a file is missing; the error names the twin file and the entry.
        """
        for i, path in enumerate(self.records):
            require(
                path.exists(),
                f"{path}: no such file",
                file=self.path,
                field=f"records[{i}]",
                remedy="check the path; it is relative to the twin file",
            )

    def __repr__(self) -> str:
        data = f"{len(self.targets)} targets" if self.targets else f"{len(self.records)} records"
        return f"TwinConfig({self.name!r}, {self.structure!r}, {data}, laws {', '.join(self.update.laws)})"

    def modelling(self) -> dict[str, object]:
        """Return the modelling options of the structure, by the keys of a twin file."""
        s = self.structure
        return {
            "gravity": self.gravity,
            "beam": self.beam or s.beam,
            "rotary_inertia": s.rotary_inertia if self.rotary_inertia is None else self.rotary_inertia,
            "subdivide": self.subdivide or s.subdivide,
        }


def assembled_dry(config: TwinConfig, *, gravity: bool = False) -> Assembly:
    """Return the assembled structure of a twin with the mass of its steel alone."""
    return assemble(
        config.structure,
        beam_theory=config.beam,
        rotary_inertia=config.rotary_inertia,
        subdivide=config.subdivide,
        gravity=gravity,
    )


def assembled(config: TwinConfig) -> Assembly:
    """Return the assembled structure of a twin, including the water's added mass."""
    return in_water(config.water, assembled_dry(config, gravity=config.gravity))
