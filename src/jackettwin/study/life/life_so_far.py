r"""Damage at an asset's welds from the states of its days, accumulated day by day in bounded size.

The damage of a year is that of the records over their time. What the records leave open of it, as variance of
its logarithm, has three parts: the weather that the days sampled, as the scatter of a ratio over days,
:math:`\frac{n}{n-1} \sum_d (D_d - rT_d)^2/(\sum_d D_d)^2` (Cochran 1977, eq. (6.13)); what sensors did not
see; and the structures that records leave likely, which all of them share.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from datetime import date
from math import exp, sqrt
from typing import Any

from jackettwin.constants import YEAR_S
from jackettwin.files import StoredSchema
from jackettwin.intervals import NORMAL_90
from jackettwin.study.life.shares import BLOCK_DAYS, ShareBlock, ShareTrack
from jackettwin.twin import DAMAGE_UNIT, UNDATED, Day, SensedTime, WeldSums, plus

RECENT_DAYS = 30
_BUDGET_DAYS = 30
"""The fewest days whose damage is held against a year's."""
_ONE_DAY = 1.0
"""Variance of the logarithm of a rate that one day has told."""


@dataclass(frozen=True)
class LifeSoFar:
    """Damage by the days so far.

    Attributes
    ----------
    first, through : the first day with damage, and the last day
    time : {state of operation: SensedTime}
    welds : {state of operation: {side: WeldSums}}
    days, seconds_2 : number of days with damage, and Σ T² of them
    moments : {side: (Σ d², Σ d T)} of days' damage d, the mean of the points
    recent : (day, seconds, {side: d}) of the last days
    block, shares : of the damage of all welds
    departed : {side: (day, ratio)} of shares that differ from their past
    over_budget : {side: (day, ratio, at least)} of rates that exceed what the design life allows
    """

    first: str = UNDATED
    through: str = UNDATED
    time: Mapping[str, SensedTime] = field(default_factory=dict)
    welds: Mapping[str, Mapping[int, WeldSums]] = field(default_factory=dict)
    days: int = 0
    seconds_2: float = 0.0
    moments: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    recent: tuple[tuple[str, int, Mapping[int, float]], ...] = ()
    block: ShareBlock = ShareBlock()
    shares: Mapping[int, ShareTrack] = field(default_factory=dict)
    departed: Mapping[int, tuple[str, float]] = field(default_factory=dict)
    over_budget: Mapping[int, tuple[str, float, float]] = field(default_factory=dict)

    @property
    def total(self) -> tuple[SensedTime, dict[int, WeldSums]]:
        """Time and damage of all states of operation together."""
        time, welds = SensedTime(), dict[int, WeldSums]()
        for name, own in self.time.items():
            time, welds = plus(time, own), joined(welds, self.welds[name])
        return time, welds

    def plus(self, name: str, day: Day, budget: float) -> LifeSoFar:
        """Return what one more day, later than all before, adds.

        Parameters
        ----------
        budget : damage of a year that the design life allows
        """
        told = {op: o for op, o in day.operations.items() if o.sensed.n}
        if name == UNDATED or not told:
            return replace(self, through=max(self.through, name))
        time, welds = SensedTime(), dict[int, WeldSums]()
        for o in told.values():
            time, welds = plus(time, o.sensed), joined(welds, o.welds)
        damage = {side: sums.mean for side, sums in welds.items()}
        recent = tuple(r for r in self.recent if _days(r[0], name) < RECENT_DAYS)
        moments = dict(self.moments)
        for side, d in damage.items():
            square, by_time = moments.get(side, (0.0, 0.0))
            moments[side] = (square + d**2, by_time + d * time.seconds)
        grown = replace(
            self,
            first=self.first or name,
            through=name,
            time=dict(self.time)
            | {op: plus(self.time.get(op, SensedTime()), o.sensed) for op, o in told.items()},
            welds=dict(self.welds) | {op: joined(self.welds.get(op, {}), o.welds) for op, o in told.items()},
            days=self.days + 1,
            seconds_2=self.seconds_2 + float(time.seconds) ** 2,
            moments=moments,
            recent=(*recent, (name, time.seconds, damage)),
            block=self.block.plus(time.n, welds),
        )
        return grown._judged(name, budget)

    def _judged(self, name: str, budget: float) -> LifeSoFar:
        """Return the state with what departs from its past or exceeds its budget on a day."""
        shares, departed = dict(self.shares), dict(self.departed)
        full = self.block.days >= BLOCK_DAYS
        for side, share in (self.block.shares if full else {}).items():
            shares[side] = shares.get(side, ShareTrack()).plus(share)
            _keep(departed, side, shares[side].change, lambda ratio: (name, ratio))
        over = dict(self.over_budget)
        time, welds = self.total
        for side, sums in welds.items() if self.days >= _BUDGET_DAYS else ():
            rate, std = damage_of_year(sums, time), sqrt(sum(self.variances(side, time, sums).values()))
            low = rate * exp(-NORMAL_90 * std) / budget
            exceeds = (name, rate / budget, low) if low > 1.0 else None
            _keep(over, side, exceeds, lambda found: found)
        block = ShareBlock() if full else self.block
        return replace(self, block=block, shares=shares, departed=departed, over_budget=over)

    def variances(self, side: int, time: SensedTime, sums: WeldSums) -> dict[str, float]:
        """Return the variance of the logarithm of a side's damage of a year by what records leave open."""
        square, by_time = self.moments[side]
        mean = sums.mean
        sampled = _ONE_DAY
        if self.days > 1 and mean > 0.0:
            r = mean / time.seconds
            away = square - 2.0 * r * by_time + r**2 * self.seconds_2
            sampled = max(away, 0.0) / mean**2 * self.days / (self.days - 1)
        return {
            "weather sampled": sampled,
            "what sensors do not see": sums.unseen_variance,
            "structure and force levels": sums.model_std**2,
        }

    def recent_rate(self, side: int, sums: WeldSums) -> float | None:
        """Return the damage of a year, were it like the last days; None without any."""
        seconds = sum(t for _, t, _ in self.recent)
        mean = sums.mean
        if not seconds or not mean:
            return None
        damage = sum(welds.get(side, 0.0) for _, _, welds in self.recent)
        return DAMAGE_UNIT * damage * sums.worst / mean * YEAR_S / seconds


LIFE_SO_FAR = StoredSchema("life_so_far", LifeSoFar)
"""Schema of its stored form."""


def joined(a: Mapping[int, WeldSums], b: Mapping[int, WeldSums]) -> dict[int, WeldSums]:
    """Return the sums of both."""
    return {side: plus(a.get(side, WeldSums()), b.get(side, WeldSums())) for side in sorted({**a, **b})}


def damage_of_year(sums: WeldSums, time: SensedTime) -> float:
    """Return the damage of a year at the worst point, by the design curve."""
    return DAMAGE_UNIT * sums.worst * YEAR_S / time.seconds


def _keep(kept: dict[int, Any], side: int, found: Any, made: Callable[[Any], Any]) -> None:
    """Keep since when something holds; forget it when it does not any more."""
    if found is None:
        kept.pop(side, None)
    else:
        kept.setdefault(side, made(found))


def _days(earlier: str, later: str) -> int:
    return (date.fromisoformat(later) - date.fromisoformat(earlier)).days
