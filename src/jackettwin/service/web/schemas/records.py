"""Schemas of records: upload, signals, spectra and manually selected poles."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, Field


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
    """Power spectral densities by Welch's method.

    ``singular_values`` are those of the spectral matrix of the channels that have the first channel's unit,
    the largest first: a peak of the first alone is one mode, of two at once a pair.
    """

    frequency_hz: list[float]
    channels: dict[str, list[float]]
    units: dict[str, str]
    singular_values: list[list[float]] = []


class SpectrogramOut(BaseModel):
    """Power spectral density of a channel through time: a row of ``level_db`` for each start of a segment.

    Levels are 10 log₁₀ of the density in ``unit``; null where the segment has no samples.
    """

    channel: str
    unit: str
    segment_s: float
    time_s: list[float]
    frequency_hz: list[float]
    level_db: list[list[float | None]]


class StretchOut(BaseModel):
    """A stretch of a channel that something was found in; seconds after the record's start."""

    channel: str | None
    from_s: float
    to_s: float
    code: str
    text: str


class StabilisationOut(BaseModel):
    """Poles of every model order; ``mode`` is the number of the pole's mode, -1 without one.

    ``mpc`` is the modal phase collinearity of its shape: 1 where the sensors move in phase or antiphase.
    """

    order: list[int]
    frequency_hz: list[float]
    damping_ratio: list[float]
    stable: list[bool]
    mode: list[int]
    mpc: list[float]


class PickIn(BaseModel):
    """A manually selected pole: the nearest one to this frequency, of this order or any."""

    frequency_hz: float = Field(gt=0.0, le=1e6)
    order: int | None = Field(default=None, ge=1, le=1000)


class PicksIn(BaseModel):
    """The poles that replace the automatic selection; an empty list restores it."""

    picks: list[PickIn] = Field(max_length=200)
