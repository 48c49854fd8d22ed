"""Wind, yaw and operating state of a record, from its description or else its channels."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.records.processing.tones import rotor_speed
from jackettwin.records.processing.yaw import knows_yaw, yaw_of

if TYPE_CHECKING:
    from jackettwin.records.record import Record

WIND_KEYS = ("mean_wind_speed_m_s", "wind_speed_m_s")


def with_conditions(record: Record) -> Record:
    """Return the record with conditions that its description lacks, derived from its channels.

    ``mean_wind_speed_m_s`` is that of the first channel of quantity wind speed, ``yaw_deg`` that of the yaw,
    and ``state`` (``rotor turning`` or ``rotor standing``) follows from the rotor speed.
    Stated conditions are kept.
    """
    known: dict[str, Any] = dict(record.conditions)
    wind = _mean(record, "wind speed")
    if wind is not None and not any(known.get(key) is not None for key in WIND_KEYS):
        known["mean_wind_speed_m_s"] = wind
    if known.get("yaw_deg") is None and knows_yaw(record):
        known["yaw_deg"] = float(np.degrees(np.mean(yaw_of(record))))
    if known.get("state") is None and _mean(record, "rotor speed") is not None:
        known["state"] = "rotor standing" if rotor_speed(record) is None else "rotor turning"
    return replace(record, conditions=known)


def _mean(record: Record, quantity: str) -> float | None:
    """Return the mean of the first channel of a quantity; None if there is none, or it is empty."""
    rows = [i for i, channel in enumerate(record.channels) if channel.quantity == quantity]
    if not rows or not np.isfinite(record.data[rows[0]]).any():
        return None
    return float(np.nanmean(record.data[rows[0]]))
