"""Constants of nature and of the sea."""

from __future__ import annotations

GRAVITY_M_S2 = 9.80665
"""Standard acceleration of gravity, ISO 80000-3."""
SEA_WATER_KG_M3 = 1025.0
"""Density of sea water where none is stated, as in the examples of OpenFAST's HydroDyn."""
