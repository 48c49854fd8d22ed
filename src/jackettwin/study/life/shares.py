"""Test whether a weld's share of all damage departs from its past; weather affects shares little."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import exp, log, sqrt

import numpy as np
from scipy.stats import t as student

from jackettwin.twin import WeldSums

BLOCK_DAYS, LAST = 10, 3
"""Days that one share is taken over, and the last shares that are compared with those before."""
_FEWEST = 6
_CHANCE, _FACTOR, _LEAST_STD = 1e-6, 1.5, 0.05
"""Of a false alarm at one weld and block; the least ratio that is told; of the logarithms of shares."""
_PRESENT = 0.8
"""Share of the records of a block that must name a weld among their worst."""


@dataclass(frozen=True)
class ShareBlock:
    """Some days whose damage is not a share yet: days, records, and {side: (records, damage)}."""

    days: int = 0
    records: int = 0
    damage: Mapping[int, tuple[int, float]] = field(default_factory=dict)

    def plus(self, records: int, welds: Mapping[int, WeldSums]) -> ShareBlock:
        """Return the block with one more day."""
        damage = dict(self.damage)
        for side, sums in welds.items():
            n, d = damage.get(side, (0, 0.0))
            damage[side] = (n + sums.n, d + sums.mean)
        return ShareBlock(self.days + 1, self.records + records, damage)

    @property
    def shares(self) -> dict[int, float]:
        """Logarithms of the shares of the welds that most of its records name."""
        often = {s: d for s, (n, d) in self.damage.items() if n >= _PRESENT * self.records and d > 0.0}
        total = sum(often.values())
        return {side: log(d / total) for side, d in often.items()}


@dataclass(frozen=True)
class ShareTrack:
    """Logarithms of a weld's shares: the last ones, and number, mean and squares of those before."""

    last: tuple[float, ...] = ()
    n: int = 0
    mean: float = 0.0
    squares: float = 0.0

    def plus(self, share: float) -> ShareTrack:
        """Return the track with one more share."""
        last = (*self.last, share)
        if len(last) <= LAST:
            return replace(self, last=last)
        x, n = last[0], self.n + 1
        mean = self.mean + (x - self.mean) / n
        return ShareTrack(last[1:], n, mean, self.squares + (x - self.mean) * (x - mean))

    @property
    def change(self) -> float | None:
        """The last shares over those before, as a ratio; None if they differ by chance, by Student's t."""
        if self.n < _FEWEST or len(self.last) < LAST:
            return None
        away = float(np.mean(self.last)) - self.mean
        std = max(sqrt(self.squares / (self.n - 1)), _LEAST_STD) * sqrt(1.0 / LAST + 1.0 / self.n)
        by_chance = std * float(student.ppf(1.0 - 0.5 * _CHANCE, self.n - 1))
        return exp(away) if abs(away) > max(by_chance, log(_FACTOR)) else None
