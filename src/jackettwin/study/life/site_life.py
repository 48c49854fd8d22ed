r"""Life of every weld of joints over a site: damage of each bin by the share of time that it has.

.. math:: r = \sum_b p_b \frac{1}{n_b} \sum_i \frac{D_{bi}}{T_{bi}}

at each of the eight points of a side, the worst of which is taken last. What the simulations or records of a
bin leave open is the scatter of their damage about the bin's mean, over their number, pooled over the bins:
one weather's turbulence is another's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import log, sqrt
from typing import Any

import numpy as np

from jackettwin.arrays import FloatArray
from jackettwin.constants import YEAR_S
from jackettwin.errors import require
from jackettwin.fatigue import POSITIONS, ModelsAtHeight, RemainingLife, TubeDetails, WeldLife
from jackettwin.intervals import NORMAL_90
from jackettwin.response import System
from jackettwin.simulate import scenario_from, scenario_life
from jackettwin.study.life.record_life import life_of_record, readings_and_weather
from jackettwin.study.life.site import Site
from jackettwin.twin import TwinConfig
from jackettwin.updating import Update

STATED = "as stated"
"""Name of the variant that is the site's scenario itself."""
_Side = tuple[str, str, str]
"""Node, brace and side of a weld."""
_Told = list[tuple[Sequence[WeldLife], float]]


@dataclass(frozen=True)
class SiteWeld:
    """One side of a weld over a site.

    Attributes
    ----------
    one : WeldLife of the bin that damages it most
    position : the point with most damage of all bins
    rate : damage of a year by the design curve
    life_years : with the design fatigue factor
    remaining : what is left of its life, by the mean of the tests
    by_bin : (n_bins,) shares of its damage
    variances : {source: variance of ln D}
    """

    one: WeldLife
    position: str
    rate: float
    life_years: float
    remaining: RemainingLife
    by_bin: FloatArray
    variances: Mapping[str, float]


@dataclass(frozen=True)
class SiteLife:
    """Life of the welds over a site, shortest first.

    Attributes
    ----------
    welds : tuple of SiteWeld
    numbers : how many simulations or records each bin has
    variants : {name: {side: life in years}}
    """

    welds: tuple[SiteWeld, ...]
    numbers: tuple[int, ...]
    variants: Mapping[str, Mapping[_Side, float]]


def site_life(
    site: Site,
    models: ModelsAtHeight,
    details: TubeDetails,
    *,
    known: tuple[TwinConfig, Update, System] | None = None,
    step: Callable[[str], None] = lambda _: None,
) -> SiteLife:
    """Return the life of a structure's welds over a site and under each variant of its scenario.

    Bins without records are simulated; with a twin, on its updated supports.

    Parameters
    ----------
    known : the site's twin, its update and its most probable structure
    step : called with the name of each bin before it is computed

    Raises
    ------
    InputError
        If a scenario or a record does not fit the structure, or the twin is missing that records need.
    """

    def told(index: int, overrides: dict[str, Any]) -> _Told:
        records = site.records(index) if not overrides else []
        step(f"bin {index + 1} of {len(site.bins)}")
        if records:
            require(known is not None, "records need a twin", field="twin")
            assert known is not None
            config, update, _ = known
            found = [
                life_of_record(config, update, *readings_and_weather(config, path), models)
                for path in records
            ]
            return [(one.welds, one.duration_s) for one in found]
        lives: _Told = []
        for content in site.simulations(index, overrides):
            scenario = scenario_from(content, site.scenario)
            if known is not None and "support" not in overrides:
                scenario = replace(scenario, asset=replace(scenario.asset, support=known[2].support))
            life = scenario_life(scenario, models, details)
            lives.append((life.joints, life.duration_s))
        return lives

    for overrides in ({}, *site.variants.values()):  # refuse before the long computation starts
        scenario_from(site.simulations(0, overrides)[0], site.scenario)
    every = [told(i, {}) for i in range(len(site.bins))]
    rates = _rates(every)
    variants = {STATED: _lives(site, every, rates)}
    for name, overrides in site.variants.items():
        other = [told(i, overrides) for i in range(len(site.bins))]
        variants[name] = _lives(site, other, _rates(other))
    welds = _welds(site, every, rates, variants[STATED])
    return SiteLife(welds, tuple(len(one) for one in every), variants)


def _rates(every: list[_Told]) -> dict[_Side, list[FloatArray]]:
    """Return for each side the damage of a year (n_records, 8) in each bin, if all time were like it."""
    found: dict[_Side, list[FloatArray]] = {}
    for i, told in enumerate(every):
        for welds, duration in told:
            for one in welds:
                rows = found.setdefault(one.place, [])
                while len(rows) <= i:
                    rows.append(np.zeros((0, len(POSITIONS))))
                rows[i] = np.vstack([rows[i], one.damage_by_point * YEAR_S / duration])
    return found


def _lives(site: Site, every: list[_Told], rates: Mapping[_Side, list[FloatArray]]) -> dict[_Side, float]:
    """Return the life of each side in years, by the design curve and factor."""
    factor = {
        w.place: w.life.life_years * w.life.damage * YEAR_S / w.life.duration_s
        for w in every[0][0][0]
        if w.life.damage > 0.0
    }
    shares = [one.share for one in site.bins]
    return {
        side: factor.get(side, 1.0) / worst
        for side, bins in rates.items()
        if (worst := float(sum(p * b.mean(axis=0) for p, b in zip(shares, bins, strict=True)).max())) > 0.0
    }


def _welds(
    site: Site,
    every: list[_Told],
    rates: Mapping[_Side, list[FloatArray]],
    lives: Mapping[_Side, float],
) -> tuple[SiteWeld, ...]:
    """Return the sides with damage, shortest life first."""
    heaviest: dict[_Side, WeldLife] = {}
    for told in every:
        for welds, _ in told:
            for w in welds:
                if w.place not in heaviest or w.life.damage > heaviest[w.place].life.damage:
                    heaviest[w.place] = w
    found = [_weld(site, heaviest[side], rates[side], years) for side, years in lives.items()]
    return tuple(sorted(found, key=lambda one: one.life_years))


def _weld(site: Site, one: WeldLife, bins: list[FloatArray], life_years: float) -> SiteWeld:
    shares = np.array([b.share for b in site.bins])
    means = np.array([b.mean(axis=0) for b in bins])
    point = int((shares @ means).argmax())
    parts = shares * means[:, point]
    rate = float(parts.sum())
    total = one.life
    std = log(total.damage_interval_90[1] / total.median_damage) / NORMAL_90
    variances = {name: share * std**2 for name, share in total.variance_shares.items()}
    scatter = [
        float(b[:, point].var(ddof=1) / b[:, point].mean() ** 2)
        for b in bins
        if len(b) > 1 and b[:, point].mean() > 0.0
    ]
    if scatter:
        each = (parts / rate) ** 2 * np.mean(scatter) / np.array([len(b) for b in bins])
        variances["weather of the bins"] = float(each.sum())
    median = rate * total.median_damage / total.damage
    left = RemainingLife(median, sqrt(sum(variances.values())), site.age_years)
    return SiteWeld(one, POSITIONS[point], rate, life_years, left, parts / rate, variances)
