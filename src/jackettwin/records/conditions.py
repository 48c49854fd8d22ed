"""Wind, yaw and operating state of a record, from its description or else its channels."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from jackettwin.records.processing.tones import ROTOR_STATES, rotor_speed
from jackettwin.records.processing.yaw import knows_yaw, yaw_of

if TYPE_CHECKING:
    from jackettwin.records.record import Record

WIND_KEYS = ("mean_wind_speed_m_s", "wind_speed_m_s")
MEANS = {
    "temperature": ("temperature_c", 1.0),
    "water level": ("water_level_m", 1.0),
    "current speed": ("current_speed_m_s", 1.0),
    "power": ("power_w", 1.0),
    "pitch": ("pitch_deg", 180.0 / np.pi),
}
"""Quantity of a channel → the condition that its mean is, and the factor from SI."""


def with_conditions(record: Record) -> Record:
    """Return the record with conditions that its description lacks, derived from its channels.

    ``mean_wind_speed_m_s`` is that of the first channel of quantity wind speed, ``yaw_deg`` that of the yaw,
    and ``state`` (``rotor turning`` or ``rotor standing``) follows from the rotor speed; those of ``MEANS``
    are means, of a second channel of one quantity with the channel's name behind. Stated conditions are kept.
    """
    known: dict[str, Any] = dict(record.conditions)
    wind = _mean(record, "wind speed")
    if wind is not None and not any(known.get(key) is not None for key in WIND_KEYS):
        known["mean_wind_speed_m_s"] = wind
    if known.get("yaw_deg") is None and knows_yaw(record):
        known["yaw_deg"] = float(np.degrees(np.mean(yaw_of(record))))
    if known.get("state") is None and _mean(record, "rotor speed") is not None:
        known["state"] = ROTOR_STATES[rotor_speed(record) is not None]
    return replace(record, conditions=_means(record) | known)


def _means(record: Record) -> dict[str, float]:
    """Return the means of the channels that tell what affects modes beside the wind."""
    found: dict[str, float] = {}
    for channel, row in zip(record.channels, record.data, strict=True):
        if channel.quantity in MEANS and np.isfinite(row).any():
            key, factor = MEANS[channel.quantity]
            found[key if key not in found else f"{key} {channel.name}"] = factor * float(np.nanmean(row))
    return found


def _mean(record: Record, quantity: str) -> float | None:
    """Return the mean of the first channel of a quantity; None if there is none, or it is empty."""
    rows = [i for i, channel in enumerate(record.channels) if channel.quantity == quantity]
    if not rows or not np.isfinite(record.data[rows[0]]).any():
        return None
    return float(np.nanmean(record.data[rows[0]]))
