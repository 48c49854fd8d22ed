"""Schemas of modes through time, and of the state of a twin."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import BaseModel, Field


class ModeOut(BaseModel):
    """A mode in one record; 90 % interval on the logarithm of the damping ratio."""

    record_id: str
    time_utc: datetime
    label: str
    frequency_hz: float
    frequency_std_hz: float | None
    damping_ratio: float | None
    damping_ratio_std: float | None
    damping_ratio_interval_90: tuple[float, float] | None
    status: str
    model_version: int
    reason: str | None = Field(None, description="Why it is doubtful, or no mode; of one record's modes.")


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


class WatchedQuantity(BaseModel):
    """A quantity of a mode day by day: what conditions do not explain, and its scatter without a change.

    Frequencies and damping ratios as differences of logarithms, angles in rad.
    """

    label: str
    kind: Literal["frequency", "damping", "angle"]
    rest: list[float | None]
    rest_std: list[float | None]


class SmallestChangeOut(BaseModel):
    """A change that is found with 95 % within some days; ``step`` is what it does to each quantity."""

    change: str
    days: float
    size: float | None
    unit: str
    found: int | None = None
    of: int | None = None
    step: list[float] = []
    projected: bool = False


class WatchOut(BaseModel):
    """The days that were judged after the baseline, and the evidence for a change (ln R) on each.

    Empty before the baseline is whole. An alarm is raised at the threshold, in the mean not more often than
    once in ``arl_years`` while nothing changes.
    """

    arl_years: float | None = None
    threshold_ln: float | None = None
    days: list[str] = []
    ln_evidence: list[float] = []
    quantities: list[WatchedQuantity] = []
    smallest: list[SmallestChangeOut] = []


class Value(BaseModel):
    """A number with its 90 % interval; null if unknown."""

    value: float
    low: float | None
    high: float | None


class BudgetOut(BaseModel):
    """Damping ratio of a mode by source (structure, soil, rotor, water).

    ``unexplained`` is the measured ratio in excess of their sum; null without a measured one.
    """

    label: str
    measured: Value | None
    sources: dict[str, Value]
    unexplained: float | None = None


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


class TwinMode(BaseModel):
    """A mode in the mean of records, with their number; standard deviations are those of the mean."""

    mode: int
    label: str
    frequency_hz: float
    frequency_std_hz: float
    damping_ratio: float
    damping_ratio_std: float
    records: int


class KnownParameter(BaseModel):
    """A parameter of supports or rotor: median and 90 % interval, its name in words, and both as text.

    ``day`` is the day that the value is of if it is followed from day to day; otherwise it is of all records.
    """

    median: float
    interval_90: tuple[float, float] | None = None
    unit: str
    words: str
    text: str
    day: str | None = None


class QuestionOut(BaseModel):
    """A question of the report's first page, and what is said to it in short."""

    question: str
    answer: str


class Knowledge(BaseModel):
    """What is known of the supports by all records until a time; empty before there is an estimate.

    ``reliable`` is false if the model cannot reproduce the measurements on any ground, which ``status``
    says, and ``reported`` whether there is a report.
    """

    law: str | None = None
    status: str | None = None
    reliable: bool = False
    records: int = 0
    until_utc: datetime | None = None
    parameters: dict[str, KnownParameter] = {}
    answers: list[QuestionOut] = []
    budget: list[BudgetOut] = []
    sensitivity: list[SensitivityOut] = []
    statement: str = ""
    reported: bool = False


class TwinOut(BaseModel):
    """State of the twin at a time: modes and parameters with intervals, and their records.

    ``modes`` are means of all records until then, ``recent_modes`` of the 30 days up to the last record.
    """

    asset: str
    version: int
    model_hash: str
    code_version: str
    state_hash: str
    days: int
    records: int
    first_utc: datetime | None
    last_utc: datetime | None
    modes: list[TwinMode]
    recent_modes: list[TwinMode]
    parameters: Knowledge
    status: str
