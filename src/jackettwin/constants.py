"""Constants of nature, of the sea and of the calendar."""

from __future__ import annotations

GRAVITY_M_S2 = 9.80665
"""Standard acceleration of gravity, ISO 80000-3."""
SEA_WATER_KG_M3 = 1025.0
"""Density of sea water where none is stated, as in the examples of OpenFAST's HydroDyn."""
HOUR_S = 3600.0
DAY_S = 86_400.0
YEAR_DAYS = 365.25
"""A Julian year, which counts the days of a leap year in four."""
YEAR_S = YEAR_DAYS * DAY_S
