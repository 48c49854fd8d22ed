"""Schemas of the supports' stiffness through time."""

from __future__ import annotations

from datetime import datetime

from pydantic import BaseModel, Field


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
