"""Exact sums of damage over records, independent of the order of addition, as stored in a state.

Damage counts in whole units of 1e-11 at each of the eight points of a side, so that the worst point of all
records is found, not the sum of each record's worst (Hammerstad et al.: up to 26 % of a life).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from jackettwin.twin.life.sensed_damage import STEP, SensedDamage, damage_of

_SQUARE = 1e3
"""Units of squares: 1e-19."""


class PointSums(NamedTuple):
    """Damage at the eight points around a weld, counted from the crown."""

    p0: int = 0
    p1: int = 0
    p2: int = 0
    p3: int = 0
    p4: int = 0
    p5: int = 0
    p6: int = 0
    p7: int = 0


class WeldSums(NamedTuple):
    """Damage of records at one side of a weld.

    Attributes
    ----------
    n : int
        Records among whose worst it is.
    points : damage at each point
    unseen : Σ D²v of the worst point, v the variance of ln D by what sensors do not see
    model : Σ D·s of the worst point, s the standard deviation of ln D over likely structures
    """

    n: int = 0
    points: PointSums = PointSums()
    unseen: int = 0
    model: int = 0

    @property
    def worst(self) -> int:
        """Damage at the point with most of it."""
        return max(self.points)

    @property
    def mean(self) -> float:
        """Damage of the points in the mean."""
        return sum(self.points) / len(self.points)

    @property
    def unseen_variance(self) -> float:
        """Variance of ln D by what sensors did not see, which is chance in each record."""
        return _SQUARE * self.unseen / self.worst**2 if self.worst else 0.0

    @property
    def model_std(self) -> float:
        """Standard deviation of ln D over likely structures, which all records share."""
        return self.model / self.worst if self.worst else 0.0


class SensedTime(NamedTuple):
    """Records whose damage is known, the seconds of them, and Σ of what the welds they leave out may have."""

    n: int = 0
    seconds: int = 0
    beyond: int = 0


def sensed_time(damage: SensedDamage | None, duration_s: float) -> SensedTime:
    """Return how long a record tells of damage; nothing if it tells none."""
    if damage is None:
        return SensedTime()
    return SensedTime(1, round(duration_s), _beyond(damage))


def weld_sums(damage: SensedDamage | None) -> Mapping[int, WeldSums]:
    """Return what one record says of the sides that it damages most, {side: sums}."""
    if damage is None:
        return {}
    points = damage_of(damage.points)
    worst, found = points.max(axis=1), {}
    for i in sorted(range(len(worst)), key=lambda i: int(damage.sides[i])):
        v, s = (STEP * float(damage.unseen[i])) ** 2, STEP * float(damage.model[i])
        found[int(damage.sides[i])] = WeldSums(
            1,
            PointSums(*(round(float(p)) for p in points[i])),
            round(float(worst[i] ** 2) * v / _SQUARE),
            round(float(worst[i]) * s),
        )
    return found


def _beyond(damage: SensedDamage) -> int:
    return round(float(damage_of(damage.beyond))) if damage.beyond else 0
