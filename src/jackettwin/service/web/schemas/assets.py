"""Schemas of turbines, versions of their twins, and the conditions of their sites."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import AwareDatetime, BaseModel, Field, FiniteFloat

from jackettwin.service.web import names
from jackettwin.service.web.schemas.common import FIRST, LAST
from jackettwin.service.web.schemas.drawings import StructureOut
from jackettwin.service.web.schemas.modes import TwinOut


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
    open_alarms: int = Field(description="Number of alarms that nobody has acknowledged, muted or closed.")
    reason: str = Field(description="Why somebody should look; empty if nobody need.")
    remaining_years: float | None = Field(
        description="Median of the years left to the weld that fails first, if known."
    )
    remaining_years_interval_90: list[float | None] | None = Field(
        description="Its 90 % interval; null where an end lies beyond what is told."
    )
    latitude_deg: float | None = None
    longitude_deg: float | None = None


class Position(BaseModel):
    """Where a turbine stands (WGS 84)."""

    latitude_deg: float = Field(ge=-90.0, le=90.0)
    longitude_deg: float = Field(ge=-180.0, le=180.0)


class NewVersion(BaseModel):
    """A twin file for an asset and the files it names, as text."""

    twin: str = Field(max_length=1_000_000)
    files: dict[str, str] = Field(default_factory=dict, max_length=100)
    comment: str = Field(default="", max_length=1000)


class NewAsset(NewVersion):
    """An asset with the first version of its twin."""

    name: str = Field(pattern=names.ASSET)


class GuessOut(BaseModel):
    """A channel, and why its sensor is placed where it is drawn, or what it lacks for that."""

    channel: str
    why: str
    lacks: str


class DraftOut(BaseModel):
    """A drafted twin file with the guesses in it, to be confirmed."""

    structure: str = Field(description="Name under which the twin file names the structure.")
    twin: str
    places: list[GuessOut]
    missing: list[str]
    drawn: StructureOut = Field(description="The structure with the sensors that have a place.")


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


Named = Annotated[str, Field(pattern=r"^[^\x00-\x1f\x7f]{1,64}$")]
"""Name of a condition: printable characters."""


class ConditionsIn(BaseModel):
    """Conditions of the site over time; names with units as in records."""

    time_utc: list[Annotated[AwareDatetime, Field(ge=FIRST, le=LAST)]] = Field(max_length=100_000)
    values: dict[Named, list[FiniteFloat | Annotated[str, Field(max_length=64)] | None]] = Field(
        max_length=50
    )


class Taken(BaseModel):
    """Number of new or changed conditions, and of records that are observed again."""

    count: int
    observed_again: int


class AssumptionOut(BaseModel):
    """An assumption of an answer; ``confirmed`` is null for a choice of modelling.

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
