"""A twin followed through time: what is known after each day, and where the next one starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
import numpy.typing as npt

from jackettwin.response.sensors import Sensor
from jackettwin.twin.config import GivenRelaxation
from jackettwin.twin.measure import Sighting
from jackettwin.updating.drift import Drift

FloatArray = npt.NDArray[np.float64]

FEWEST_DAYS = 3
"""Days with data before a drift is looked for."""
STIFFNESS = "N/m"
"""Unit of the parameters that may drift."""


@dataclass(frozen=True)
class RecordModes:
    """The model's modes and the real poles seen in one record; ``sensors`` are where its channels sit."""

    name: str
    time_utc: datetime
    sightings: Mapping[int, Sighting]
    sensors: tuple[Sensor, ...] = ()
    relaxations: tuple[GivenRelaxation, ...] = ()


@dataclass(frozen=True)
class Day:
    """Records of one day, and what all records up to then say.

    Attributes
    ----------
    median : {parameter: value}
    interval_90 : {parameter: (low, high)}
    """

    records: tuple[RecordModes, ...]
    median: Mapping[str, float]
    interval_90: Mapping[str, tuple[float, float]]

    @property
    def time_utc(self) -> datetime:
        """The middle of its records."""
        times = [record.time_utc for record in self.records]
        return min(times) + 0.5 * (max(times) - min(times))


@dataclass(frozen=True)
class Followed:
    """A twin followed through time: what the next day starts from.

    Attributes
    ----------
    reference_hz : float
        The first frequency on pinned feet: it tells a changed structure.
    wind_m_s : float or None
        That nacelle dashpots are stated at.
    units : {parameter: unit}
    days : in the order of time
    drift : Drift or None
        Of all stiffness together, from the first day on; None before the third day.
    warnings : sentences
    """

    name: str
    law: str
    reference_hz: float
    wind_m_s: float | None
    units: Mapping[str, str]
    days: tuple[Day, ...]
    drift: Drift | None
    warnings: tuple[str, ...]

    @property
    def stiffness(self) -> tuple[str, ...]:
        """Names of the stiffness parameters: those that may drift."""
        return tuple(name for name, unit in self.units.items() if unit == STIFFNESS)

    @property
    def days_since_first(self) -> FloatArray:
        """Times of the days [d], (n_days,)."""
        return since_first(self.days)

    @property
    def statement(self) -> str:
        """What is known of a drift, in a sentence."""
        if self.drift is None:
            return f"Too early to speak of a drift: {FEWEST_DAYS} days with data are needed."
        slope, low, high = 100.0 * np.expm1([self.drift.slope_per_day, *self.drift.interval_90])
        found = "No drift found" if not self.drift.detected else "Rising" if low > 0.0 else "Falling"
        change = "changes" if len(self.stiffness) == 1 else "change"
        return (
            f"{found}: {' and '.join(self.stiffness)} {change} by {slope:+.2g} % a day, 90 % interval "
            f"{low:+.2g} to {high:+.2g} %, over {self.days_since_first[-1]:.3g} days."
        )


def since_first(days: Sequence[Day]) -> FloatArray:
    """Return the times of days after the first [d], (n_days,)."""
    return np.array([(day.time_utc - days[0].time_utc).total_seconds() / 86400.0 for day in days])
