"""State of the monitoring from one day to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.watching.block import Block
from jackettwin.watching.design import YEAR_DAYS, Design, Lagged
from jackettwin.watching.history import Kind


@dataclass(frozen=True)
class Begins:
    """Possible onsets of a change.

    Attributes
    ----------
    days : (n,) first day with records after the change
    since : (n,) last day with records before it
    log_stake : (n,) ln of what is staked on each
    log_scatter : (n, m_all, n_factors) ln of the likelihood ratios of louder noise since then
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
    labels : of the modes
    design, lagged : regressors and what late ones remember
    blocks : of frequencies, and of damping if there is any
    begins : of changes that are bet on
    last_day : of the last records
    accounted : day up to which begins are staked
    considered : day on which the models' weights were reconsidered
    arl_years : mean time between false alarms that is promised, at least
    patience_days : for how long a change has to last
    power : to which evidence counts
    """

    labels: tuple[str, ...]
    design: Design
    lagged: Lagged
    blocks: tuple[Block, ...]
    begins: Begins
    last_day: float
    accounted: float
    considered: float
    arl_years: float
    patience_days: float = 0.0
    power: float = 1.0

    @property
    def log_threshold(self) -> float:
        """Ln of A, the days between false alarms."""
        return float(np.log(self.arl_years * YEAR_DAYS))

    @property
    def quantities(self) -> tuple[tuple[Kind, int], ...]:
        """Kind and mode of each watched quantity."""
        return tuple((block.kind, int(q)) for block in self.blocks for q in block.kept)
