"""Schemas of the fatigue life of welds."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel


class YearsLeft(BaseModel):
    """Remaining life as quantiles [years]; null where nothing fails."""

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
    structure's frame. ``scf``: factors by class (k, y, x), load and place. A weld around a
    ``tube`` has its name for its joint and its tube for chord and brace. ``departed``: its share of the
    damage of all welds differs from its past; ``over_budget``: a year's damage exceeds what the design life
    allows, its interval included.
    """

    joint: str
    chord: str
    brace: str
    side: Literal["chord", "brace", "tube"]
    position: str
    z_m: float
    above_sea_m: float | None = None
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
