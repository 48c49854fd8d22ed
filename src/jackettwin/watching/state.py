"""State of the monitoring from one day to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import YEAR_DAYS
from jackettwin.watching.block import Block
from jackettwin.watching.condition_effects import LastSeen, UsualConditions
from jackettwin.watching.design import Design, Lagged
from jackettwin.watching.directions import SHARES
from jackettwin.watching.history import Kind


@dataclass(frozen=True)
class PossibleOnsets:
    """Possible onsets of a change.

    Attributes
    ----------
    days : (n,) first day with records after the change
    since : (n,) last day with records before it
    log_stake : (n,) ln of the prior weight (stake) of each
    log_scatter : (n, m_all, n_factors) ln of the likelihood ratios of increased noise since then
    """

    days: FloatArray
    since: FloatArray
    log_stake: FloatArray
    log_scatter: FloatArray


@dataclass(frozen=True)
class Watch:
    """State of the monitoring from one day to the next; its size is constant.

    Attributes
    ----------
    labels : names of the modes
    design, lagged : regressors, and state of the lagged ones
    blocks : one for each kind of quantity that is monitored
    begins : possible onsets
    last_day : day of the last records
    accounted : day up to which onsets have prior weights
    considered : day on which the models' weights were last reset in part
    arl_years : mean time between false alarms
    patience_days : time that a change must last
    power : power applied to the evidence
    crossing : threshold over the mean of the statistic at an alarm, by which the threshold is corrected
    without_scatter : (m_all,) quantities whose noise is not tested for want of scatter in hours; or empty
    usual, seen : what the baseline says of its conditions, and state of their sensors; None in states stored
        before they were kept
    """

    labels: tuple[str, ...]
    design: Design
    lagged: Lagged
    blocks: tuple[Block, ...]
    begins: PossibleOnsets
    last_day: float
    accounted: float
    considered: float
    arl_years: float
    patience_days: float = 0.0
    power: float = 1.0
    crossing: float = 1.0
    without_scatter: tuple[bool, ...] = ()
    usual: UsualConditions | None = None
    seen: LastSeen | None = None

    @property
    def staked(self) -> float:
        """Sum of the prior weights of the kinds of change that are monitored."""
        return SHARES["scatter"] + sum(SHARES[block.kind] for block in self.blocks)

    @property
    def log_threshold(self) -> float:
        """Ln of A, with which false alarms have the promised mean time between them."""
        return float(np.log(self.arl_years * YEAR_DAYS * self.crossing))

    @property
    def quantities(self) -> tuple[tuple[Kind, int], ...]:
        """Kind and mode of each monitored quantity."""
        return tuple((block.kind, int(q)) for block in self.blocks for q in block.kept)
