r"""Damage and life with their uncertainty.

Damage D = Σ n/N of Miner. With logarithms normal, ln D of a weld has the variance

.. math:: (\ln 10\, s)^2 + (m\, v_{SCF})^2 + (m\, v_{load})^2 + v_Δ^2

of the scatter s of log N in tests, the stress concentration, the stress ranges themselves and Miner's sum at
failure, each named in the result. m is the slope at which the damage was done.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, log, sqrt

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import YEAR_S
from jackettwin.fatigue.curves import SNCurve
from jackettwin.fatigue.cycles import Cycles
from jackettwin.intervals import NORMAL_90


@dataclass(frozen=True)
class LifeModel:
    """A curve and the scatter of what damage rests on.

    Attributes
    ----------
    curve : SNCurve
    design_factor : float
        Design fatigue factor: the life a weld must have, over the life of the structure.
    scf_cov, load_cov, miner_cov : float
        Coefficients of variation of stress concentration, of the stress ranges and of Miner's sum at failure
        (DNVGL-RP-C210: about 0.2 and 0.3; the loads' is the simulation's or the estimator's).
    """

    curve: SNCurve
    design_factor: float = 1.0
    scf_cov: float = 0.2
    load_cov: float = 0.0
    miner_cov: float = 0.3

    def life(
        self,
        cycles: Cycles,
        duration_s: float,
        thickness_m: float | None = None,
        *,
        times: int = 1,
        others: Mapping[str, float] | None = None,
    ) -> SpotLife:
        """Return damage and life of a weld from the cycles that a time brings.

        Parameters
        ----------
        times : how often the cycles tell the time over: as so many equally probable motions
        others : {source: variance of ln D} beside those of the model
        """
        ranges, numbers = cycles.ranges, cycles.numbers / times
        damage = self.curve.damage(ranges, numbers, thickness_m=thickness_m)
        m = self._slope(ranges, numbers, thickness_m)
        parts = {
            "S-N scatter": (log(10.0) * self.curve.log_std) ** 2,
            "stress concentration": (m * self.scf_cov) ** 2,
            "stress ranges": (m * self.load_cov) ** 2,
            "Miner's sum": self.miner_cov**2,
            **(others or {}),
        }
        std = sqrt(sum(parts.values()))
        # the curve lies two deviations of log N below the mean of the tests
        median = damage * 10.0 ** (-2.0 * self.curve.log_std)
        interval = (median * exp(-NORMAL_90 * std), median * exp(NORMAL_90 * std))
        shares = {name: part / sum(parts.values()) for name, part in parts.items()}
        return SpotLife(
            damage, median, interval, _years(damage * self.design_factor, duration_s), m, shares, duration_s
        )

    def _slope(self, ranges: FloatArray, numbers: FloatArray, thickness_m: float | None) -> float:
        """Return the slope, weighted by the damage done on each part of the curve."""
        m1, m2 = self.curve.m
        steep = np.abs(ranges) * self.curve.thickness_factor(thickness_m) >= self.curve.knee_pa
        above = self.curve.damage(ranges[steep], numbers[steep], thickness_m=thickness_m)
        total = self.curve.damage(ranges, numbers, thickness_m=thickness_m)
        return m1 if total <= 0.0 else (m1 * above + m2 * (total - above)) / total


@dataclass(frozen=True)
class SpotLife:
    """Damage and life of one weld.

    Attributes
    ----------
    damage : float
        By the design curve, over ``duration_s``.
    median_damage : float
        By the mean curve.
    damage_interval_90 : (low, high) about the median
    life_years : float
        By the design curve and the design fatigue factor, if all time were like this one; infinite without
        damage.
    slope : float
        Inverse slope m at which the damage was done.
    variance_shares : {source: share of the variance of ln D}
    duration_s : float
    """

    damage: float
    median_damage: float
    damage_interval_90: tuple[float, float]
    life_years: float
    slope: float
    variance_shares: dict[str, float]
    duration_s: float


def _years(damage: float, duration_s: float) -> float:
    return duration_s / YEAR_S / damage if damage > 0.0 else float("inf")
