"""Schemas of requests and responses of the API."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any, Generic, Literal, TypeVar

from pydantic import AwareDatetime, BaseModel, Field, FiniteFloat

T = TypeVar("T")
_FIRST, _LAST = datetime(1900, 1, 1, tzinfo=UTC), datetime(9000, 1, 1, tzinfo=UTC)
"""Range of times that a database can store and a time zone can shift."""


class Page(BaseModel, Generic[T]):
    """Part of a list, and the cursor of the next part."""

    items: list[T]
    next_cursor: str | None = None


class Login(BaseModel):
    """Name and password."""

    name: str = Field(max_length=64)
    password: str = Field(max_length=1024)
    new: str | None = Field(
        default=None,
        min_length=12,
        max_length=1024,
        description="The new password, required once this one has expired.",
    )


class Me(BaseModel):
    """User of the request, and the CSRF token that a browser sends with changes."""

    name: str
    role: Literal["viewer", "engineer", "admin"]
    csrf_token: str | None = None


class NewUser(BaseModel):
    """A user to add."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._@-]{0,63}$")
    role: Literal["viewer", "engineer", "admin"]
    password: str | None = Field(
        default=None,
        min_length=12,
        max_length=1024,
        description="Without a password the user logs in by OIDC.",
    )
    assets: list[str] | None = Field(
        default=None, max_length=10_000, description="Visible assets, groups as @NAME; null for all."
    )
    expires_utc: AwareDatetime | None = Field(default=None, ge=_FIRST, le=_LAST)


class GroupIn(BaseModel):
    """The assets of a group."""

    assets: list[str] = Field(max_length=10_000)


class GroupOut(BaseModel):
    """A group of assets."""

    name: str
    assets: list[str]


class UserOut(BaseModel):
    """A user."""

    name: str
    role: Literal["viewer", "engineer", "admin"]
    created_utc: datetime
    disabled: bool
    assets: list[str] | None = None
    expires_utc: datetime | None = None


class NewPassword(BaseModel):
    """The user's present and new password."""

    old: str = Field(max_length=1024)
    new: str = Field(min_length=12, max_length=1024)


class AuditOut(BaseModel):
    """Action of a user, with time and result."""

    id: int
    time_utc: datetime
    who: str
    action: str
    subject: str
    outcome: str


class NewToken(BaseModel):
    """A token to create for a machine."""

    label: str = Field(default="", max_length=128)
    days: int = Field(default=365, ge=1, le=3650)


class Token(BaseModel):
    """A new token, which is shown only once."""

    token: str
    expires_utc: datetime


class AssetOut(BaseModel):
    """A turbine with its status."""

    name: str
    version: int
    model_hash: str
    created_utc: datetime
    last_record_utc: datetime | None
    archived_utc: datetime | None = Field(
        default=None, description="Time from which it accepts no more records."
    )
    comment: str = Field(default="", description="Comment on the adopted version.")
    records: dict[str, int] = Field(description="Number of records by status.")
    findings: dict[str, int] = Field(description="Number of findings by severity.")
    status: Literal["ok", "warning", "alarm", "no data"]


class NewVersion(BaseModel):
    """A twin file for an asset and the files it names, as text."""

    twin: str = Field(max_length=1_000_000)
    files: dict[str, str] = Field(default_factory=dict, max_length=100)
    comment: str = Field(default="", max_length=1000)


class NewAsset(NewVersion):
    """An asset with the first version of its twin."""

    name: str = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")


class VersionOut(BaseModel):
    """A version of an asset's twin."""

    version: int
    model_hash: str
    settings_hash: str
    created_utc: datetime
    created_by: str
    comment: str
    adopted: bool
    observations: int


class RecordAccepted(BaseModel):
    """A stored record and its job.

    A file longer than an hour is divided into records of ten minutes, of which the last is returned.
    """

    record_id: str
    job_id: int | None
    records: int = 1


class RecordOut(BaseModel):
    """A record with its status."""

    record_id: str
    asset: str
    status: Literal["received", "observing", "observed", "refused", "mismatched", "set_aside"]
    start_utc: datetime
    duration_s: float
    sample_rate_hz: float
    channels: list[dict[str, Any]]
    conditions: dict[str, Any]
    source_name: str
    received_utc: datetime
    size_bytes: int
    raw_kept: bool
    problem: dict[str, Any] | None
    picks: dict[str, Any] | None


class Signal(BaseModel):
    """Extremes of a channel in equal bins of time."""

    sample_rate_hz: float
    start_utc: datetime
    time_s: list[float]
    channels: dict[str, dict[str, list[float | None]]]


class Spectra(BaseModel):
    """Power spectral densities by Welch's method."""

    frequency_hz: list[float]
    channels: dict[str, list[float]]
    units: dict[str, str]


class StabilisationOut(BaseModel):
    """Poles of every model order; ``mode`` is the number of the pole's mode, -1 without one."""

    order: list[int]
    frequency_hz: list[float]
    damping_ratio: list[float]
    stable: list[bool]
    mode: list[int]


class PickIn(BaseModel):
    """A manually selected pole: the nearest one to this frequency, of this order or any."""

    frequency_hz: float = Field(gt=0.0, le=1e6)
    order: int | None = Field(default=None, ge=1, le=1000)


class PicksIn(BaseModel):
    """The poles that replace the automatic selection; an empty list restores it."""

    picks: list[PickIn] = Field(max_length=200)


class ModeOut(BaseModel):
    """A mode in one record; 95 % interval on the logarithm of the damping ratio."""

    record_id: str
    time_utc: datetime
    label: str
    frequency_hz: float
    frequency_std_hz: float | None
    damping_ratio: float | None
    damping_ratio_std: float | None
    damping_ratio_interval_95: tuple[float, float] | None
    status: str
    model_version: int


class ExtremesOut(BaseModel):
    """Least value, median and greatest value of each bin; null where no record has one."""

    min: list[float | None]
    median: list[float | None]
    max: list[float | None]


class ModeBinsOut(BaseModel):
    """One mode through time in bins of equal length; bins without a record are left out."""

    label: str
    start_utc: datetime
    bin_s: float
    time_s: list[float] = Field(description="Start of each bin after start_utc.")
    count: list[int] = Field(description="Number of records in each bin.")
    frequency_hz: ExtremesOut
    damping_ratio: ExtremesOut
    simulated: int = Field(description="Number of records of all bins that nobody measured.")


class FindingOut(BaseModel):
    """Something worth saying, and how it stands; its sentence is made of code and params."""

    id: int
    asset: str
    record_id: str
    time_utc: datetime
    day: str = Field(description="UTC day; with asset, code and subject what the finding is known by.")
    code: str
    severity: Literal["info", "warning", "alarm"]
    subject: str | None
    params: dict[str, Any]
    text: str
    acknowledged_by: str | None = None
    acknowledged_utc: datetime | None = None
    assigned_to: str | None = None
    muted_until_utc: datetime | None = Field(
        default=None, description="What is muted is told to nobody; it is null again once the time is over."
    )
    closed_by: str | None = None
    closed_utc: datetime | None = None
    close_reason: str | None = None


class AlarmOut(FindingOut):
    """A finding that asks for a person, and what was said of it when it was acknowledged."""

    comment: str | None = None


class ActOut(BaseModel):
    """What somebody did with a finding; ``unmute`` is the end of a mute, by a person or by its time."""

    action: Literal["acknowledge", "assign", "comment", "mute", "unmute", "close", "reopen"]
    by: str
    time_utc: datetime
    comment: str
    to: str | None = None
    until_utc: datetime | None = None


class HandledOut(FindingOut):
    """A finding with all that people did with it, oldest first."""

    history: list[ActOut]


Comment = Annotated[str, Field(max_length=2000)]


class Acknowledgement(BaseModel):
    """What is to be said of an alarm or finding, or of a record that is set aside."""

    comment: Comment = Field(min_length=1)


class AssignIn(BaseModel):
    """Whose a finding is to look after; null for nobody's."""

    to: str | None = Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._@-]{0,63}$")
    comment: Comment = ""


class MuteIn(BaseModel):
    """Until when nobody is told of a finding: also of later days, of the same code and subject."""

    until_utc: AwareDatetime = Field(ge=_FIRST, le=_LAST)
    comment: Comment = ""


class CloseIn(BaseModel):
    """Why a finding needs nobody any more."""

    reason: Comment = Field(min_length=1)


class ReopenIn(BaseModel):
    """Why a finding needs somebody after all."""

    comment: Comment = ""


class JobOut(BaseModel):
    """A job."""

    id: int
    kind: str
    asset: str
    record_id: str
    version: int
    state: Literal["queued", "leased", "done", "failed", "set_aside", "cancelled"]
    tries: int
    created_utc: datetime
    started_utc: datetime | None
    ended_utc: datetime | None
    reason: dict[str, Any] | None


Named = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]{1,64}$")]
"""Name of a condition: printable characters."""


class ConditionsIn(BaseModel):
    """Conditions of the site over time; names with units as in records."""

    time_utc: list[Annotated[AwareDatetime, Field(ge=_FIRST, le=_LAST)]] = Field(max_length=100_000)
    values: dict[Named, list[FiniteFloat | Annotated[str, Field(max_length=64)] | None]] = Field(
        max_length=50
    )


class Taken(BaseModel):
    """Number of new or changed conditions, and of records that are observed again."""

    count: int
    observed_again: int


class TwinOut(BaseModel):
    """State of the twin at a time: modes and parameters with intervals, and their records."""

    asset: str
    version: int
    model_hash: str
    code_version: str
    state_hash: str
    days: int
    records: int
    first_utc: datetime | None
    last_utc: datetime | None
    modes: list[dict[str, Any]]
    parameters: dict[str, Any]
    status: str


class Value(BaseModel):
    """A number with its 90 % interval; null if unknown."""

    value: float
    low: float | None
    high: float | None


class MedianOut(BaseModel):
    """A median with its 90 % interval."""

    median: float
    interval_90: tuple[float, float]


class SupportsDay(BaseModel):
    """Stiffness of the supports as estimated on a day: ratio to the first day's, and each parameter."""

    time_utc: datetime
    records: int
    status: str
    relative_stiffness: MedianOut | None
    parameters: dict[str, MedianOut]


class SuddenChangeOut(BaseModel):
    """A jump of the stiffness: its time, and the ratio of the stiffness after it to that before."""

    time_utc: datetime
    time_utc_interval_90: tuple[datetime, datetime]
    factor: MedianOut
    probability: float


class ForecastOut(MedianOut):
    """Forecast of the stiffness so many days after the last one, as ratio to the first day's."""

    days: int


class StiffnessInTime(BaseModel):
    """Ratio of the stiffness to the first day's: smoothed for each day, jumps, and forecast."""

    smoothed: dict[str, MedianOut]
    changes: list[SuddenChangeOut]
    forecast: list[ForecastOut]


class SupportsOut(BaseModel):
    """The stiffness of the supports on each day, as in ``jackettwin follow --json``; the last day first.

    Empty before the third day.
    """

    asset: str
    version: int
    law: str | None = None
    units: dict[str, str] = Field(default_factory=dict)
    statement: str = ""
    days: list[SupportsDay] = Field(default_factory=list)
    stiffness_in_time: StiffnessInTime | None = None


class BudgetOut(BaseModel):
    """Damping ratio of a mode by source (structure, soil, rotor, water).

    ``unexplained`` is the measured ratio in excess of their sum; null without a measured one.
    """

    label: str
    measured: Value | None
    sources: dict[str, Value]
    unexplained: float | None = None


class YearsLeft(BaseModel):
    """What is left of a life, as quantiles [years]; null where nothing fails."""

    p05: float | None
    p50: float | None
    p95: float | None


class Since(BaseModel):
    """Since which day something holds, and by which ratio it did then."""

    since: str
    ratio: float


class LifeOut(BaseModel):
    """One side of a weld, as the records have damaged it: by the design curve, intervals of 90 %.

    ``damage`` is of the time that records tell of (``observed_s``), at the worst of the eight points of
    ``damage_by_point``; ``damage_interval_90`` is about the median by the mean of the tests. A year is as the
    records were. ``node_m`` and ``brace_end_m`` are where the weld is and where its brace leads, in the
    structure's frame. ``scf``: factors by class (k, y, x), load and place. ``departed``: its share of the
    damage of all welds differs from its past; ``over_budget``: a year's damage exceeds what the design life
    allows, its interval included.
    """

    joint: str
    chord: str
    brace: str
    side: Literal["chord", "brace"]
    position: str
    z_m: float
    node_m: tuple[float, float, float]
    brace_end_m: tuple[float, float, float]
    environment: Literal["air", "cathodic", "free-corrosion"]
    scf: dict[str, dict[str, dict[str, float]]]
    beyond_validity: list[str]
    model_version: int
    observed_s: float
    records: int
    damage: float
    damage_at_most: float
    damage_by_point: list[float]
    damage_interval_90: tuple[float, float]
    rate_per_year: float
    rate_interval_90: tuple[float, float]
    recent_rate_per_year: float | None
    budget_per_year: float
    life_years: float
    remaining_years: YearsLeft
    age_years: float
    failure_probability_per_year: float
    reliability_index: float
    variance_shares: dict[str, float]
    damage_by_state: dict[str, float]
    departed: Since | None
    over_budget: Since | None


class SensitivityOut(BaseModel):
    """A mode at the medians of the updated parameters, and its sensitivity to each.

    The sensitivities are ∂ ln f/∂ ln θ and ∂ζ/∂ ln θ.
    """

    mode: int
    label: str
    frequency_hz: float
    damping_ratio: float
    frequency_sensitivity: dict[str, float]
    damping_sensitivity: dict[str, float]


Drawn = list[float | None]
"""Values of a curve; null for missing ones."""


class BranchOut(BaseModel):
    """Locus of one mode along a parameter; null where it does not oscillate."""

    mode: int
    label: str
    pole_real_rad_s: Drawn
    pole_imag_rad_s: Drawn
    frequency_hz: Drawn
    damping_ratio: Drawn
    most_damped_at: float | None
    most_damping_ratio: float | None


class LocusOut(BaseModel):
    """The root locus along a parameter; ``origin`` is the index of the explored point among its values."""

    parameter: str
    unit: str
    values: list[float]
    origin: int
    branches: list[BranchOut]


class AxisOut(BaseModel):
    """Values of a parameter along an axis."""

    parameter: str
    values: list[float]


class SurfaceOut(BaseModel):
    """The cost over two parameters, a row for each value of y."""

    x: AxisOut
    y: AxisOut
    cost: list[Drawn]


class CurveOut(BaseModel):
    """The cost as one parameter is multiplied by factors."""

    parameter: str
    value: float
    factor: list[float]
    cost: Drawn


class ExploredValue(BaseModel):
    """A parameter at the explored point, and its bounds."""

    name: str
    unit: str
    value: float
    low: float
    high: float


class ExploredOut(BaseModel):
    """Effect of the law's parameters on cost and modes around their medians; empty before an update."""

    law: str | None = None
    parameters: list[ExploredValue] = []
    loci: list[LocusOut] = []
    surface: SurfaceOut | None = None
    curves: list[CurveOut] = []


class PlaceOut(BaseModel):
    """A sensor's place at rest [m], z above the mean sea level, and the nearest node."""

    at: list[float]
    node: int


class MeasuredShapeOut(BaseModel):
    """Displacements of the sensors in a mode, x, y, z of each, on the shapes of the motion."""

    places: list[PlaceOut]
    shapes: list[list[float]]


class MotionOut(BaseModel):
    """A motion: displacements of the nodes (x, y, z of each) by shape times the coordinates of each frame."""

    name: str
    note: str
    group: str
    shapes: list[list[float]]
    q: list[list[float]]
    step_s: float
    start_s: float
    cyclic: bool
    largest_m: float | None
    measured: MeasuredShapeOut | None


class ColourOut(BaseModel):
    """A number for every element to colour by; ``log`` spreads values that span decades."""

    name: str
    unit: str
    log: bool
    from_zero: bool
    values: list[float | None]


class StructureOut(BaseModel):
    """A structure to draw: nodes (x, y, z of each [m], z above sea level), elements, colours, motions.

    Empty until supports have been updated.
    """

    title: str = ""
    nodes: list[float] = []
    start: list[int] = []
    end: list[int] = []
    diameter: list[float] = Field(default=[], description="[m]")
    growth: list[float] = Field(default=[], description="[m]")
    flooded: list[int] = []
    text: list[str] = []
    quantities: list[ColourOut] = []
    motions: list[MotionOut] = []
    sensors: list[dict[str, Any]] = []
    masses: list[dict[str, Any]] = []
    others: list[dict[str, Any]] = []
    dimensions: dict[str, Any] = {}
    mud_z: float = 0.0


class AssumptionOut(BaseModel):
    """What an answer takes for granted; ``confirmed`` is null of a choice of modelling.

    ``moves`` is the relative change of each updated parameter for one standard deviation more.
    """

    key: str
    value: str
    confirmed: bool | None = None
    moves: dict[str, float] = {}
    settled_by: str | None = None


class ChangeOut(BaseModel):
    """A quantity under two versions; null where one does not have it.

    The records are the same, so that the difference is due to the model. It is also given in standard
    deviations of the adopted version.
    """

    quantity: str
    unit: str
    adopted: float | None
    other: float | None
    difference: float | None = None
    in_standard_deviations: float | None = None


class ComparisonOut(BaseModel):
    """Comparison of two versions of a twin on the same records."""

    adopted: TwinOut
    other: TwinOut
    changes: list[ChangeOut]


class Health(BaseModel):
    """Whether the server runs, and its faults."""

    status: Literal["ok", "degraded"]
    version: str
    problems: list[str] = []
    openid: bool = Field(default=False, description="Whether people may log in at a provider.")


class Ready(BaseModel):
    """Whether records can now be stored and observed."""

    ready: bool
    database: bool
    scheduler: bool
    workers: int
    broker: bool | None
    free_bytes: int
    queue_age_s: float | None = None
