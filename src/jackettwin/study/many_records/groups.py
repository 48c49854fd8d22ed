"""Groups of records of similar conditions: a turbine's damping depends on wind, yaw and state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import floor
from typing import Any

from jackettwin.identification import FusedIdentification, fused_records
from jackettwin.identification.many_records.tracking import TrackedModes

WIND_BIN_M_S = 2.0
"""Width of a wind speed bin, centred on whole multiples (IEC 61400-1)."""
YAW_BIN_DEG = 30.0
"""Width of a yaw sector, centred on north, 30°, …"""

Interval = tuple[float, float]
Key = tuple[Interval | None, Interval | None, str | None]


@dataclass(frozen=True)
class RecordGroup:
    """Records of one wind speed bin, one yaw sector and one state; None where records do not state it.

    ``records`` are indices among all records.
    """

    wind_speed_m_s: Interval | None
    yaw_deg: Interval | None
    state: str | None
    records: tuple[int, ...]
    fused: FusedIdentification


def grouped(followed: TrackedModes) -> tuple[RecordGroup, ...]:
    """Return the fused groups of records tracked under ``group_key``, by state, wind speed and yaw."""
    members: dict[Key, list[int]] = {}
    for i, key in enumerate(followed.keys):
        members.setdefault(key, []).append(i)  # type: ignore[arg-type]
    groups = [RecordGroup(*key, tuple(rows), fused_records(followed, key)) for key, rows in members.items()]
    return tuple(sorted(groups, key=lambda g: (g.state or "", g.wind_speed_m_s or (), g.yaw_deg or ())))


def group_key(conditions: Mapping[str, Any]) -> Key:
    """Return wind speed bin, yaw sector and state of a record; None for what it does not state."""
    wind = _number(conditions, "mean_wind_speed_m_s", "wind_speed_m_s")
    yaw = _number(conditions, "yaw_deg")
    state = conditions.get("state")
    return (
        None if wind is None else _bin(wind, WIND_BIN_M_S),
        None
        if yaw is None
        else _bin(yaw % 360.0 if yaw % 360.0 < 345.0 else yaw % 360.0 - 360.0, YAW_BIN_DEG),
        None if state is None else str(state),
    )


def _number(conditions: Mapping[str, Any], *names: str) -> float | None:
    for name in names:
        value = conditions.get(name)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return float(value)
    return None


def _bin(value: float, width: float) -> Interval:
    """Return the bin centred on a multiple of its width.

    >>> _bin(12.9, 2.0)
    (11.0, 13.0)
    """
    centre = width * floor(value / width + 0.5)
    return centre - 0.5 * width, centre + 0.5 * width
